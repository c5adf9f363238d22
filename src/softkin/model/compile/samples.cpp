#include <softkin/model/compile/samples.hpp>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <softkin/core/text.hpp>

namespace softkin {

namespace {

template <class Visit>
auto visit_nodes(const Model& model, std::size_t element, const Visit& visit) {
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  return element < tetrahedra ? visit(model.elements.tetrahedra[element])
                              : visit(model.elements.prisms[element - tetrahedra]);
}

double longest_edge(const Model& model, std::size_t element) {
  return visit_nodes(model, element, [&](const auto& nodes) {
    double longest = 0;
    for (const Index a : nodes)
      for (const Index b : nodes)
        longest = std::max(longest, (vertex_at(model.rest, a) - vertex_at(model.rest, b)).norm());
    return longest;
  });
}

}  // namespace

Vec3 centroid_of(const Model& model, std::size_t element) {
  return visit_nodes(model, element, [&](const auto& nodes) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : nodes) sum += vertex_at(model.rest, v);
    return Vec3(sum / static_cast<double>(nodes.size()));
  });
}

ElementSamples::ElementSamples(const Points& places, const Points& samples, const std::string& file,
                               const std::string& owner, const Origin& origin)
    : places_(places), samples_(samples), what_(owner + " of " + file), origin_(origin), tree_({}) {
  if (places.rows() != samples.rows()) throw InvalidInput(origin, owner + " needs a place for each of its samples");
  if (!places.allFinite() || !samples.allFinite())
    throw InvalidInput(origin, owner + " has a sample that is not finite");
  std::vector<Bounds> boxes;
  for (Index i = 0; i < places.rows(); ++i) boxes.emplace_back(vertex_at(places, i));
  tree_ = BoxTree(boxes);
}

Vec3 ElementSamples::of(const Model& model, std::size_t element) const {
  const Vec3 at = centroid_of(model, element);
  Index nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  tree_.visit_near(at, [&](Index i) {
    const double square = (vertex_at(places_, i) - at).squaredNorm();
    if (square < least) {
      least = square;
      nearest = i;
    }
    return least;
  });
  const double most = longest_edge(model, element), distance = std::sqrt(least);
  if (distance > most)
    throw InvalidInput(origin_, what_ + " has no sample near " + point_text(at) + " mm: the nearest is " +
                                    number(distance, 3) + " mm away, and the element there is of " + number(most, 3) +
                                    " mm");
  return vertex_at(samples_, nearest);
}

Directions::Directions(const DirectionSpec& spec, const std::string& owner, const Origin& origin)
    : spec_(spec), owner_(owner), origin_(origin), samples_(spec.places, spec.samples, spec.file, owner, origin) {
  const bool uniform = spec.kind == DirectionSpec::Kind::uniform;
  const Vec3& given = uniform ? spec.uniform : spec.axis;
  const auto refuse = [&](const std::string& why) { throw InvalidInput(origin, owner + why); };
  if (!given.allFinite() || given.isZero(0))
    refuse(std::string(" needs ") + (uniform ? "a direction" : "an axis") + " that is finite and not 0, not " +
           point_text(given));
  if (!spec.center.allFinite() || !std::isfinite(spec.degrees)) refuse(" is not finite");
  if (spec.kind == DirectionSpec::Kind::samples && samples_.empty()) refuse(" has no samples");
}

Vec3 Directions::of(const Model& model, std::size_t element) const {
  using Kind = DirectionSpec::Kind;
  if (spec_.kind == Kind::uniform) return spec_.uniform.stableNormalized();
  const Vec3 at = centroid_of(model, element);
  const auto refuse = [&](const std::string& why) {
    throw InvalidInput(origin_, owner_ + why + " at " + point_text(at) + " mm");
  };
  if (spec_.kind == Kind::samples) {
    const Vec3 sample = samples_.of(model, element);
    if (sample.isZero(0)) refuse(" is 0");
    return sample.stableNormalized();
  }
  const Vec3 axis = spec_.axis.stableNormalized(), arm = at - spec_.center, out = arm - arm.dot(axis) * axis;
  if (!(out.norm() > 1e-9 * model.diagonal_mm)) refuse(" has no direction on its axis,");
  if (spec_.kind == Kind::radial) return out.normalized();
  const double angle = spec_.degrees * std::numbers::pi / 180;
  return std::cos(angle) * axis.cross(out).normalized() + std::sin(angle) * axis;
}

}  // namespace softkin
