// Prints the table of docs/estimate.md: how well each kind of reading determines each unknown of a finger under a
// contact force. The numbers are standard deviations of the linear posterior at one place, with the priors included.

#include <cmath>
#include <cstdio>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/model/sensor.hpp>

#include "touched_finger.hpp"

namespace {

using namespace softkin;

/// Readings that a row of the table is of.
struct Row {
  const char* name;
  std::vector<const char*> kinds;
};

/// The finger with a strain sensor along its sole, and a bend sensor from its base to its tip.
RobotSpec finger() {
  RobotSpec spec = bench::touched_finger(false);
  const SensorSpec strain{.name = "strain", .kind = SensorKind::length, .points = {{2, 7.5, 0.5}, {98, 7.5, 0.5}}};
  const SensorSpec bend{
      .name = "bend", .kind = SensorKind::angle, .points = {}, .sections = {"x_low", "x_high"}, .axis = Vec3(0, 1, 0)};
  spec.sensors = {std::make_shared<const SensorSpec>(strain), std::make_shared<const SensorSpec>(bend)};
  return spec;
}

/// All readings, markers first, and their deviations.
std::vector<PoseColumn> all_columns(const Model& model, Eigen::VectorXd& deviations) {
  std::vector<PoseColumn> columns;
  std::vector<double> of;
  for (Index m = 0; m < std::ssize(model.markers); ++m)
    for (int axis = 0; axis < 3; ++axis) {
      columns.push_back({"marker", m, axis});
      of.push_back(0.2);
    }
  columns.push_back({"strain", -1, -1, -1, Reading::length, -1, 0});
  columns.push_back({"bend", -1, -1, -1, Reading::angle, -1, 1});
  columns.push_back({"volume", -1, -1, 0, Reading::volume});
  of.insert(of.end(), {0.05, 0.5, 20});
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back({"load cell", -1, axis, -1, Reading::force, 0});
    of.push_back(0.02);
  }
  deviations = Eigen::Map<const Eigen::VectorXd>(of.data(), of.size());
  return columns;
}

bool is_of(const Row& row, const PoseColumn& column) {
  for (const std::string kind : row.kinds)
    if (column.name == kind || (kind == "tip" && column.marker == 3)) return true;
  return false;
}

/// Deviation; in brackets where it is more than half of what was known before.
void print_cell(double deviation, double known) {
  std::printf(deviation > 0.5 * known ? " (%.2g) |" : " %.2g |", deviation);
}

}  // namespace

int main() {
  const Model model = compile(finger());
  Eigen::VectorXd deviations;
  const std::vector<PoseColumn> columns = all_columns(model, deviations);
  const estimate::Problem problem(model, {{"touch", true}, {"air"}}, columns, {});
  const estimate::Patch& patch = *problem.variables().forces()[0].patch;
  Eigen::VectorXd values(4);
  values << 0.2, 0.2, -0.8, 10;
  const estimate::Guess at = problem.solve(model.rest_actuation(), values, {patch.nearest({65, 7.5, 20})}, nullptr, {});
  if (!at.solved()) {
    std::printf("no equilibrium\n");
    return 1;
  }
  const Eigen::MatrixXd slopes = problem.slopes(problem.nearby(at), at);
  const estimate::Knowledge known(problem.variables());
  const Eigen::MatrixXd directions = estimate::directions_at(problem.variables(), at.places);
  const Eigen::MatrixXd before = directions.transpose() * known.information * directions;
  const std::vector<Row> rows = {{"nothing", {}},
                                 {"4 markers", {"marker"}},
                                 {"the marker at the tip", {"tip"}},
                                 {"strain along the sole", {"strain"}},
                                 {"bend angle", {"bend"}},
                                 {"volume of the chamber", {"volume"}},
                                 {"load cell at the base", {"load cell"}},
                                 {"marker at the tip, strain, bend", {"tip", "strain", "bend"}},
                                 {"marker at the tip, load cell", {"tip", "load cell"}},
                                 {"4 markers, load cell", {"marker", "load cell"}},
                                 {"all", {"marker", "strain", "bend", "volume", "load cell"}}};
  // unknowns that are estimated together: the force at a known place; also the place; the pressure alone; all
  const std::vector<std::vector<Index>> estimated = {{0, 1, 2}, {0, 1, 2, 4, 5}, {3}, {0, 1, 2, 3, 4, 5}};
  std::printf(
      "| read | force at a known place: x | y | z [N] | force anywhere: x | y | z [N] | its place: along | across "
      "[mm] | pressure alone [kPa] | pressure beside force and place [kPa] |\n|---|");
  for (int c = 0; c < 10; ++c) std::printf("---|");
  std::printf("\n");
  for (const Row& row : rows) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(deviations.size());
    for (std::size_t r = 0; r < columns.size(); ++r)
      if (is_of(row, columns[r])) weights[r] = std::pow(deviations[r], -2);
    const Eigen::MatrixXd matrix = slopes.transpose() * weights.asDiagonal() * slopes + before;
    std::printf("| %s |", row.name);
    for (std::size_t set = 0; set < estimated.size(); ++set) {
      const Eigen::MatrixXd own = matrix(estimated[set], estimated[set]),
                            prior = before(estimated[set], estimated[set]);
      const Index size = estimated[set].size();
      const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(size, size);
      const Eigen::MatrixXd covariance = CholeskyFactor(own).solve(identity),
                            first = CholeskyFactor(prior).solve(identity);
      for (Index i = 0; i < size; ++i)
        if (set < 3 || estimated[set][i] == 3) print_cell(std::sqrt(covariance(i, i)), std::sqrt(first(i, i)));
    }
    std::printf("\n");
  }
  return 0;
}
