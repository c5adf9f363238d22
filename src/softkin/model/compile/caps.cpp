#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>

namespace softkin {

namespace {

constexpr double coplanar = 1e-6;  // off a plane, over the robot's diagonal: coordinates of an STL have seven digits
/// Where material is looked for behind a face, over the longest edge of the nearest element: as far as a surface may
/// run beside the body.
constexpr double depths[] = {0.01, 0.05, 0.2, 0.5};

/// A face that closes a chamber, while its support is looked for.
struct OpenFace {
  Index face = -1;              // as ChamberCap has it
  std::vector<Index> vertices;  // that carry it
  Triangle corners{};           // over the points of its surface
  int axis = 0;                 // along which its normal is longest
  double area = 0;              // [mm^2]
};

/// The vertices that the entries of `fixed` hold, with those of no element.
class Holders {
 public:
  explicit Holders(const Compilation& c) : c_(c), held_(c.spec.fixed.size()) {
    for (std::size_t s = 0; s < held_.size(); ++s) {
      held_[s].assign(c.model.elements.used.size(), false);
      for (const Index v : c.regions.resolve(c.spec.fixed[s].where).vertices) held_[s][v] = true;
    }
  }

  /// The entry that holds the most vertices of a face against its normal, the first of several; -1: none holds any.
  [[nodiscard]] Index holder_of(const OpenFace& face) const {
    Index holder = -1;
    std::ptrdiff_t most = 0;
    for (std::size_t s = 0; s < held_.size(); ++s) {
      if (!c_.spec.fixed[s].axes[face.axis]) continue;
      const auto count = std::count_if(face.vertices.begin(), face.vertices.end(),
                                       [&](Index v) { return static_cast<bool>(held_[s][v]); });
      if (count <= most) continue;
      most = count;
      holder = static_cast<Index>(s);
    }
    return holder;
  }

 private:
  const Compilation& c_;
  std::vector<std::vector<bool>> held_;
};

void measure_face(const Points& points, OpenFace& face) {
  const Vec3 a = vertex_at(points, face.corners[0]);
  const Vec3 normal = (vertex_at(points, face.corners[1]) - a).cross(vertex_at(points, face.corners[2]) - a);
  normal.cwiseAbs().maxCoeff(&face.axis);
  face.area = 0.5 * normal.norm();
}

/// Sets the supports of the faces. A face in the middle of an opening, whose vertices belong to no support, takes the
/// support with the largest area around the same opening, of the faces with the same main axis of the normal or, where
/// there are none, of all.
void assign_supports(const Holders& holders, const Points& points, const std::vector<OpenFace>& faces,
                     std::vector<ChamberCap>& caps) {
  std::vector<Triangle> triangles;
  std::vector<Index> supports;
  for (const OpenFace& face : faces) {
    triangles.push_back(face.corners);
    supports.push_back(holders.holder_of(face));
  }
  for (const Shell& opening : shells_of(points, triangles)) {
    std::array<std::map<Index, double>, 4> areas;  // by axis, and in all
    for (const Index f : opening.triangles)
      if (supports[f] >= 0)
        for (const int axis : {faces[f].axis, 3}) areas[axis][supports[f]] += faces[f].area;
    for (const Index f : opening.triangles) {
      if (supports[f] >= 0) continue;
      const std::map<Index, double>& around = areas[areas[faces[f].axis].empty() ? 3 : faces[f].axis];
      const auto largest = std::max_element(around.begin(), around.end(),
                                            [](const auto& a, const auto& b) { return a.second < b.second; });
      if (largest != around.end()) supports[f] = largest->first;
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) caps.push_back({faces[f].face, supports[f]});
}

void add_cavity_caps(const Compilation& c, const Holders& holders, ChamberDrive& chamber) {
  std::vector<OpenFace> faces;
  for (const Index f : open_faces(c, chamber.cavity)) {
    OpenFace face{f, nodes_of(chamber.cavity[f]), chamber.cavity[f].corners};
    if (!is_plate(c.model, face.vertices, false)) continue;
    measure_face(c.model.rest, face);
    faces.push_back(std::move(face));
  }
  assign_supports(holders, c.model.rest, faces, chamber.caps);
}

/// The faces of the body's surface that supports hold, as plates and planes of symmetry do.
std::vector<Triangle> plates_of(const Compilation& c, const Body& body) {
  std::vector<Triangle> plates;
  for (const Triangle& t : triangulated(boundary_of(body.tetrahedra, body.prisms)))
    if (is_plate(c.model, {t[0], t[1], t[2]}, false)) plates.push_back(t);
  return plates;
}

/// Where a surface that the body carries crosses a mouth in the plane of a support, its points stay in that plane: the
/// nearest face of the body in it carries them, in place of an element that reaches out of it.
void keep_in_plates(const Compilation& c, const std::vector<Triangle>& plates, ChamberDrive& chamber) {
  if (plates.empty()) return;
  const SurfaceTree tree(c.model.rest, plates);
  const double tolerance = coplanar * c.model.diagonal_mm;
  for (EmbeddedPoint& point : chamber.points) {
    if (!(point.distance_mm > tolerance)) continue;
    const Vec3 at = point.at(c.model.rest);
    Index nearest = -1;
    if (!((at - tree.nearest(at, &nearest)).norm() <= point.distance_mm + tolerance)) continue;
    const Triangle& t = plates[nearest];
    const Vec3 a = vertex_at(c.model.rest, t[0]), b = vertex_at(c.model.rest, t[1]), d = vertex_at(c.model.rest, t[2]);
    const Vec3 normal = (b - a).cross(d - a);
    if (!(std::abs(normal.normalized().dot(at - a)) <= tolerance)) continue;
    const double u = (at - a).cross(d - a).dot(normal) / normal.squaredNorm(),
                 v = (b - a).cross(at - a).dot(normal) / normal.squaredNorm();
    point.vertices = {t[0], t[1], t[2]};
    point.weights = {1 - u - v, u, v};
  }
}

/// Is there an element of the body behind a triangle of a surface, as behind one that lies along the body's wall?
bool has_material_behind(const Body& body, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 middle = (a + b + c) / 3, normal = (b - a).cross(c - a).normalized();
  const double edge = body.embedder.edge_near(middle), inside = 1e-9 * body.diagonal_mm;
  return std::any_of(std::begin(depths), std::end(depths), [&](double depth) {
    const Vec3 behind = middle + depth * edge * normal;
    try {
      return body.embedder.embed(behind).distance_mm <= inside;
    } catch (const InvalidInput&) {  // far outside a curved element
      return false;
    }
  });
}

void add_surface_caps(const Compilation& c, const Body& body, const Holders& holders, ChamberDrive& chamber) {
  keep_in_plates(c, plates_of(c, body), chamber);
  Points points(std::ssize(chamber.points), 3);
  for (Index i = 0; i < points.rows(); ++i) points.row(i) = chamber.points[i].at(c.model.rest).transpose();
  std::vector<OpenFace> faces;
  for (std::size_t f = 0; f < chamber.surface.size(); ++f) {
    OpenFace face{static_cast<Index>(f), {}, chamber.surface[f]};
    for (const Index p : face.corners)
      face.vertices.insert(face.vertices.end(), chamber.points[p].vertices.begin(), chamber.points[p].vertices.end());
    if (!is_plate(c.model, face.vertices, false)) continue;
    if (has_material_behind(body, vertex_at(points, face.corners[0]), vertex_at(points, face.corners[1]),
                            vertex_at(points, face.corners[2])))
      continue;
    measure_face(points, face);
    faces.push_back(std::move(face));
  }
  assign_supports(holders, points, faces, chamber.caps);
}

}  // namespace

void compile_caps(Compilation& c) {
  if (c.spec.formulation != Formulation::physical || c.spec.fixed.empty()) return;
  std::optional<Holders> holders;
  for (std::size_t i = 0; i < c.spec.actuators.size(); ++i) {
    auto* chamber = std::get_if<ChamberDrive>(&c.model.actuators[i].drive);
    if (chamber == nullptr) continue;
    if (!holders) holders.emplace(c);
    if (chamber->surface.empty())
      add_cavity_caps(c, *holders, *chamber);
    else
      add_surface_caps(c, body_of(c, c.spec.actuators[i].robot), *holders, *chamber);
  }
}

}  // namespace softkin
