#include <algorithm>
#include <limits>
#include <map>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/maps/map_check.hpp>
#include <softkin/kinematics/maps/piece_fit.hpp>
#include <softkin/kinematics/maps/range_probe.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <utility>

namespace softkin {

namespace {

using maps::PieceFit;
using maps::PieceSolver;
using maps::Sample;

/// Factor on the accuracy for the refinement after a failed check.
constexpr double stricter = 0.3;
constexpr int max_rounds = 4;
/// A map is given up after this number of solves for each input, if at most this fraction of them has an equilibrium
/// and no part of the map is accurate yet.
constexpr Index samples_per_input = 12;
constexpr double min_good_fraction = 0.67;
/// Number of points at which a map is searched for combinations of slack cables.
constexpr Index looks = 4000;

void check_options(const MapOptions& options) {
  if (!(options.accuracy_mm > 0) || !(options.load_accuracy >= 0) || !(options.ratio_accuracy > 0) ||
      !(options.shape_accuracy_mm >= 0) || options.max_equilibria < 1 || options.checks < 1 || options.threads < 1)
    throw InvalidInput("a map's accuracies are positive, its equilibria, checks and threads 1 or more");
}

/// Returns `count` vertices of the robot, each as far as possible from those before.
std::vector<Index> spread_vertices(const Model& model, Index count) {
  std::vector<Index> chosen;
  Eigen::VectorXd away = Eigen::VectorXd::Constant(model.robot_vertices(), std::numeric_limits<double>::infinity());
  for (Index v = 0; v < model.robot_vertices(); ++v)
    if (!model.elements.used[v]) away[v] = -1;
  while (std::ssize(chosen) < count) {
    Index farthest = 0;
    if (!(away.maxCoeff(&farthest) > 0)) break;
    chosen.push_back(farthest);
    for (Index v = 0; v < away.size(); ++v)
      away[v] = std::min(away[v], (model.rest.row(v) - model.rest.row(farthest)).norm());
  }
  return chosen;
}

class Builder {
 public:
  Builder(const Model& model, const MapOptions& options, MapDesk* desk, const MapCallback& progress)
      : model_(model),
        options_(options),
        crew_(options.threads, desk, progress),
        statics_(model),
        probe_(statics_, result_.data, options, crew_) {
    result_.data = maps::outline_of(model);
    wanted_.accuracy.resize(data().outputs.size());
    wanted_.probes = spread_vertices(model, 24);
    wanted_.most = options.max_equilibria;
  }

  bool build() {
    for (int round = 0; round < max_rounds; ++round) {
      if (!refine() || !fit_shape() || !check(round)) return false;
      if (result_.accurate || gave_up_) break;
      strictness_ *= stricter;
    }
    return true;
  }

  MapResult result() { return std::move(result_); }

 private:
  struct Piece {
    std::unique_ptr<PieceSolver> solver;
    std::unique_ptr<PieceFit> fit;
    MapPiece made;
  };

  MapData& data() { return result_.data; }

  [[nodiscard]] std::string doing(const MapPiece& piece) const {
    std::string slack;
    for (std::size_t c = 0; c < piece.taut.size(); ++c)
      if (!piece.taut[c]) slack += (slack.empty() ? "" : ", ") + model_.actuators[result_.data.cables[c].actuator].name;
    return slack.empty() ? (piece.taut.empty() ? "sampling" : "all cables taut") : slack + " slack";
  }

  /// Refines all pieces that the commands need, each to the requested accuracy.
  bool refine() {
    for (auto& piece : pieces_) earlier_[piece->made.taut] = piece->fit->take_samples();
    pieces_.clear();
    equilibria_ = 0;
    std::vector<bool> taut(data().cables.size(), true);
    for (std::optional<std::vector<bool>> next = taut; next; next = missing()) {
      if (!add_piece(*next)) return false;
    }
    return true;
  }

  bool add_piece(const std::vector<bool>& taut) {
    Piece& piece = *pieces_.emplace_back(std::make_unique<Piece>());
    piece.made.taut = taut;
    std::vector<bool> slack(data().inputs.size(), false);
    for (std::size_t c = 0; c < taut.size(); ++c)
      if (!taut[c] && data().cables[c].input >= 0) slack[data().cables[c].input] = true;
    for (std::size_t i = 0; i < slack.size(); ++i)
      if (!slack[i]) piece.made.inputs.push_back(i);
    piece.solver = std::make_unique<PieceSolver>(model_, data(), piece.made);
    piece.fit = std::make_unique<PieceFit>(data(), wanted_, piece.made);
    for (;;) {
      const maps::RowMatrix commands = piece.fit->next();
      if (commands.rows() == 0) break;
      std::vector<Sample> found;
      if (!solve(piece, commands, found)) return false;
      const bool good = std::all_of(found.begin(), found.end(), [](const Sample& sample) { return sample.is_good(); });
      if (!good && !check_ranges(found.front())) return false;
      if (wanted_of_ != strictness_) want(piece, found.front());
      piece.fit->take(std::move(found));
      if (!good && piece.made.cells.empty() && !check_samples(piece.made, *piece.fit)) return false;
    }
    gave_up_ = gave_up_ || piece.fit->gave_up();
    data().shape.reset();
    data().pieces.clear();
    for (const auto& each : pieces_) data().pieces.push_back(each->made);
    data().equilibria = equilibria_;
    return true;
  }

  /// After an equilibrium was not found for the first time: have the inputs ranges that can be mapped?
  ///
  /// first   the first one of the batch, which is in the middle of all ranges if it is the first of all
  /// throws  InvalidInput naming the inputs whose ranges are too large
  /// returns false where it was stopped
  bool check_ranges(const Sample& first) {
    if (probe_.inputs().empty()) {
      if (!probe_.probe_inputs()) return false;
      if (const std::string wrong = probe_.wrong_inputs(); !wrong.empty()) throw InvalidInput(wrong);
    }
    if (wanted_of_ == strictness_ || first.is_good()) return true;
    if (!probe_.probe_corners()) return false;
    throw InvalidInput("the robot has no equilibrium in the middle of its ranges, so that nothing can be mapped" +
                       after(probe_.wrong_corner()));
  }

  /// Checks the samples found so far likewise.
  bool check_samples(const MapPiece& piece, const PieceFit& fit) {
    const std::vector<Sample>& samples = fit.samples();
    const auto good =
        std::count_if(samples.begin(), samples.end(), [](const Sample& sample) { return sample.is_good(); });
    const Index enough = samples_per_input * std::ssize(data().inputs);
    const double fraction = static_cast<double>(good) / static_cast<double>(samples.size());
    if (std::ssize(samples) < enough || fraction > min_good_fraction) return true;
    if (!probe_.probe_corners()) return false;
    const std::string corner = probe_.wrong_corner();
    throw InvalidInput("of " + std::to_string(samples.size()) + " equilibria that were sought in the ranges only " +
                       std::to_string(good) + " exist" +
                       after(corner.empty() ? probe_.suspected_input(piece, samples) : corner));
  }

  static std::string after(const std::string& why) { return why.empty() ? "" : ": " + why; }

  /// Sets the accuracies; those of loads follow from the first equilibrium where none is given.
  void want(const Piece& piece, const Sample& first) {
    if (!first.is_good())
      throw InvalidInput("the robot has no equilibrium in the middle of its ranges, so that nothing can be mapped");
    constexpr double usual = 1e-3;  // of the largest load
    double largest = 0;
    for (std::size_t q = 0; q < data().outputs.size(); ++q) {
      if (data().outputs[q].unit != "kPa" && data().outputs[q].unit != "N") continue;
      double load = std::abs(first.values[q]);
      for (std::size_t j = 0; j < piece.made.inputs.size(); ++j) {
        const MapInput& input = data().inputs[piece.made.inputs[j]];
        load += 0.5 * (input.high - input.low) * std::abs(first.slopes(j, q));
      }
      largest = std::max(largest, load);
    }
    const double loads = options_.load_accuracy > 0 ? options_.load_accuracy : usual * largest;
    for (std::size_t q = 0; q < data().outputs.size(); ++q) {
      MapOutput& output = data().outputs[q];
      output.accuracy = output.unit == "mm"   ? options_.accuracy_mm
                        : output.unit.empty() ? options_.ratio_accuracy
                                              : loads;
      wanted_.accuracy[q] = strictness_ * output.accuracy;
    }
    wanted_.shape_mm = strictness_ * options_.shape_accuracy_mm;
    wanted_of_ = strictness_;
  }

  /// That of the round before, which began alike.
  [[nodiscard]] std::optional<Sample> from_earlier(const std::vector<bool>& taut, Index number,
                                                   const Eigen::VectorXd& commands) const {
    const auto found = earlier_.find(taut);
    if (found == earlier_.end() || number >= std::ssize(found->second)) return std::nullopt;
    const Sample& sample = found->second[number];
    return sample.commands == commands ? std::optional(sample) : std::nullopt;
  }

  /// Every equilibrium is a function of those before this call, its commands and nothing else.
  bool solve(Piece& piece, const maps::RowMatrix& commands, std::vector<Sample>& found) {
    const Index key = maps::bits_of(piece.made.taut);
    const Index before = piece.fit->samples().size();
    found.resize(commands.rows());
    const auto solve_one = [&](Index i) {
      const Eigen::VectorXd at = commands.row(i);
      std::optional<Sample> sample = from_earlier(piece.made.taut, before + i, at);
      if (!sample)
        sample = crew_.found(key, before + i, at, [&] {
          return piece.solver->solve(at, piece.fit->nearest(at), options_.statics, crew_.patience());
        });
      if (!sample) return false;
      found[i] = std::move(*sample);
      return true;
    };
    const MapProgress from{equilibria_, 0, piece.fit->error(), doing(piece.made)};
    const bool done = crew_.each(commands.rows(), from, &MapProgress::equilibria, solve_one);
    equilibria_ = crew_.reported().equilibria;
    return done;
  }

  /// Returns a set of taut cables that some commands need and that has no piece yet.
  std::optional<std::vector<bool>> missing() {
    if (data().cables.empty()) return std::nullopt;
    const KinematicMap map(data());
    const auto samples = maps::random_commands(data(), looks, 0);
    Eigen::VectorXd values(map.outputs());
    for (Index i = 0; i < samples.rows(); ++i)
      if (auto requested = map.missing_piece(samples.row(i).data(), values.data())) return requested;
    return std::nullopt;
  }

  bool fit_shape() {
    if (options_.shape_accuracy_mm == 0) return true;
    std::vector<const Sample*> samples;
    for (const auto& piece : pieces_)
      for (const Sample& sample : piece->fit->samples())
        if (sample.is_good()) samples.push_back(&sample);
    data().shape = maps::shape_modes(samples, 0.3 * options_.shape_accuracy_mm);
    data().shape->accuracy_mm = options_.shape_accuracy_mm;
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      pieces_[p]->fit->fit_modes(*data().shape);
      data().pieces[p] = pieces_[p]->made;
    }
    return true;
  }

  bool check(int round) {
    const auto start = [this](const KinematicMap::Place& place, const Eigen::VectorXd& commands) {
      return start_of(place, commands);
    };
    std::optional<std::string> remark = maps::check_map(statics_, options_, round, start, crew_, data());
    if (!remark) return false;
    result_.accurate = remark->empty();
    result_.remark = std::move(*remark);
    if (!result_.accurate && gave_up_)
      result_.remark += "; it ended after " + std::to_string(data().equilibria) + " equilibria";
    return true;
  }

  /// The nearest equilibrium of the piece that the commands lead to.
  [[nodiscard]] State start_of(const KinematicMap::Place& place, const Eigen::VectorXd& commands) const {
    const Piece& piece = *pieces_[place.piece];
    Eigen::VectorXd own(piece.made.inputs.size());
    for (Index j = 0; j < own.size(); ++j) own[j] = commands[piece.made.inputs[j]];
    const Sample* nearest = piece.fit->nearest(own);
    return nearest ? of_robot(nearest->state, piece.made.taut) : statics_.rest();
  }

  /// The state of a piece as one of the robot, whose slack cables are commanded as long as their paths; at rest where
  /// it is none.
  [[nodiscard]] State of_robot(State state, const std::vector<bool>& taut) const {
    for (std::size_t c = 0; c < taut.size(); ++c) {
      const Index a = result_.data.cables[c].actuator;
      const Actuator& cable = model_.actuators[a];
      if (!taut[c]) state.actuation[a] = achieved_ratio(model_, cable, state.positions);
      const bool is_one =
          state.multipliers[a] >= 0 && state.actuation[a] >= cable.low && state.actuation[a] <= cable.high;
      if (!is_one) return statics_.rest();
    }
    return state;
  }

  const Model& model_;
  const MapOptions& options_;
  maps::Crew crew_;
  Statics statics_;
  maps::RangeProbe probe_;
  maps::Wanted wanted_;
  double strictness_ = 1, wanted_of_ = 0;
  std::vector<std::unique_ptr<Piece>> pieces_;
  std::map<std::vector<bool>, std::vector<Sample>> earlier_;  // of the round before, by the taut cables
  MapResult result_;
  Index equilibria_ = 0;
  bool gave_up_ = false;
};

}  // namespace

std::optional<MapResult> build_map(const Model& model, const MapOptions& options, MapDesk* desk,
                                   const MapCallback& progress) {
  check_options(options);
  Builder builder(model, options, desk, progress);
  if (!builder.build()) return std::nullopt;
  return builder.result();
}

}  // namespace softkin
