#include <Eigen/Geometry>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

constexpr double min_segment_mm = 1e-6;
constexpr double max_guides = 10'000;
constexpr double min_height = 1e-3;  // of a gap's triangle, over the length of its segment

std::string segment_text(std::size_t segment) {
  return "between points[" + std::to_string(segment) + "] and points[" + std::to_string(segment + 1) + "]";
}

/// Adds the points that guide the cable on the straight line to `end`: at most `spacing` apart, none outside the body.
void add_guides(Compilation& c, const ActuatorSpec& spec, const CableSpec& given, const Vec3& end, CableDrive& cable) {
  const Vec3 start = cable.points.back().at(c.model.rest);
  const double pieces = std::ceil((end - start).norm() / given.spacing * (1 - 1e-12));
  if (pieces > max_guides)
    refuse(spec, "would be guided at " + number(pieces) + " places by its spacing of " + number(given.spacing) +
                     " mm: the most are " + number(max_guides));
  for (double i = 1; i < pieces; ++i) {
    EmbeddedPoint guide = body_of(c, spec.robot).embedder.embed(start + i / pieces * (end - start));
    if (guide.distance_mm <= 1e-9 * c.model.diagonal_mm) cable.points.push_back(std::move(guide));
  }
}

/// Returns the cable's points at rest, with the guide points that its spacing adds between the given ones.
std::vector<Vec3> embed_points(Compilation& c, const ActuatorSpec& spec, const CableSpec& given, CableDrive& cable) {
  if (given.points.size() < 2) refuse(spec, "is a cable and needs at least two points");
  for (std::size_t i = 0; i < given.points.size(); ++i) {
    EmbeddedPoint point =
        embed_point(c, given.points[i], "points[" + std::to_string(i) + "] of actuator '" + spec.name + "'");
    if (i > 0) {
      const Vec3 end = point.at(c.model.rest);
      if ((end - cable.points.back().at(c.model.rest)).norm() < min_segment_mm)
        refuse(spec, "has no length " + segment_text(i - 1));
      if (given.spacing > 0) add_guides(c, spec, given, end, cable);
    }
    cable.points.push_back(std::move(point));
  }
  std::vector<Vec3> points;
  for (const EmbeddedPoint& point : cable.points) points.push_back(point.at(c.model.rest));
  return points;
}

/// Segments that run free outside the body; every one where none does.
std::vector<Index> free_segments(const Compilation& c, const Body& body, const std::vector<Vec3>& points) {
  std::vector<Index> gaps, every;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec3 middle = 0.5 * (points[i] + points[i + 1]);
    every.push_back(i);
    if (body.embedder.embed(middle).distance_mm > 1e-9 * c.model.diagonal_mm) gaps.push_back(i);
  }
  return gaps.empty() ? every : gaps;
}

Vec3 body_centroid(const Compilation& c, const Body& body) {
  double total = 0;
  Vec3 sum = Vec3::Zero();
  const auto add = [&](const auto& elements) {
    for (const auto& element : elements) {
      const double volume = signed_volume(c.model.rest, element);
      for (const Index v : element) sum += volume / static_cast<double>(element.size()) * vertex_at(c.model.rest, v);
      total += volume;
    }
  };
  add(body.tetrahedra);
  add(body.prisms);
  return sum / total;
}

double height_over(const Vec3& start, const Vec3& end, const Vec3& point) {
  return (point - start).cross((end - start).normalized()).norm();
}

/// From the middle of the segment straight towards the body's centroid: the first point of the body's boundary.
Vec3 find_apex(const Compilation& c, const ActuatorSpec& spec, const SurfaceTree& boundary, const Vec3& centroid,
               const std::vector<Vec3>& points, Index segment) {
  const Vec3 &start = points[segment], &end = points[segment + 1];
  const Vec3 middle = 0.5 * (start + end);
  const Vec3 along = (end - start).normalized();
  const Vec3 offset = centroid - middle;
  const Vec3 across = offset - offset.dot(along) * along;
  const double length = (end - start).norm();
  if (across.norm() > 1e-9 * c.model.diagonal_mm) {
    const Vec3 direction = across.normalized();
    const auto hit = boundary.first_hit(middle, direction, 1e-9 * c.model.diagonal_mm);
    if (hit && *hit >= min_height * length) return middle + *hit * direction;
  }
  refuse(spec,
         "has a gap " + segment_text(segment) + " with no body straight across it: name its third corner in `apexes`");
}

void find_apexes(Compilation& c, const ActuatorSpec& spec, const std::vector<Vec3>& points, CableDrive& cable) {
  const Body& body = body_of(c, spec.robot);
  const SurfaceTree boundary(c.model.rest, triangulated(boundary_of(body.tetrahedra, body.prisms)));
  const Vec3 centroid = body_centroid(c, body);
  for (CableGap& gap : cable.gaps)
    gap.apex = body.embedder.embed(find_apex(c, spec, boundary, centroid, points, gap.segment));
}

void take_apexes(Compilation& c, const ActuatorSpec& spec, const CableSpec& given, const std::vector<Vec3>& points,
                 CableDrive& cable) {
  if (given.apexes.size() != cable.gaps.size())
    refuse(spec, "has " + counted(cable.gaps.size(), "gap") + " but " + counted(given.apexes.size(), "apex", "apexes") +
                     ": it needs one for each, in order");
  for (std::size_t i = 0; i < cable.gaps.size(); ++i) {
    CableGap& gap = cable.gaps[i];
    const std::string what = "apexes[" + std::to_string(i) + "] of actuator '" + spec.name + "'";
    gap.apex = embed_point(c, given.apexes[i], what);
    const Vec3 &start = points[gap.segment], &end = points[gap.segment + 1];
    if (height_over(start, end, gap.apex.at(c.model.rest)) < min_height * (end - start).norm())
      throw InvalidInput(given.apexes[i].origin, what + " lies on the line of the cable: move it into the body");
  }
}

}  // namespace

void compile_cable(Compilation& c, const ActuatorSpec& spec, const CableSpec& given, Actuator& actuator) {
  auto& cable = std::get<CableDrive>(actuator.drive);
  const std::vector<Vec3> points = embed_points(c, spec, given, cable);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) actuator.rest_measure += (points[i + 1] - points[i]).norm();
  // physical: a constraint on its length, without actuation elements
  if (c.spec.formulation == Formulation::physical) return;
  for (const Index segment : free_segments(c, body_of(c, spec.robot), points)) cable.gaps.push_back({segment, {}});
  if (given.apexes.empty())
    find_apexes(c, spec, points, cable);
  else
    take_apexes(c, spec, given, points, cable);

  double inside = actuator.rest_measure;
  for (const CableGap& gap : cable.gaps) inside -= (points[gap.segment + 1] - points[gap.segment]).norm();
  const double least = inside / actuator.rest_measure;
  if (actuator.low < least - 1e-12)
    refuse(spec, "has a range that begins at " + number(actuator.low) + ", but its pieces inside the body alone make " +
                     number(least) + " of its length of " + number(actuator.rest_measure) + " mm");
}

}  // namespace softkin
