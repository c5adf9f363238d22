#pragma once

#include <softkin/model/mesh/mesh.hpp>
#include <vector>

namespace softkin {

/// The connected parts of a mesh of order 2, each cut into ten sections across its longest side.
class MeshSections {
 public:
  static constexpr std::size_t per_part = 10;

  explicit MeshSections(const Mesh& mesh);

  [[nodiscard]] std::size_t parts() const { return sections_ / per_part; }
  /// The part of the first element with this vertex; the vertex must be one of an element.
  [[nodiscard]] std::size_t part_of(Index vertex) const { return part_of_vertex_[vertex]; }
  /// Volumes of the sections of all parts with other positions of the vertices [mm^3]; those of elements that these
  /// turn inside out are negative.
  [[nodiscard]] std::vector<double> volumes(const Points& positions) const;

 private:
  const Mesh& mesh_;
  std::size_t sections_ = 0;
  std::vector<std::size_t> part_of_vertex_;
  std::vector<std::size_t> section_of_;  // of tetrahedra
};

}  // namespace softkin
