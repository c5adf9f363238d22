#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <softkin/core/dense.hpp>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/mesh/surface_tree.hpp>

namespace softkin {

namespace {

/// Refuses a vertex that turns and that another support holds too, as its place would depend on the angle.
void check_turned(const Compilation& c, const FixedSpec& spec, const std::vector<Index>& vertices) {
  for (const Index v : vertices) {
    const bool held =
        std::any_of(c.model.held.fixed[v].begin(), c.model.held.fixed[v].end(), [](bool axis) { return axis; });
    if (turn_of(c.model, v) == nullptr && !(spec.rotation && held)) continue;
    throw InvalidInput(spec.where.origin, label(spec.where) + " holds vertex " + std::to_string(v) + " (from 0" +
                                              robot_text(c.spec, &RobotPart::vertices, v) + "), which an earlier " +
                                              "entry holds, and one of the two turns it");
  }
}

void hold(Compilation& c, const FixedSpec& spec, Index v, int axis) {
  const double place = c.model.rest(v, axis) + spec.displacement[axis];
  if (c.model.elements.used[v] && c.model.held.fixed[v][axis] && c.model.held.at(v, axis) != place)
    throw InvalidInput(spec.where.origin, label(spec.where) + " holds vertex " + std::to_string(v) + " (from 0" +
                                              robot_text(c.spec, &RobotPart::vertices, v) + ") along " + "xyz"[axis] +
                                              " elsewhere than an earlier entry");
  c.model.held.fixed[v][axis] = true;
  c.model.held.at(v, axis) = place;
  Index& bearer = c.model.held.support_of[v][axis];
  if (c.model.elements.used[v] && bearer < 0) bearer = std::ssize(c.model.held.supports) - 1;
}

void fix(Compilation& c, const FixedSpec& spec) {
  if (std::none_of(spec.axes.begin(), spec.axes.end(), [](bool axis) { return axis; }))
    throw InvalidInput(spec.where.origin, label(spec.where) + " is fixed along no axis");
  if (!spec.displacement.allFinite())
    throw InvalidInput(spec.where.origin, label(spec.where) + " is displaced by a number that is not finite");
  const Region region = c.regions.resolve(spec.where);
  Support& support = c.model.held.supports.emplace_back();
  support.name = support_name(c.spec.fixed, &spec - c.spec.fixed.data());
  std::copy_if(region.vertices.begin(), region.vertices.end(), std::back_inserter(support.vertices),
               [&](Index v) { return static_cast<bool>(c.model.elements.used[v]); });
  if (support.vertices.empty())
    throw InvalidInput(spec.where.origin, label(spec.where) + " cannot be fixed: it holds no vertex of the body");
  check_turned(c, spec, support.vertices);
  if (spec.rotation) add_turn(c, spec, support);
  for (int axis = 0; axis < 3; ++axis) {
    if (!spec.axes[axis] && spec.displacement[axis] != 0)
      throw InvalidInput(spec.where.origin,
                         label(spec.where) + " is displaced along " + "xyz"[axis] + " but not held along it");
    if (!spec.axes[axis]) continue;
    for (const Index v : region.vertices) hold(c, spec, v, axis);
  }
}

std::string rigid_label(const RigidSpec& spec) {
  return spec.name.empty() ? label(spec.where) : "rigid region '" + spec.name + "'";
}

RigidRegion rigid_region(const Compilation& c, const RigidSpec& spec) {
  RigidRegion rigid;
  rigid.name = spec.name;
  for (const Index v : c.regions.resolve(spec.where).vertices)
    if (c.model.elements.used[v]) rigid.vertices.push_back(v);
  if (!span_plane(c.model.rest, rigid.vertices))
    throw InvalidInput(spec.where.origin, rigid_label(spec) +
                                              " needs three vertices that are not on one line; it holds " +
                                              counted(rigid.vertices.size(), "vertex", "vertices"));
  return rigid;
}

// A rigid region moves as one, so it can be held along an axis as a whole or not at all.
void check_held(const Compilation& c, const RigidSpec& spec, const RigidRegion& rigid) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Index> held;
    for (const Index v : rigid.vertices)
      if (c.model.held.fixed[v][axis]) held.push_back(v);
    const auto moved = [&](Index v) { return c.model.held.at(v, axis) - c.model.rest(v, axis); };
    for (const Index v : held)
      if (std::abs(moved(v) - moved(held.front())) > 1e-12 * c.model.diagonal_mm)
        throw InvalidInput(spec.where.origin,
                           rigid_label(spec) + " is held along " + "xyz"[axis] + " with different displacements");
    if (!held.empty() && !span_plane(c.model.rest, held))
      throw InvalidInput(spec.where.origin,
                         rigid_label(spec) + " is held along " + "xyz"[axis] +
                             " at fewer than three non-collinear vertices: hold a face of it or none");
  }
}

/// Assigns all vertices of a held rigid region to one support.
void bear(Model& model, const RigidRegion& rigid) {
  Index bearer = -1;
  for (const Index v : rigid.vertices)
    for (const Index each : model.held.support_of[v])
      if (each >= 0 && (bearer < 0 || each < bearer)) bearer = each;
  if (bearer < 0) return;
  for (const Index v : rigid.vertices) model.held.support_of[v] = {bearer, bearer, bearer};
}

class Parts {
 public:
  explicit Parts(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  template <class Vertices>
  void join(const Vertices& vertices) {
    for (const Index v : vertices) parent_[root(v)] = root(vertices[0]);
  }

 private:
  std::vector<Index> parent_;
};

Parts connected_parts(const Model& model) {
  Parts parts(model.rest.rows());
  for (const Tetrahedron& t : model.elements.tetrahedra) parts.join(t);
  for (std::size_t e = 0; e < model.elements.edge_nodes.size(); ++e) {
    parts.join(model.elements.edge_nodes[e]);
    parts.join(std::array{model.elements.tetrahedra[e][0], model.elements.edge_nodes[e][0]});
  }
  for (const Prism& p : model.elements.prisms) parts.join(p);
  for (const auto& layer : model.reinforcement.layers)
    for (const CavityFace& face : layer->faces) parts.join(nodes_of(face));
  for (const RigidRegion& rigid : model.rigid) parts.join(rigid.vertices);
  for (const Actuator& actuator : model.actuators) {
    const auto* cable = actuator.as<CableDrive>();
    if (!cable) continue;
    for (const CableGap& gap : cable->gaps) {
      std::vector<Index> corners = gap.apex.vertices;
      for (const Index end : {gap.segment, gap.segment + 1}) {
        const auto& vertices = cable->points[end].vertices;
        corners.insert(corners.end(), vertices.begin(), vertices.end());
      }
      parts.join(corners);
    }
  }
  return parts;
}

using Motions = Eigen::Matrix<double, 6, Eigen::Dynamic>;     // translation over rotation, a motion a column
using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic>;  // orthonormal columns
constexpr double rank_tolerance = 1e-9, direction_tolerance = 1e-6;

// Rigid motions that leave every fixed vertex where it is held, to first order; rotations are about the centroid
// and in units of the size.
Motions free_motions(const Model& model, const std::vector<Index>& vertices, const Vec3& centroid, double size) {
  std::vector<Eigen::Matrix<double, 1, 6>> rows;
  for (const Index v : vertices)
    for (int axis = 0; axis < 3; ++axis) {
      if (!model.held.fixed[v][axis]) continue;
      const Vec3 unit = Vec3::Unit(axis);
      rows.emplace_back();
      rows.back() << unit.transpose(), ((vertex_at(model.rest, v) - centroid) / size).cross(unit).transpose();
    }
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(std::max<Eigen::Index>(6, static_cast<Eigen::Index>(rows.size())), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) held.row(i) = rows[i];
  const SingularValues singular = singular_values(triangle_of(held));
  const Eigen::Index rank = (singular.values.array() > rank_tolerance * std::max(singular.values[0], 1.0)).count();
  return singular.right.rightCols(6 - rank);
}

// An orthonormal basis of what the columns span.
Directions span_of(const Eigen::MatrixXd& columns) {
  if (columns.cols() == 0) return Directions(3, 0);
  const SingularValues singular = singular_values(columns.transpose());
  return singular.right.leftCols((singular.values.array() > direction_tolerance).count());
}

// "x, y and z" for the space that the columns span; directions that are not along an axis as vectors.
std::string axes_text(Directions space) {
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 unit = Vec3::Unit(axis);
    if ((space * (space.transpose() * unit) - unit).norm() > direction_tolerance) continue;
    names.emplace_back(1, "xyz"[axis]);
    space = span_of(space - unit * (unit.transpose() * space));
  }
  for (Eigen::Index i = 0; i < space.cols(); ++i) names.push_back(point_text(space.col(i)));
  std::string text = names[0];
  for (std::size_t i = 1; i < names.size(); ++i) text += (i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

std::string motion_text(const Motions& motions) {
  const Eigen::MatrixXd rotations = motions.bottomRows(3);
  const SingularValues singular = singular_values(rotations);
  const Eigen::Index turning = (singular.values.array() > direction_tolerance).count();
  const Directions turns = span_of(rotations);
  const Directions moves = span_of(motions.topRows(3) * singular.right.rightCols(motions.cols() - turning));
  std::string text;
  if (moves.cols() > 0) text = "move along " + axes_text(moves);
  if (turns.cols() > 0) text += (text.empty() ? "" : " and ") + ("turn about " + axes_text(turns));
  return text;
}

// "8 vertices around (1, 2, 3) mm can move along x", or "" where the part is held.
std::string freedom_of(const Model& model, const std::vector<Index>& vertices) {
  Vec3 centroid = Vec3::Zero();
  Bounds bounds;
  for (const Index v : vertices) {
    centroid += vertex_at(model.rest, v);
    bounds.extend(vertex_at(model.rest, v));
  }
  centroid /= static_cast<double>(vertices.size());
  const Motions motions = free_motions(model, vertices, centroid, bounds.diagonal().norm());
  if (motions.cols() == 0) return "";
  return counted(vertices.size(), "vertex", "vertices") + " around " + point_text(centroid) + " mm can " +
         motion_text(motions);
}

}  // namespace

std::string support_name(const std::vector<FixedSpec>& fixed, std::size_t entry) {
  if (!fixed[entry].name.empty()) return fixed[entry].name;
  const auto* name = std::get_if<std::string>(&fixed[entry].where.region);
  const auto holds = [&](const FixedSpec& other) {
    const auto* region = std::get_if<std::string>(&other.where.region);
    return name && ((region && *region == *name) || other.name == *name);
  };
  if (std::count_if(fixed.begin(), fixed.end(), holds) == 1) return *name;
  return "fixed_" + std::to_string(entry + 1);
}

void compile_supports(Compilation& c) {
  c.model.held.support_of.assign(c.model.elements.used.size(), {-1, -1, -1});
  for (const FixedSpec& spec : c.spec.fixed) fix(c, spec);
  std::vector<Index> owner(c.model.elements.used.size(), -1);
  std::set<std::string> names;
  for (const RigidSpec& spec : c.spec.rigid) {
    if (!spec.name.empty() && !names.insert(spec.name).second)
      throw InvalidInput(spec.where.origin, "there are two rigid regions '" + spec.name + "'");
    RigidRegion rigid = rigid_region(c, spec);
    for (const Index v : rigid.vertices) {
      if (owner[v] >= 0)
        throw InvalidInput(spec.where.origin, rigid_label(spec) + " and " + rigid_label(c.spec.rigid[owner[v]]) +
                                                  " share vertex " + std::to_string(v) +
                                                  " (from 0): make them one, or keep them apart");
      owner[v] = c.model.rigid.size();
    }
    check_held(c, spec, rigid);
    turn_rigid(c.model, rigid, rigid_label(spec), spec.where.origin);
    bear(c.model, rigid);
    c.model.rigid.push_back(std::move(rigid));
  }
}

void check_anchoring(const Model& model, const Origin& origin) {
  constexpr std::size_t max_named = 5;
  Parts parts = connected_parts(model);
  std::map<Index, std::vector<Index>> members;
  for (Index v = 0; v < model.rest.rows(); ++v)
    if (model.elements.used[v]) members[parts.root(v)].push_back(v);
  std::string text;
  std::size_t loose = 0;
  for (const auto& [root, vertices] : members) {
    const std::string freedom = freedom_of(model, vertices);
    if (freedom.empty() || ++loose > max_named) continue;
    text += (loose == 1 ? "" : "; ") + std::string(members.size() == 1 ? "the robot" : "a part") + " of " + freedom;
  }
  if (loose == 0) return;
  if (loose > max_named) text += "; and " + counted(loose - max_named, "more part", "more parts");
  throw InvalidInput(origin, text + (loose == 1 ? ": fix more of it, or connect it to a part that is held"
                                                : ": fix more of them, or connect them to a part that is held"));
}

}  // namespace softkin
