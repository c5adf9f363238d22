#pragma once

#include <softkin/model/direction.hpp>
#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/model.hpp>

namespace softkin {

/// Of an element, tetrahedra first, then prisms.
[[nodiscard]] Vec3 centroid_of(const Model& model, std::size_t element);

/// Samples in space, of which every element takes the one nearest to its centroid.
class ElementSamples {
 public:
  /// owner   what has the samples, in messages: "the material of region 'all': its remanence"
  /// throws  InvalidInput at origin on as many places as there are not samples, and on what is not finite
  ElementSamples(const Points& places, const Points& samples, const std::string& file, const std::string& owner,
                 const Origin& origin);

  [[nodiscard]] bool empty() const { return places_.rows() == 0; }
  /// throws  InvalidInput where none is as near as the element is long
  [[nodiscard]] Vec3 of(const Model& model, std::size_t element) const;

 private:
  const Points &places_, &samples_;
  std::string what_;
  const Origin& origin_;
  BoxTree tree_;
};

/// The directions of elements, of unit length.
class Directions {
 public:
  /// owner   what has them, in messages
  /// throws  InvalidInput at origin on a direction or an axis that is 0 or not finite
  Directions(const DirectionSpec& spec, const std::string& owner, const Origin& origin);

  /// throws  InvalidInput where it is not known: no sample near, or the element on the line itself
  [[nodiscard]] Vec3 of(const Model& model, std::size_t element) const;

 private:
  const DirectionSpec& spec_;
  std::string owner_;
  const Origin& origin_;
  ElementSamples samples_;
};

}  // namespace softkin
