#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin {

namespace {

constexpr double megapascals = 1e-3;  // in a kPa

std::string title(const TractionSpec& spec) {
  return "traction '" + spec.name + "'";
}

/// Finds the faces of the body in a region, with normals outwards; a quad is the mean of its two triangulations.
class BodyFaces {
 public:
  explicit BodyFaces(const Compilation& c)
      : c_(c), boundary_(boundary_of(c.model.elements.tetrahedra, c.model.elements.prisms)) {}

  [[nodiscard]] std::vector<LoadedFace> of(const TractionSpec& spec) const {
    std::set<std::vector<Index>> others;
    std::vector<LoadedFace> faces = of(spec.where, others);
    refuse_others(spec, others, faces);
    return faces;
  }

  /// wanted: becomes the faces of the region that are not on the surface
  [[nodiscard]] std::vector<LoadedFace> of(const RegionRef& where, std::set<std::vector<Index>>& wanted) const {
    const Region region = c_.regions.resolve(where);
    const bool named = region.dimension == 2;  // a group of faces: these; else all between its vertices
    if (named) {
      for (const Index i : region.triangles) wanted.insert(sorted(c_.mesh.triangles[i]));
      for (const Index i : region.quads) wanted.insert(sorted(c_.mesh.quads[i]));
    }
    std::vector<bool> inside(c_.model.elements.used.size());
    for (const Index v : region.vertices) inside[v] = true;
    const auto is_loaded = [&](const auto& face) {
      if (named) return wanted.erase(sorted(face)) > 0;
      return std::all_of(face.begin(), face.end(), [&](Index v) { return inside[v]; });
    };
    std::vector<LoadedFace> faces;
    for (const Triangle& t : boundary_.triangles)
      if (is_loaded(t)) faces.push_back(loaded_face(c_, t, 1));
    for (const Quad& q : boundary_.quads)
      if (is_loaded(q))
        for (int i = 0; i < 4; ++i) faces.push_back(loaded_face(c_, {q[i], q[(i + 1) % 4], q[(i + 2) % 4]}, 0.5));
    return faces;
  }

 private:
  template <class Face>
  static std::vector<Index> sorted(const Face& face) {
    std::vector<Index> vertices(face.begin(), face.end());
    std::sort(vertices.begin(), vertices.end());
    return vertices;
  }

  static void refuse_others(const TractionSpec& spec, const std::set<std::vector<Index>>& others,
                            const std::vector<LoadedFace>& faces) {
    if (!others.empty())
      throw InvalidInput(spec.where.origin, title(spec) + " is on " + counted(others.size(), "face", "faces") +
                                                " that " + (others.size() == 1 ? "is" : "are") +
                                                " not on the surface of the body");
    if (faces.empty())
      throw InvalidInput(spec.where.origin,
                         title(spec) + " is on " + label(spec.where) + ", which holds no face of the body's surface");
  }

  const Compilation& c_;
  const Boundary boundary_;
};

void check(const TractionSpec& spec) {
  const auto refuse = [&](const std::string& why) { throw InvalidInput(spec.where.origin, title(spec) + why); };
  if (!spec.kilopascals.allFinite() || !std::isfinite(spec.pressure_kPa)) refuse(" is not finite");
  if (spec.range_kPa) {
    const auto& [low, high] = *spec.range_kPa;
    if (!std::isfinite(low) || !std::isfinite(high) || !(low < high))
      refuse(" has the range " + interval_text(low, high) + " kPa: the low end comes first, and is lower");
    if (spec.pressure_kPa < low || spec.pressure_kPa > high)
      refuse(" is " + number(spec.pressure_kPa) + " kPa, outside its range " + interval_text(low, high) + " kPa");
    return;
  }
  if (spec.kilopascals.isZero(0) && spec.pressure_kPa == 0) refuse(" is 0: give it a value, or leave it out");
}

Actuator command_of(const TractionSpec& spec, std::size_t traction) {
  Actuator command;
  command.name = spec.name;
  command.drive = PressureCommand{static_cast<Index>(traction)};
  command.control = Control::load;
  command.low = (*spec.range_kPa)[0];
  command.high = (*spec.range_kPa)[1];
  command.rest = spec.pressure_kPa;
  return command;
}

/// Of a traction that keeps its direction, on the area at rest.
void add_dead(Model& model, const Vec3& traction_MPa, const LoadedFace& loaded) {
  const std::vector<Index> nodes = nodes_of(loaded.face);
  for (const TrianglePoint& point : triangle_points(nodes.size())) {
    const SurfaceEdges edges(point, nodes, model.rest);
    const double area = loaded.fraction * point.weight * edges.u.cross(edges.v).norm();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      model.loads.dead.row(nodes[i]) += area * point.shape[i] * traction_MPa.transpose();
  }
}

}  // namespace

LoadedFace loaded_face(const Compilation& c, const Triangle& corners, double fraction) {
  return {face_of(c, corners), fraction};
}

std::vector<LoadedFace> surface_faces(const Compilation& c, const RegionRef& where) {
  std::set<std::vector<Index>> others;
  return BodyFaces(c).of(where, others);
}

void compile_tractions(Compilation& c) {
  if (c.spec.loads.tractions.empty()) return;
  const BodyFaces body(c);
  std::set<std::string> names;
  for (const TractionSpec& spec : c.spec.loads.tractions) {
    check(spec);
    if (!names.insert(spec.name).second)
      throw InvalidInput(spec.where.origin, "there are two tractions '" + spec.name + "'");
    std::vector<LoadedFace> faces = body.of(spec);
    const Vec3 traction = megapascals * spec.kilopascals;
    if (spec.range_kPa) {
      c.force_commands.push_back(command_of(spec, c.model.loads.tractions.size()));
      c.model.loads.tractions.push_back({Vec3::Zero(), 0, std::move(faces)});
    } else if (spec.follows)
      c.model.loads.tractions.push_back({traction, megapascals * spec.pressure_kPa, std::move(faces)});
    else
      for (const LoadedFace& face : faces) add_dead(c.model, traction, face);
  }
}

}  // namespace softkin
