#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/layers.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/mesh/refine_surface.hpp>
#include <softkin/model/mesh/triangle_points.hpp>

namespace softkin {

namespace {

constexpr double to_newtons_per_mm3 = 1e-9;  // of kg/m^3 by m/s^2
constexpr double min_across = 1e-3;          // of a direction, along a face
constexpr double finest_of_edge = 0.5;       // of an element's edge: triangles of a surface that elements carry along
constexpr std::size_t max_layer_triangles = 200000;

[[noreturn]] void refuse_layer(const LayerSpec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, "layer '" + spec.name + "' " + what);
}

void check_rubber(const LayerSpec& spec) {
  const SheetRubber& rubber = *spec.rubber;
  for (const double value : {rubber.c10, rubber.c01, rubber.c20, rubber.c30})
    if (!std::isfinite(value)) refuse_layer(spec, "has a law with a constant that is not finite");
  if (!(rubber.c01 >= 0))
    refuse_layer(spec, "needs a c01 of 0 or more: rubber that is pressed across would gain by it");
  if (!(rubber.youngs_modulus() > 0)) refuse_layer(spec, "needs c10 + c01 above 0");
  if (spec.bending)
    refuse_layer(spec, "bends, which takes a Young's modulus or orthotropic constants: skins of a rubber law do not");
}

void check_layer(const LayerSpec& spec) {
  const auto above_0 = [&](double value, const std::string& name) {
    if (!(value > 0) || !std::isfinite(value)) refuse_layer(spec, "needs " + name + " above 0");
  };
  above_0(spec.thickness_mm, "a thickness");
  if (!(spec.density >= 0) || !std::isfinite(spec.density)) refuse_layer(spec, "needs a density of 0 or more");
  if (spec.direction && (!spec.direction->allFinite() || !(spec.direction->norm() > 0)))
    refuse_layer(spec, "needs a direction that is not 0");
  if (spec.rubber) return check_rubber(spec);
  above_0(spec.e1, "a Young's modulus along its direction");
  above_0(spec.e2, "a Young's modulus across its direction");
  above_0(spec.g12, "a shear modulus");
  if (!std::isfinite(spec.nu12) || spec.nu12 * spec.nu12 >= spec.e1 / spec.e2)
    refuse_layer(spec, "has a Poisson's ratio of " + number(spec.nu12) + ": its square must be below e1 / e2, " +
                           number(spec.e1 / spec.e2) + ", or it would have no stiffness");
}

SheetLaw law_of(const LayerSpec& spec) {
  const double soft = spec.rubber ? spec.rubber->youngs_modulus() : 0;  // keeps its volume
  const double e1 = spec.rubber ? soft : spec.e1, e2 = spec.rubber ? soft : spec.e2;
  const double nu12 = spec.rubber ? 0.5 : spec.nu12, g12 = spec.rubber ? soft / 3 : spec.g12;
  SheetLaw law{Mat3::Zero(), Mat3::Zero(), false, spec.rubber};
  law.compliance << 1 / e1, -nu12 / e1, 0, -nu12 / e1, 1 / e2, 0, 0, 0, 1 / g12;
  law.stiffness = law.compliance.inverse();
  law.tension_only = spec.tension_only;
  return law;
}

LayerPlace place_on(const LayerSpec& spec, const TrianglePoint& point, const std::vector<Index>& nodes,
                    const Points& rest) {
  const LayerFrame frame(spec, point, nodes, rest);
  LayerPlace place{nodes, {}, {}, frame.area_mm2};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Eigen::Index k = i;
    place.weights.push_back(point.shape[k]);
    place.slopes.push_back(frame.back * Eigen::Vector2d(point.along_u[k], point.along_v[k]));
  }
  return place;
}

/// The faces of a region: of the mesh where it is a group of faces, else those of the body's surface between its
/// vertices.
std::vector<CavityFace> faces_of(const Compilation& c, const LayerSpec& spec, const RegionRef& where) {
  const Region region = c.regions.resolve(where);
  std::vector<Triangle> triangles;
  if (region.dimension == 2) {
    if (!region.quads.empty())
      refuse_layer(spec, "is on " + label(where) + ", which has quadrilaterals: a layer lies on triangles");
    for (const Index i : region.triangles) triangles.push_back(c.mesh.triangles[i]);
  } else {
    std::vector<bool> inside(c.model.elements.used.size());
    for (const Index v : region.vertices) inside[v] = true;
    for (const Triangle& t : boundary_of(c.model.elements.tetrahedra, c.model.elements.prisms).triangles)
      if (inside[t[0]] && inside[t[1]] && inside[t[2]]) triangles.push_back(t);
  }
  if (triangles.empty()) refuse_layer(spec, "is on " + label(where) + ", which holds no face of the body");
  std::vector<CavityFace> faces;
  for (const Triangle& t : triangles) {
    const CavityFace face = face_of(c, t);
    const bool bare = !c.regions.edges().empty() && *std::min_element(face.edges.begin(), face.edges.end()) < 0;
    for (const Index v : nodes_of(face))
      if (bare || !c.model.elements.used[v])
        refuse_layer(spec, "has a face at " + point_text(vertex_at(c.model.rest, t[0])) +
                               " mm, of which a vertex belongs to no element of the robot: a layer beside the body "
                               "takes a mesh of order 1, which 'order: 2' raises");
    faces.push_back(face);
  }
  return faces;
}

/// Places of a surface that elements carry along: its triangles, cut as finely as these.
std::vector<LayerPlace> carried_places(Compilation& c, const LayerSpec& spec, TriangleSurface surface) {
  if (spec.bending) refuse_layer(spec, "bends, which takes faces of the mesh: name their `region`");
  const Body& body = body_of(c, spec.robot);
  if (body.embedder.empty()) refuse_layer(spec, "needs a body that carries it, but every element belongs to a chamber");
  std::vector<EmbeddedPoint> points;
  try {
    surface = refined(
        std::move(surface), [&](const Vec3& middle) { return finest_of_edge * body.embedder.edge_near(middle); },
        max_layer_triangles);
    for (Index i = 0; i < surface.vertices.rows(); ++i)
      points.push_back(body.embedder.embed(vertex_at(surface.vertices, i)));
  } catch (const InvalidInput& error) {
    refuse_layer(spec, std::string("has a surface that the elements cannot carry: ") + error.what());
  }
  Points embedded(surface.vertices.rows(), 3);
  for (Index i = 0; i < embedded.rows(); ++i) {
    const Vec3 vertex = vertex_at(surface.vertices, i);
    const double distance = points[i].distance_mm;
    if (const double most = max_outside(body, c.model.rest, vertex); distance > most)
      refuse_layer(spec, "has a point, " + point_text(vertex) + " mm, that is " + number(distance) +
                             " mm from the body, " + too_far_text(most) + ": check its unit");
    embedded.row(i) = points[i].at(c.model.rest).transpose();
  }
  std::vector<LayerPlace> places;
  for (const Triangle& t : surface.triangles) {
    const LayerPlace flat = place_on(spec, strain_points(3).front(), {t.begin(), t.end()}, embedded);
    LayerPlace place{{}, {}, {}, flat.area_mm2};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const EmbeddedPoint& point = points[t[corner]];
      for (std::size_t i = 0; i < point.vertices.size(); ++i) {
        const auto found = std::find(place.vertices.begin(), place.vertices.end(), point.vertices[i]);
        const std::size_t at = found - place.vertices.begin();
        if (found == place.vertices.end()) {
          place.vertices.push_back(point.vertices[i]);
          place.weights.push_back(0);
          place.slopes.emplace_back(0, 0);
        }
        place.weights[at] += flat.weights[corner] * point.weights[i];
        place.slopes[at] += point.weights[i] * flat.slopes[corner];
      }
    }
    places.push_back(std::move(place));
  }
  return places;
}

void add_layer_weight(Compilation& c, const LayerSpec& spec, const Layer& layer) {
  const Vec3 per_area = spec.density * to_newtons_per_mm3 * spec.thickness_mm * c.spec.loads.gravity;
  for (const LayerPlace& place : layer.places)
    for (std::size_t i = 0; i < place.vertices.size(); ++i)
      c.model.loads.dead.row(place.vertices[i]) += place.area_mm2 * place.weights[i] * per_area.transpose();
}

Layer layer_of(Compilation& c, const LayerSpec& spec) {
  check_layer(spec);
  Layer layer{spec.name, spec.thickness_mm, law_of(spec), {}, {}, {}, {}};
  if (const auto* surface = std::get_if<TriangleSurface>(&spec.where)) {
    layer.places = carried_places(c, spec, *surface);
    return layer;
  }
  layer.faces = faces_of(c, spec, std::get<RegionRef>(spec.where));
  for (const CavityFace& face : layer.faces) {
    const std::vector<Index> nodes = nodes_of(face);
    for (const TrianglePoint& point : strain_points(nodes.size()))
      layer.places.push_back(place_on(spec, point, nodes, c.model.rest));
  }
  if (!spec.bending) return layer;
  if (c.regions.edges().empty())
    refuse_layer(spec, "bends, which takes a mesh of order 2 (`mesh: {order: 2}`): flat triangles do not bend");
  add_bending(spec, c.model.rest, c.model.held.fixed, layer);
  return layer;
}

}  // namespace

CavityFace face_of(const Compilation& c, const Triangle& corners) {
  CavityFace face{corners};
  if (!c.regions.edges().empty()) face.edges = c.regions.edges().of(corners);
  return face;
}

const std::vector<TrianglePoint>& strain_points(std::size_t nodes) {
  static const std::vector<TrianglePoint> one(triangle_points(3).begin(), triangle_points(3).end());
  static const std::vector<TrianglePoint> three = {triangle_point(1.0 / 6, 1.0 / 6, 1.0 / 6),
                                                   triangle_point(2.0 / 3, 1.0 / 6, 1.0 / 6),
                                                   triangle_point(1.0 / 6, 2.0 / 3, 1.0 / 6)};
  return nodes == 3 ? one : three;
}

LayerFrame::LayerFrame(const LayerSpec& spec, const TrianglePoint& point, const std::vector<Index>& nodes,
                       const Points& rest) {
  const SurfaceEdges edges(point, nodes, rest);
  const Vec3 area = edges.u.cross(edges.v);
  if (!(area.norm() > 0)) refuse_layer(spec, "has a face without area");
  area_mm2 = point.weight * area.norm();
  normal = area.normalized();
  Vec3 along = spec.direction.value_or(Vec3::Zero());
  if (!spec.direction) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().minCoeff(&axis);
    along = Vec3::Unit(axis);
  }
  along = (along.normalized() - along.normalized().dot(normal) * normal).eval();
  if (along.norm() < min_across)
    refuse_layer(spec, "has a direction that stands across one of its faces: no direction in it follows");
  axes << along.normalized(), normal.cross(along.normalized());
  Eigen::Matrix2d jacobian;
  jacobian << axes.transpose() * edges.u, axes.transpose() * edges.v;
  back = jacobian.inverse().transpose();
}

void use_sheets(Compilation& c) {
  if (c.spec.formulation != Formulation::physical) return;
  for (const auto& spec : c.spec.layers) {
    const auto* where = std::get_if<RegionRef>(&spec->where);
    if (where == nullptr) continue;
    const Region region = c.regions.resolve(*where);
    if (region.dimension != 2) continue;
    for (const Index i : region.triangles) {
      const Triangle& t = c.mesh.triangles[i];
      if (std::all_of(t.begin(), t.end(), [&](Index v) { return static_cast<bool>(c.model.elements.used[v]); }))
        continue;
      c.sheets.push_back(t);
    }
  }
  for (const Triangle& t : c.sheets)
    for (const Index v : nodes_of(face_of(c, t)))
      if (v >= 0) c.model.elements.used[v] = true;  // else the layer is refused
}

void compile_layers(Compilation& c) {
  if (c.spec.layers.empty()) return;
  if (c.spec.formulation != Formulation::physical) {
    c.model.notes.push_back(counted(c.spec.layers.size(), "layer is", "layers are") +
                            " left out: the target-shape formulation knows no forces.");
    return;
  }
  std::set<std::string> names;
  for (const auto& spec : c.spec.layers) {
    if (!names.insert(spec->name).second) throw InvalidInput(spec->origin, "there are two layers '" + spec->name + "'");
    c.model.reinforcement.layers.push_back(std::make_shared<const Layer>(layer_of(c, *spec)));
    add_layer_weight(c, *spec, *c.model.reinforcement.layers.back());
  }
}

}  // namespace softkin
