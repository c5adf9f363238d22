#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/estimate/readings.hpp>
#include <softkin/kinematics/reading_plan.hpp>
#include <softkin/model/names.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin {

PlanBasis::PlanBasis(const Estimate& estimate)
    : positions(estimate.state.positions),
      moves(estimate.moves),
      covariance(estimate.near_covariance),
      numbers(estimate.numbers.size()) {}

namespace {

/// Information below which a reading is useless [bits].
constexpr double min_bits = 1e-6;

/// A further reading that is possible: a marker at a vertex, or columns that belong together.
struct Candidate {
  std::string name;
  Index vertex = -1;
  std::vector<PoseColumn> columns{};
  double deviation = 0;
};

bool is_read(const std::vector<PoseColumn>& read, const PoseColumn& column) {
  return std::any_of(read.begin(), read.end(), [&](const PoseColumn& other) {
    return other.marker == column.marker && other.axis == column.axis && other.actuator == column.actuator &&
           other.kind == column.kind && other.support == column.support && other.sensor == column.sensor;
  });
}

class Candidates {
 public:
  Candidates(const Model& model, const PlanOptions& options) : model_(model), options_(options) {
    const double marker = options.deviations[static_cast<std::size_t>(Reading::coordinate)];
    for (const Index v : options.vertices) {
      if (v < 0 || v >= model.rest.rows())
        throw InvalidInput("a further marker cannot be at vertex " + std::to_string(v) + ": the robot has " +
                           std::to_string(model.rest.rows()));
      if (marker > 0) all_.push_back({"marker", v, {}, marker});
    }
    for (Index m = 0; m < std::ssize(model.markers); ++m) {
      std::vector<PoseColumn> columns;
      for (int axis = 0; axis < 3; ++axis) columns.push_back({"", m, axis});
      add(model.markers[m].name, std::move(columns));
    }
    for (Index s = 0; s < std::ssize(model.sensors); ++s) {
      const Sensor& sensor = *model.sensors[s];
      std::vector<PoseColumn> columns;
      if (sensor.kind == SensorKind::direction)
        for (int axis = 0; axis < 3; ++axis) columns.push_back({"", -1, axis, -1, Reading::direction, -1, s});
      else
        columns = {{"", -1, -1, -1, sensor.kind == SensorKind::length ? Reading::length : Reading::angle, -1, s}};
      add(sensor.name, std::move(columns));
    }
    for (Index a = 0; a < std::ssize(model.actuators); ++a) add_measure(a);
  }
  [[nodiscard]] const std::vector<Candidate>& all() const { return all_; }

 private:
  /// Adds the measure of an actuator, if it depends on the shape alone.
  void add_measure(Index actuator) {
    const Actuator& of = model_.actuators[actuator];
    if (of.control != Control::load) return;
    if (of.is<ChamberDrive>()) add(of.name, {{"", -1, -1, actuator, Reading::volume}});
    if (of.is<CableDrive>()) add(of.name, {{"", -1, -1, actuator, Reading::length}});
  }
  void add(const std::string& name, std::vector<PoseColumn> columns) {
    std::erase_if(columns, [&](const PoseColumn& column) { return is_read(options_.read, column); });
    if (columns.empty()) return;
    const auto kind = static_cast<std::size_t>(columns.front().kind);
    if (!(options_.deviations[kind] > 0)) return;
    const std::string what = columns.front().marker >= 0 ? "marker " + name : name + " (" + reading_names[kind] + ")";
    all_.push_back({what, -1, std::move(columns), options_.deviations[kind]});
  }

  const Model& model_;
  const PlanOptions& options_;
  std::vector<Candidate> all_;
};

/// Of a candidate's coordinates, by the unknowns, over the deviation.
Eigen::MatrixXd slopes_of(const Model& model, const Candidate& candidate, const PlanBasis& at) {
  const Index columns = at.moves.size();
  const bool vertex = candidate.vertex >= 0;
  Eigen::MatrixXd slopes(vertex ? 3 : static_cast<Index>(candidate.columns.size()), columns);
  State state;
  if (!vertex) state.positions = at.positions;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(model.actuators.size());
  const Points nothing;
  for (Index c = 0; c < columns; ++c) {
    const Points& moves = at.moves[c];
    if (vertex) slopes.col(c) = vertex_at(moves, candidate.vertex);
    for (Index r = 0; !vertex && r < slopes.rows(); ++r)
      slopes(r, c) = estimate::reading_change(model, candidate.columns[r], state, {moves, none, nothing});
  }
  return slopes / candidate.deviation;
}

/// I + S P S^T.
Eigen::MatrixXd spread_of(const Eigen::MatrixXd& slopes, const Eigen::MatrixXd& covariance) {
  return Eigen::MatrixXd::Identity(slopes.rows(), slopes.rows()) + slopes * covariance * slopes.transpose();
}

double bits_of(const Eigen::MatrixXd& slopes, const Eigen::MatrixXd& covariance) {
  double bits = 0;
  for (const double value : symmetric_eigen(spread_of(slopes, covariance)).values)
    bits += 0.5 * std::log2(std::max(1.0, value));
  return bits;
}

/// Deviations afterwards, of all estimates.
void set_deviations(const std::vector<Eigen::MatrixXd>& covariances, std::size_t numbers, PlannedReading& planned) {
  const auto count = static_cast<Index>(numbers), places = (static_cast<Index>(covariances[0].rows()) - count) / 2;
  planned.numbers.setZero(count);
  planned.places.setZero(places);
  for (const Eigen::MatrixXd& covariance : covariances) {
    planned.numbers += covariance.diagonal().head(count);
    for (Index f = 0; f < places; ++f) planned.places[f] += covariance.diagonal().segment<2>(count + 2 * f).sum();
  }
  const auto mean_root = [&](Eigen::VectorXd& sum) {
    sum = (sum / static_cast<double>(covariances.size())).cwiseMax(0).cwiseSqrt();
  };
  mean_root(planned.numbers);
  mean_root(planned.places);
}

/// Covariances of all estimates, as readings are added one after the other.
class Plan {
 public:
  Plan(const Model& model, const std::vector<PlanBasis>& estimates, const std::vector<Candidate>& candidates)
      : model_(model), candidates_(candidates), numbers_(estimates.front().numbers) {
    for (const PlanBasis& each : estimates) covariances_.push_back(each.covariance);
    for (const Candidate& candidate : candidates) {
      std::vector<Eigen::MatrixXd>& own = slopes_.emplace_back();
      for (const PlanBasis& each : estimates) own.push_back(slopes_of(model, candidate, each));
    }
    taken_.resize(candidates.size());
  }

  /// Returns nothing where no reading gives information.
  std::optional<PlannedReading> next() {
    std::optional<std::size_t> best;
    double most = min_bits;
    for (std::size_t c = 0; c < slopes_.size(); ++c) {
      if (taken_[c]) continue;
      double bits = 0;
      for (std::size_t e = 0; e < covariances_.size(); ++e) bits += bits_of(slopes_[c][e], covariances_[e]);
      bits /= static_cast<double>(covariances_.size());
      if (!(bits > most)) continue;
      most = bits;
      best = c;
    }
    if (!best) return std::nullopt;
    add(*best);
    PlannedReading planned = described(candidates_[*best]);
    planned.bits = most;
    set_deviations(covariances_, numbers_, planned);
    return planned;
  }

 private:
  void add(std::size_t candidate) {
    taken_[candidate] = true;
    for (std::size_t e = 0; e < covariances_.size(); ++e) {
      const Eigen::MatrixXd& of = slopes_[candidate][e];
      const Eigen::MatrixXd carried = covariances_[e] * of.transpose();
      const CholeskyFactor spread(spread_of(of, covariances_[e]));
      covariances_[e] -= carried * spread.solve(Eigen::MatrixXd(carried.transpose()));
    }
  }
  [[nodiscard]] PlannedReading described(const Candidate& chosen) const {
    PlannedReading planned;
    planned.name = chosen.name;
    planned.vertex = chosen.vertex;
    if (chosen.vertex >= 0)
      planned.at_rest = vertex_at(model_.rest, chosen.vertex);
    else if (const Index marker = chosen.columns.front().marker; marker >= 0)
      planned.at_rest = model_.markers[marker].at(model_.rest);
    return planned;
  }

  const Model& model_;
  const std::vector<Candidate>& candidates_;
  std::size_t numbers_;
  std::vector<Eigen::MatrixXd> covariances_;
  std::vector<std::vector<Eigen::MatrixXd>> slopes_;  // of each candidate, of each estimate
  std::vector<bool> taken_;
};

}  // namespace

std::vector<PlannedReading> plan_readings(const Model& model, const std::vector<PlanBasis>& estimates,
                                          const PlanOptions& options) {
  if (estimates.empty()) throw InvalidInput("there is no estimate to plan from");
  if (options.count < 1) throw InvalidInput("a plan is of 1 reading or more");
  if (std::none_of(options.deviations.begin(), options.deviations.end(), [](double d) { return d > 0; }))
    throw InvalidInput("a plan needs the deviation of what may be read");
  const Candidates candidates(model, options);
  Plan plan(model, estimates, candidates.all());
  std::vector<PlannedReading> planned;
  while (planned.size() < static_cast<std::size_t>(options.count)) {
    std::optional<PlannedReading> next = plan.next();
    if (!next) break;
    planned.push_back(std::move(*next));
  }
  return planned;
}

}  // namespace softkin
