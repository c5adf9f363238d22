#include <algorithm>
#include <chrono>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/estimate/variables.hpp>
#include <softkin/kinematics/map_estimate.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/map_estimates.hpp>

namespace softkin::runs {

namespace {

/// An output of a map as it is read.
struct ReadOutput {
  Index output = 0;
  double size = 1;  // of a reading per unit of the output
};

/// "tip_x", "air_pressure", "air_ratio"
std::string output_name(const Model& model, const PoseColumn& column) {
  if (column.marker >= 0) return model.markers[column.marker].name + "_" + axis_names[column.axis];
  if (column.actuator < 0) return "";
  const bool measure = column.kind == Reading::length || column.kind == Reading::volume;
  return model.actuators[column.actuator].name + "_" +
         (measure ? "ratio" : reading_names[static_cast<std::size_t>(column.kind)]);
}

std::vector<ReadOutput> read_outputs(const KinematicMap& map, const Model& model, const MeasuredPoses& poses) {
  std::vector<ReadOutput> read;
  const std::vector<MapOutput>& outputs = map.data().outputs;
  for (const PoseColumn& column : poses.columns) {
    const std::string name = output_name(model, column);
    const auto found =
        std::find_if(outputs.begin(), outputs.end(), [&](const MapOutput& output) { return output.name == name; });
    if (found == outputs.end())
      throw InvalidInput({poses.file},
                         "column '" + column.name + "' is nothing that the map gives: the solver estimates from it");
    const bool ratio = column.marker < 0 && name.ends_with("_ratio");
    read.push_back(
        {static_cast<Index>(found - outputs.begin()), ratio ? model.actuators[column.actuator].rest_measure : 1});
  }
  return read;
}

std::vector<MapUnknown> map_unknowns(const KinematicMap& map, const Model& model,
                                     const estimate::Variables& variables) {
  if (!variables.forces().empty())
    throw InvalidInput("the force '" + variables.forces()[0].name +
                       "' acts anywhere on its region, and a map has forces at known places: the solver estimates it");
  std::vector<MapUnknown> unknowns;
  const std::vector<MapInput>& inputs = map.data().inputs;
  for (const estimate::Variable& variable : variables.all()) {
    const auto found = std::find_if(inputs.begin(), inputs.end(), [&](const MapInput& input) {
      return variable.actuator >= 0 && input.actuator == variable.actuator;
    });
    if (found == inputs.end())
      throw InvalidInput("'" + estimate::name_of(model, variable) +
                         "' is no input of the map: the solver estimates it");
    unknowns.push_back({static_cast<Index>(found - inputs.begin()), variable.mean, variable.deviation});
  }
  return unknowns;
}

/// Rows of readings by a map.
class MapRows {
 public:
  MapRows(const KinematicMap& map, const RequestedEstimates& requested)
      : map_(map),
        requested_(requested),
        variables_(requested.model, requested.unknowns),
        unknowns_(map_unknowns(map, requested.model, variables_)),
        read_(read_outputs(map, requested.model, requested.poses)),
        deviations_(requested.deviations_of_columns()) {}

  [[nodiscard]] std::vector<Index> reported_actuators() const {
    std::vector<Index> reported;
    for (const estimate::Variable& variable : variables_.all()) reported.push_back(variable.actuator);
    return reported;
  }

  [[nodiscard]] Estimate describe(std::size_t row) const {
    const auto begin = std::chrono::steady_clock::now();
    const Actuation& given = requested_.poses.commands[row];
    Eigen::VectorXd commands(map_.inputs()), values(map_.outputs()), spreads(map_.outputs());
    for (Index i = 0; i < map_.inputs(); ++i) commands[i] = given[map_.data().inputs[i].actuator];
    for (const MapUnknown& unknown : unknowns_) commands[unknown.input] = unknown.mean;
    values.setConstant(std::nan(""));
    spreads.setZero();
    for (Index c = 0; c < std::ssize(read_); ++c) {
      const ReadOutput& read = read_[c];
      values[read.output] = requested_.poses.values(row, c) / read.size;
      spreads[read.output] = deviations_[c] / read.size;
    }
    Estimate reported;
    reported.actuation = given;
    reported.computed = reported.deviations =
        Eigen::VectorXd::Constant(read_.size(), std::numeric_limits<double>::quiet_NaN());
    const std::optional<MapEstimate> found = estimate_by_map(map_, unknowns_, commands, values, spreads);
    if (found)
      fill(*found, reported);
    else
      reported.remark = "these commands, or what was known before, are outside the map";
    reported.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return reported;
  }

 private:
  void fill(const MapEstimate& found, Estimate& reported) const {
    reported.status = found.converged ? Status::converged : Status::not_converged;
    if (!found.converged) reported.remark = "the search ends at an end of the map";
    reported.covariance = reported.near_covariance = found.covariance;
    for (std::size_t i = 0; i < unknowns_.size(); ++i) {
      const double value = found.commands[unknowns_[i].input];
      const estimate::Variable& variable = variables_.all()[i];
      const Index at = i;
      reported.numbers.push_back(
          estimate::reported_number(requested_.model, variable, value, std::sqrt(found.covariance(at, at))));
      reported.actuation[variable.actuator] = value;
    }
    Eigen::VectorXd outputs(map_.outputs());
    maps::RowMatrix slopes(map_.inputs(), map_.outputs());
    (void)map_.evaluate(found.commands.data(), outputs.data(), slopes.data());
    Eigen::VectorXd by(unknowns_.size());
    for (Index c = 0; c < std::ssize(read_); ++c) {
      const ReadOutput& read = read_[c];
      reported.computed[c] = read.size * found.computed[read.output];
      for (Index i = 0; i < by.size(); ++i) by[i] = slopes(unknowns_[i].input, read.output);
      reported.deviations[c] = read.size * std::sqrt(by.dot(found.covariance * by));
    }
    reported.chi_square = found.chi_square;
    reported.freedoms = found.freedoms;
    reported.iterations = found.iterations;
  }

  const KinematicMap& map_;
  const RequestedEstimates& requested_;
  estimate::Variables variables_;
  std::vector<MapUnknown> unknowns_;
  std::vector<ReadOutput> read_;
  Eigen::VectorXd deviations_;
};

}  // namespace

EstimateReport estimate_poses_by_map(const KinematicMap& map, const RequestedEstimates& requested,
                                     const EstimateCallback& row) {
  const MapRows rows(map, requested);
  requested.refuse_commanded(rows.reported_actuators());
  EstimateReport report{requested.model, requested.poses, requested.unknowns, requested.deviations};
  report.groups = reading_groups(requested.model, requested.poses.columns);
  for (std::size_t r = 0; r < requested.poses.commands.size(); ++r) {
    report.reported.push_back(rows.describe(r));
    report.words.push_back(estimate_words(report.reported.back(), report.groups));
    if (row) row(r, report.reported.back());
  }
  return report;
}

}  // namespace softkin::runs
