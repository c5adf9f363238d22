#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <softkin/model/mesh/triangle_points.hpp>
#include <softkin/statics/chamber_caps.hpp>

namespace softkin {

namespace {

/// The nodes of a cap, each a vertex or an embedded point.
class CapNodes {
 public:
  CapNodes(const ChamberDrive& chamber, const ChamberCap& cap) {
    if (chamber.surface.empty())
      vertices_ = nodes_of(chamber.cavity[cap.face]);
    else
      for (const Index p : chamber.surface[cap.face]) points_.push_back(&chamber.points[p]);
  }

  [[nodiscard]] std::size_t size() const { return vertices_.size() + points_.size(); }

  /// Returns the nodes' values of a field on the vertices, #V by 3.
  [[nodiscard]] Points of(const Points& values) const {
    Points rows(static_cast<Eigen::Index>(size()), 3);
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      rows.row(i) =
          points_.empty() ? Vec3(values.row(vertices_[i]).transpose()).transpose() : points_[i]->at(values).transpose();
    return rows;
  }

  /// Calls visit(vertex, its weight) for the vertices of a node.
  template <class Visit>
  void each_vertex(std::size_t node, const Visit& visit) const {
    if (points_.empty()) return visit(vertices_[node], 1.0);
    const EmbeddedPoint& point = *points_[node];
    for (std::size_t k = 0; k < point.vertices.size(); ++k) visit(point.vertices[k], point.weights[k]);
  }

 private:
  std::vector<Index> vertices_;
  std::vector<const EmbeddedPoint*> points_;
};

/// Integrals of the shape functions times the area vector, a row for each node [mm^2]; moves: their derivative along
/// these.
Points area_vectors(const Points& nodes, const Points* moves) {
  std::vector<Index> all(nodes.rows());
  std::iota(all.begin(), all.end(), 0);
  Points sum = Points::Zero(nodes.rows(), 3);
  for (const TrianglePoint& point : triangle_points(all.size())) {
    const SurfaceEdges at(point, all, nodes);
    Vec3 area = at.u.cross(at.v);
    if (moves != nullptr) {
      const SurfaceEdges along(point, all, *moves);
      area = along.u.cross(at.v) + at.u.cross(along.v);
    }
    for (Eigen::Index i = 0; i < nodes.rows(); ++i) sum.row(i) += point.weight * point.shape[i] * area.transpose();
  }
  return sum;
}

/// Adds the rows, where vertices are held, to the vertices: visit(vertex, force).
template <class Visit>
void spread(const Model& model, const CapNodes& nodes, const Points& rows, const Visit& visit) {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    nodes.each_vertex(i, [&](Index v, double weight) {
      Vec3 force = weight * rows.row(i).transpose();
      for (int axis = 0; axis < 3; ++axis)
        if (!model.held.fixed[v][axis]) force[axis] = 0;
      visit(v, force);
    });
}

}  // namespace

bool has_caps(const Actuator& actuator) {
  const auto* chamber = actuator.as<ChamberDrive>();
  return chamber != nullptr && !chamber->caps.empty();
}

void add_cap_force(const Model& model, const Actuator& actuator, const Points& positions, double pressure,
                   Points& force) {
  if (!has_caps(actuator) || pressure == 0) return;
  const ChamberDrive& chamber = *actuator.as<ChamberDrive>();
  for (const ChamberCap& cap : chamber.caps) {
    const CapNodes nodes(chamber, cap);
    spread(model, nodes, pressure * area_vectors(nodes.of(positions), nullptr),
           [&](Index v, const Vec3& each) { force.row(v) += each.transpose(); });
  }
}

void add_cap_force_change(const Model& model, const Actuator& actuator, const Points& positions, const Points& moves,
                          double pressure, Points& force) {
  if (!has_caps(actuator) || pressure == 0) return;
  const ChamberDrive& chamber = *actuator.as<ChamberDrive>();
  for (const ChamberCap& cap : chamber.caps) {
    const CapNodes nodes(chamber, cap);
    const Points along = nodes.of(moves);
    spread(model, nodes, pressure * area_vectors(nodes.of(positions), &along),
           [&](Index v, const Vec3& each) { force.row(v) += each.transpose(); });
  }
}

std::vector<std::vector<ChamberForce>> chamber_forces(const Model& model, const Points& positions,
                                                      const std::vector<Vec3>& centers,
                                                      const Eigen::VectorXd& pressures) {
  constexpr double megapascals = 1e-3;  // in a kPa
  std::vector<std::vector<ChamberForce>> all(model.held.supports.size());
  for (Index a = 0; a < std::min<Index>(std::ssize(model.actuators), pressures.size()); ++a) {
    if (!has_caps(model.actuators[a])) continue;
    const ChamberDrive& chamber = *model.actuators[a].as<ChamberDrive>();
    for (const ChamberCap& cap : chamber.caps) {
      if (cap.support < 0) continue;
      std::vector<ChamberForce>& on = all[cap.support];
      if (on.empty() || on.back().actuator != a) on.push_back({a});
      const CapNodes nodes(chamber, cap);
      spread(model, nodes, megapascals * pressures[a] * area_vectors(nodes.of(positions), nullptr),
             [&](Index v, const Vec3& force) {
               on.back().force += force;
               on.back().moment += (vertex_at(positions, v) - centers[cap.support]).cross(force);
             });
    }
  }
  return all;
}

}  // namespace softkin
