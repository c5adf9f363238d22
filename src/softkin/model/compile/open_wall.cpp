#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <softkin/model/compile/closing.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>

namespace softkin {

namespace {

/// By vertex and axis: is it held by an entry of `fixed`, or of no element.
std::vector<std::array<bool, 3>> held_axes(const Compilation& c) {
  std::vector<std::array<bool, 3>> held = c.model.held.fixed;
  for (const FixedSpec& fixed : c.spec.fixed)
    for (const Index v : c.regions.resolve(fixed.where).vertices)
      for (int axis = 0; axis < 3; ++axis) held[v][axis] = held[v][axis] || fixed.axes[axis];
  return held;
}

std::vector<RimEdge> rim_edges(const Compilation& c, const std::vector<Triangle>& triangles) {
  std::vector<RimEdge> rim;
  for (const auto& [from, to] : rim_of(triangles))
    rim.push_back({from, to, c.regions.edges().empty() ? -1 : c.regions.edges().find(from, to)});
  return rim;
}

/// Of each triangle 1 where its normal points into the element of the body whose face it is, -1 where out of it, else
/// 0.
std::vector<int> sides_of_body(const Model& model, const std::vector<Triangle>& triangles) {
  std::map<Triangle, std::size_t> known;
  std::vector<bool> marked(model.elements.used.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle key = triangles[t];
    std::sort(key.begin(), key.end());
    known.emplace(key, t);
    for (const Index v : key) marked[v] = true;
  }
  std::vector<int> sides(triangles.size());
  const auto look = [&](Triangle key, const Vec3& inside) {
    if (!marked[key[0]] || !marked[key[1]] || !marked[key[2]]) return;
    std::sort(key.begin(), key.end());
    const auto found = known.find(key);
    if (found == known.end()) return;
    const auto& [a, b, c] = triangles[found->second];
    const Vec3 corner = vertex_at(model.rest, a);
    const Vec3 normal = (vertex_at(model.rest, b) - corner).cross(vertex_at(model.rest, c) - corner);
    sides[found->second] += normal.dot(inside - corner) > 0 ? 1 : -1;
  };
  const auto middle = [&](const auto& element) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : element) sum += vertex_at(model.rest, v);
    return Vec3(sum / static_cast<double>(element.size()));
  };
  for (const Tetrahedron& t : model.elements.tetrahedra)
    for (const auto& [i, j, k] : tetrahedron_faces) look({t[i], t[j], t[k]}, middle(t));
  for (const Prism& p : model.elements.prisms) {
    for (const auto& [i, j, k] : prism_triangles) look({p[i], p[j], p[k]}, middle(p));
    for (const auto& q : prism_quads)  // either diagonal may have split it
      for (int i = 0; i < 4; ++i) look({p[q[i]], p[q[(i + 1) % 4]], p[q[(i + 2) % 4]]}, middle(p));
  }
  return sides;
}

/// The wall with a triangle from each edge of the closing polygons to their middle.
TriangleSurface with_polygons(const Points& vertices, const std::vector<Triangle>& wall, const ClosedRim& closed) {
  const Index corners = std::ssize(closed.corners), polygons = std::ssize(closed.polygons);
  TriangleSurface surface{Points(vertices.rows() + corners + polygons, 3), wall};
  surface.vertices.topRows(vertices.rows()) = vertices;
  for (Index i = 0; i < corners; ++i) surface.vertices.row(vertices.rows() + i) = closed.corners[i].transpose();
  for (Index i = 0; i < polygons; ++i) {
    const std::vector<Index>& rim = closed.polygons[i].vertices;
    const Index middle = vertices.rows() + corners + i;
    surface.vertices.row(middle).setZero();
    for (const Index v : rim) surface.vertices.row(middle) += surface.vertices.row(v) / double(rim.size());
    for (std::size_t k = 0; k < rim.size(); ++k)
      surface.triangles.push_back({middle, rim[(k + 1) % rim.size()], rim[k]});
  }
  return surface;
}

class OpenWall {
 public:
  OpenWall(const Compilation& c, const ActuatorSpec& spec, const std::string& name)
      : c_(c), spec_(spec), name_(name), held_(held_axes(c)) {}

  ChamberWall close(std::vector<Triangle> triangles) const {
    turn_outwards(triangles);
    ClosedRim closed = closed_rim(triangles);
    ChamberWall wall{triangles, with_polygons(c_.model.rest, triangles, closed), {}, std::move(closed.corners)};
    const bool quadratic = !c_.regions.edges().empty();
    for (const ClosingPolygon& polygon : closed.polygons)
      for (const CavityFace& face : faces_of(polygon, quadratic)) wall.closing.push_back(face);
    const double volume = enclosed_volume(wall.closed.vertices, wall.closed.triangles), size = c_.model.diagonal_mm;
    if (!(volume > 1e-12 * size * size * size) && c_.sheets.empty())
      refuse("the surface and the planes that close it enclose no volume");
    return wall;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    softkin::refuse(spec_, "has a wall, region '" + name_ + "', that bounds no chamber: " + why +
                               "; the region must hold every face around the chamber and no other");
  }

  /// Normals into the body. Pieces on which the body does not lie enclose a positive volume.
  void turn_outwards(std::vector<Triangle>& triangles) const {
    const std::vector<int> sides = sides_of_body(c_.model, triangles);
    for (const Shell& piece : shells_of(c_.model.rest, triangles)) {
      int side = 0;
      for (const Index t : piece.triangles) side += sides[t];
      if (side == 0) side = volume_of(triangles, piece) < 0 ? -1 : 1;
      if (side > 0) continue;
      for (const Index t : piece.triangles) std::swap(triangles[t][1], triangles[t][2]);
    }
  }

  [[nodiscard]] double volume_of(const std::vector<Triangle>& triangles, const Shell& piece) const {
    std::vector<Triangle> own;
    for (const Index t : piece.triangles) own.push_back(triangles[t]);
    const TriangleSurface surface = with_polygons(c_.model.rest, own, closed_rim(own));
    return enclosed_volume(surface.vertices, surface.triangles);
  }

  [[nodiscard]] ClosedRim closed_rim(const std::vector<Triangle>& triangles) const {
    const std::vector<RimEdge> rim = rim_edges(c_, triangles);
    ClosedRim closed = close_rim(c_.model.rest, rim, held_, plane_tolerance * c_.model.diagonal_mm);
    if (closed.stray) refuse_rim(rim, rim[*closed.stray]);
    return closed;
  }

  [[noreturn]] void refuse_rim(const std::vector<RimEdge>& rim, const RimEdge& stray) const {
    Vec3 middle = Vec3::Zero();
    for (const auto& [from, to, node] : rim)
      middle += (vertex_at(c_.model.rest, from) + vertex_at(c_.model.rest, to)) / (2.0 * double(rim.size()));
    std::string held;
    for (int axis = 0; axis < 3; ++axis)
      if (held_[stray.from][axis] && held_[stray.to][axis])
        held += (held.empty() ? "" : ", ") + std::string(1, "xyz"[axis]);
    const std::string edge = "the edge from " + point_text(vertex_at(c_.model.rest, stray.from)) + " to " +
                             point_text(vertex_at(c_.model.rest, stray.to)) + " mm";
    softkin::refuse(
        spec_,
        "has a wall, region '" + name_ + "', that bounds no chamber: the surface is not closed: its rim of " +
            counted(rim.size(), "edge") + " has its middle at " + point_text(middle) +
            " mm, and no plane that is held closes it: " + edge + " is held along " +
            (held.empty() ? "no axis" : held) +
            "; the region must hold every face around the chamber and no other, or end at a plate (`fixed` along "
            "x, y and z) or at a plane of symmetry normal to an axis along which all vertices of the rim are held");
  }

  const Compilation& c_;
  const ActuatorSpec& spec_;
  const std::string& name_;
  std::vector<std::array<bool, 3>> held_;
};

}  // namespace

ChamberWall closed_by_planes(const Compilation& c, const ActuatorSpec& spec, const std::string& name,
                             std::vector<Triangle> triangles) {
  return OpenWall(c, spec, name).close(std::move(triangles));
}

}  // namespace softkin
