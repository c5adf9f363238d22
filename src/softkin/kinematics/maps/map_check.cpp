#include <algorithm>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/maps/map_check.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <softkin/kinematics/sampling.hpp>
#include <softkin/statics/deformation.hpp>
#include <utility>

namespace softkin::maps {

namespace {

struct Compared {
  bool refused = false;  // by the map
  bool solved = false;
  Eigen::VectorXd errors;
  double shape_mm = 0, strain = 0;
};

class Checker {
 public:
  Checker(const Statics& statics, const MapOptions& options, const CheckStart& start, Crew& crew, const MapData& data)
      : model_(statics.model()),
        statics_(statics),
        options_(options),
        start_(start),
        crew_(crew),
        data_(data),
        map_(data) {}

  /// False where it was stopped. key: for the desk
  bool check_at(const Eigen::VectorXd& commands, Index key, Index number, Compared& made) {
    Eigen::VectorXd values(map_.outputs());
    const auto place = map_.evaluate(commands.data(), values.data());
    made.refused = !place;
    const std::optional<Sample> sample =
        crew_.found(key, number, commands, [&] { return solve_robot(commands, place); });
    if (!sample) return false;
    made.solved = sample->is_good();
    if (made.refused || !made.solved) return true;
    made.errors = (values - sample->values).cwiseAbs();
    if (data_.shape) compare_shapes(map_.shape(commands.data(), *place), sample->state.positions, made);
    return true;
  }

 private:
  /// The robot itself.
  std::optional<Sample> solve_robot(const Eigen::VectorXd& commands, const std::optional<KinematicMap::Place>& place) {
    Sample sample;
    sample.commands = commands;
    Actuation actuation = data_.actuation;
    for (Index i = 0; i < commands.size(); ++i) actuation[data_.inputs[i].actuator] = commands[i];
    Equilibrium found = statics_.solve(actuation, place ? start_(*place, commands) : statics_.rest(),
                                       one_of_many(options_.statics), crew_.patience());
    if (found.report.stopped) return std::nullopt;
    if (found.report.status != Status::converged) return sample;
    sample.values = outputs_of(model_, data_, found.state);
    sample.state = std::move(found.state);
    return sample;
  }

  void compare_shapes(const Points& mapped, const Points& solved, Compared& made) const {
    made.shape_mm = largest_move(mapped, solved);
    const StrainHistogram of_map = strain_histogram(model_, deformation_of(model_, mapped)),
                          of_robot = strain_histogram(model_, deformation_of(model_, solved));
    made.strain = std::max(std::abs(of_map.least - of_robot.least), std::abs(of_map.greatest - of_robot.greatest));
  }

  const Model& model_;
  const Statics& statics_;
  const MapOptions& options_;
  const CheckStart& start_;
  Crew& crew_;
  const MapData& data_;
  KinematicMap map_;
};

MapCheck summed_up(const std::vector<Compared>& all, std::size_t outputs) {
  MapCheck made;
  made.largest = made.mean = Eigen::VectorXd::Zero(outputs);
  for (const Compared& each : all) {
    if (each.refused || !each.solved) {
      ++made.outside;
      continue;
    }
    ++made.points;
    made.largest = made.largest.cwiseMax(each.errors);
    made.mean += each.errors;
    made.shape_largest_mm = std::max(made.shape_largest_mm, each.shape_mm);
    made.shape_mean_mm += each.shape_mm;
    made.strain_largest = std::max(made.strain_largest, each.strain);
  }
  if (made.points == 0) return made;
  made.mean /= made.points;
  made.shape_mean_mm /= made.points;
  return made;
}

/// Returns which requested accuracy is not met; empty: all are.
std::string verdict(const MapData& data, const MapOptions& options, const std::vector<Compared>& all) {
  if (data.check.points == 0)
    return "nothing was checked, as none of " + std::to_string(all.size()) +
           " random actuations is inside the map and has an equilibrium";
  for (std::size_t q = 0; q < data.outputs.size(); ++q) {
    const MapOutput& output = data.outputs[q];
    const double largest = data.check.largest[q];
    if (largest > output.accuracy)
      return output.name + " was " + number(largest, 3) + " " + output.unit + " off at a check, " +
             number(output.accuracy, 3) + " was requested";
  }
  if (data.shape && data.check.shape_largest_mm > options.shape_accuracy_mm)
    return "a vertex was " + number(data.check.shape_largest_mm, 3) + " mm off at a check, " +
           number(options.shape_accuracy_mm, 3) + " was requested";
  const auto lost =
      std::count_if(all.begin(), all.end(), [](const Compared& each) { return !each.refused && !each.solved; });
  if (lost > 0) return "at " + std::to_string(lost) + " checks inside the map the robot has no equilibrium";
  return "";
}

}  // namespace

std::optional<std::string> check_map(const Statics& statics, const MapOptions& options, int round,
                                     const CheckStart& start, Crew& crew, MapData& data) {
  const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(round);
  const RowMatrix commands = random_commands(data, options.checks, seed);
  std::vector<Compared> all(options.checks);
  Checker checker(statics, options, start, crew, data);
  const Index key = -1 - round;
  const bool done = crew.each(options.checks, {data.equilibria, 0, 0, "checking"}, &MapProgress::checks,
                              [&](Index i) { return checker.check_at(commands.row(i), key, i, all[i]); });
  if (!done) return std::nullopt;
  data.check = summed_up(all, data.outputs.size());
  data.check.seed = seed;
  return verdict(data, options, all);
}

}  // namespace softkin::maps
