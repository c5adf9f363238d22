#include "random/confirm.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <limits>
#include <softkin/statics/deformation.hpp>

#include "random/exact_sign.hpp"
#include "random/reference_elements.hpp"

namespace softkin::random_robots {

std::string digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

Points held_places(const Model& model, const State& state) {
  Points places = model.rest + state.load_factor * (model.held.at - model.rest);
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const auto* command = model.actuators[a].as<TurnCommand>();
    if (!command) continue;
    const SupportTurn& turn = model.held.turns[command->turn];
    const double angle = state.load_factor * state.actuation[a] * std::acos(-1.0) / 180;
    for (const Index v : turn.vertices) {  // Rodrigues
      const Vec3 arm = model.rest.row(v).transpose() - turn.about;
      const Vec3 turned = std::cos(angle) * arm + std::sin(angle) * turn.axis.cross(arm) +
                          (1 - std::cos(angle)) * turn.axis.dot(arm) * turn.axis;
      places.row(v) = (turn.about + turned + state.load_factor * turn.displacement).transpose();
    }
  }
  return places;
}

RigidMoves moves_of(const Model& model, const RigidRegion& region) {
  RigidMoves moves;
  for (const Index v : region.vertices)
    for (int axis = 0; axis < 3; ++axis)
      if (model.held.fixed[v][axis]) {
        moves.slides[axis] = false;
        moves.turns[(axis + 1) % 3] = moves.turns[(axis + 2) % 3] = false;
      }
  return moves;
}

namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();

/// Determinant of d(position)/d(parent) of a tetrahedron of order 2, and the size of what it is the difference of.
std::pair<Real, Real> quadratic_jacobian(const Points& p, const Tetrahedron& t, const EdgeNodes& edges,
                                         const std::array<Real, 4>& l) {
  RealMat3 columns = RealMat3::Zero();
  const RealVec3 origin = p.row(t[0]).transpose().cast<Real>();
  Real largest = 0;
  const auto add = [&](Index node, int by, Real slope) {  // derivative of its shape function by L_by
    const RealVec3 arm = p.row(node).transpose().cast<Real>() - origin;
    largest = std::max(largest, arm.norm());
    for (int j = 0; j < 3; ++j) columns.col(j) += (by == 0 ? -slope : by == j + 1 ? slope : 0) * arm;
  };
  for (int i = 0; i < 4; ++i) add(t[i], i, 4 * l[i] - 1);
  for (int e = 0; e < 6; ++e) {
    const auto& [i, j] = tetrahedron_edges[e];
    add(edges[e], i, 4 * l[j]);
    add(edges[e], j, 4 * l[i]);
  }
  return {columns.determinant(), largest * largest * largest};
}

/// Returns -1, 0 (undecided) or 1: the minimum sign at the corners and the four points of the energy's quadrature rule.
int quadratic_orientation(const Points& p, const Tetrahedron& t, const EdgeNodes& edges) {
  const Real far = (5 - std::sqrt(5.0L)) / 20, near = 1 - 3 * far;
  double coordinates = 0;
  for (const Index v : t) coordinates = std::max(coordinates, p.row(v).cwiseAbs().maxCoeff());
  int least = 1;
  for (int q = 0; q < 4; ++q)
    for (const bool corner : {false, true}) {
      std::array<Real, 4> l;
      for (int i = 0; i < 4; ++i) l[i] = corner ? i == q : i == q ? near : far;
      const auto [value, scale] = quadratic_jacobian(p, t, edges, l);
      const Real doubt = 1e3L * ulp * (scale + std::pow(scale, 2.0L / 3) * coordinates);
      least = std::min(least, value > doubt ? 1 : value < -doubt ? -1 : 0);
    }
  return least;
}

void count_inverted(const Model& model, const Points& positions, Confirmation& out) {
  const ElementDeformation deformation = deformation_of(model, positions);
  long reported = 0, exact = 0, doubtful = 0;
  const auto count = [&](std::size_t element, int orientation, bool decided) {
    const bool inverted = !(deformation.volume_ratio[element] > 0);
    if (!decided && orientation == 0) {
      ++doubtful;
      return;
    }
    reported += inverted;
    exact += orientation <= 0;
  };
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    if (model.elements.edge_nodes.empty())
      count(e, exact_orientation(positions, model.elements.tetrahedra[e]), true);
    else
      count(e, quadratic_orientation(positions, model.elements.tetrahedra[e], model.elements.edge_nodes[e]), false);
  for (std::size_t e = 0; e < model.elements.prisms.size(); ++e)
    count(model.elements.tetrahedra.size() + e, exact_orientation(positions, model.elements.prisms[e]), true);
  out.inverted = exact;
  if (reported != exact)
    out.faults.push_back("inverted elements: " + std::to_string(reported) + " are reported, " + std::to_string(exact) +
                         " are" + (doubtful > 0 ? " (" + std::to_string(doubtful) + " too near to say)" : ""));
}

void check_report(const Actuation& command, const Equilibrium& found, Confirmation& out) {
  const SolveReport& report = found.report;
  const State& state = found.state;
  if (!state.positions.allFinite()) out.faults.emplace_back("a coordinate is not finite");
  if (!state.multipliers.allFinite()) out.faults.emplace_back("a tension or pressure is not finite");
  for (const double value : {report.energy, report.step_mm, report.tolerance_mm, report.gradient_norm,
                             report.estimated_error_mm, report.reached, state.load_factor})
    if (!std::isfinite(value)) {
      out.faults.emplace_back("a number of the report is not finite");
      break;
    }
  if (!(report.reached >= 0 && report.reached <= 1)) out.faults.push_back("reached is " + digits(report.reached));
  const bool explains = report.status == Status::limit || report.status == Status::not_converged;
  if (explains && report.remark.empty())
    out.faults.emplace_back(std::string(report.status == Status::limit ? "limit" : "not converged") +
                            " without a remark");
  if (found.actuation.size() != command.size() || found.actuation != command)
    out.faults.emplace_back("the answer is for another command");
  if (report.status != Status::converged) return;
  if (report.reached != 1) out.faults.push_back("converged, but reached is " + digits(report.reached));
  if (state.actuation.size() != command.size() || state.actuation != command || state.load_factor != 1)
    out.faults.emplace_back("converged, but its state is that of another command");
}

}  // namespace

State long_rest(const Model& model, StaticsOptions options) {
  const Statics statics(model);
  const bool remembers = statics.viscous() && std::isfinite(options.elapsed_s);
  options.elapsed_s = std::numeric_limits<double>::infinity();
  return remembers ? statics.solve(model.rest_actuation(), statics.rest(), options).state
                   : State{model.rest, model.rest_actuation()};
}

Confirmation confirm(const Model& model, const Actuation& command, const Equilibrium& found, const State& begun) {
  Confirmation out;
  check_report(command, found, out);
  if (!found.state.positions.allFinite()) return out;
  count_inverted(model, found.state.positions, out);
  const bool known = found.state.knows(model.actuators.size()) &&
                     (found.report.status == Status::converged || found.state.actuation.size() > 0 ||
                      model.formulation == Formulation::physical);
  if (!known || !found.state.multipliers.allFinite()) return out;
  out.is_equilibrium = true;
  if (model.formulation == Formulation::physical)
    confirm_physical(model, found, begun, out);
  else
    confirm_target_shape(model, found, out);
  return out;
}

}  // namespace softkin::random_robots
