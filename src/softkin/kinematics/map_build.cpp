#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <softkin/core/error.hpp>
#include <softkin/core/team.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/maps/piece_fit.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <softkin/statics/deformation.hpp>
#include <thread>
#include <utility>

namespace softkin {

namespace {

using maps::PieceFit;
using maps::PieceSolver;
using maps::Sample;

/// Of what was wanted, where a check was not met.
constexpr double stricter = 0.3;
constexpr int most_rounds = 4;
/// Points at which a map is asked which cables hang slack.
constexpr Index looks = 4000;

void check_options(const MapOptions& options) {
  if (!(options.accuracy_mm > 0) || !(options.load_accuracy >= 0) || !(options.ratio_accuracy > 0) ||
      !(options.shape_accuracy_mm >= 0) || options.most_equilibria < 1 || options.checks < 1 || options.threads < 1)
    throw InvalidInput("a map's accuracies are positive, its equilibria, checks and threads 1 or more");
}

/// So many vertices of the robot, each as far as can be from those before.
std::vector<Index> spread_vertices(const Model& model, Index count) {
  std::vector<Index> chosen;
  Eigen::VectorXd away = Eigen::VectorXd::Constant(model.robot_vertices(), std::numeric_limits<double>::infinity());
  for (Index v = 0; v < model.robot_vertices(); ++v)
    if (!model.used[static_cast<std::size_t>(v)]) away[v] = -1;
  while (static_cast<Index>(chosen.size()) < count) {
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
      : model_(model), options_(options), desk_(desk), progress_(progress), statics_(model) {
    result_.data = maps::outline_of(model);
    wanted_.accuracy.resize(static_cast<Index>(data().outputs.size()));
    wanted_.probes = spread_vertices(model, 24);
    wanted_.most = options.most_equilibria;
  }

  bool build() {
    for (int round = 0; round < most_rounds; ++round) {
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
      if (!piece.taut[c])
        slack += (slack.empty() ? "" : ", ") +
                 model_.actuators[static_cast<std::size_t>(result_.data.cables[c].actuator)].name;
    return slack.empty() ? (piece.taut.empty() ? "sampling" : "all cables taut") : slack + " slack";
  }

  /// All pieces that commands ask for, each as accurate as is wanted.
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
      if (!taut[c] && data().cables[c].input >= 0) slack[static_cast<std::size_t>(data().cables[c].input)] = true;
    for (std::size_t i = 0; i < slack.size(); ++i)
      if (!slack[i]) piece.made.inputs.push_back(static_cast<Index>(i));
    piece.solver = std::make_unique<PieceSolver>(model_, data(), piece.made);
    piece.fit = std::make_unique<PieceFit>(data(), wanted_, piece.made);
    for (;;) {
      const maps::RowMatrix commands = piece.fit->next();
      if (commands.rows() == 0) break;
      std::vector<Sample> found;
      if (!solve(piece, commands, found)) return false;
      if (wanted_of_ != strictness_) want(piece, found.front());
      piece.fit->take(std::move(found));
    }
    gave_up_ = gave_up_ || piece.fit->gave_up();
    data().shape.reset();
    data().pieces.clear();
    for (const auto& each : pieces_) data().pieces.push_back(each->made);
    data().equilibria = equilibria_;
    return true;
  }

  /// Accuracies, of which those of loads are chosen by what the first equilibrium tells.
  void want(const Piece& piece, const Sample& first) {
    if (!first.is_good())
      throw InvalidInput("the robot has no equilibrium in the middle of its ranges, so that nothing can be mapped");
    constexpr double usual = 1e-3;  // of the largest load
    double largest = 0;
    for (std::size_t q = 0; q < data().outputs.size(); ++q) {
      if (data().outputs[q].unit != "kPa" && data().outputs[q].unit != "N") continue;
      double load = std::abs(first.values[static_cast<Index>(q)]);
      for (std::size_t j = 0; j < piece.made.inputs.size(); ++j) {
        const MapInput& input = data().inputs[static_cast<std::size_t>(piece.made.inputs[j])];
        load += 0.5 * (input.high - input.low) * std::abs(first.slopes(static_cast<Index>(j), static_cast<Index>(q)));
      }
      largest = std::max(largest, load);
    }
    const double loads = options_.load_accuracy > 0 ? options_.load_accuracy : usual * largest;
    for (std::size_t q = 0; q < data().outputs.size(); ++q) {
      MapOutput& output = data().outputs[q];
      output.accuracy = output.unit == "mm"   ? options_.accuracy_mm
                        : output.unit.empty() ? options_.ratio_accuracy
                                              : loads;
      wanted_.accuracy[static_cast<Index>(q)] = strictness_ * output.accuracy;
    }
    wanted_.shape_mm = strictness_ * options_.shape_accuracy_mm;
    wanted_of_ = strictness_;
  }

  /// Runs work(i) for every i, on several threads. False where it was stopped.
  bool together(Index count, const std::function<bool(Index)>& work) {
    std::atomic<Index> next = 0;
    std::exception_ptr failure;
    stopped_ = false;
    const auto run = [&] {
      try {
        for (Index i = next++; i < count && !stopped_; i = next++)
          if (!work(i)) stopped_ = true;
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!failure) failure = std::current_exception();
        stopped_ = true;
      }
    };
    std::vector<std::thread> others =
        start_threads(std::min<int>(options_.threads, count) - 1, run, [&] { stopped_ = true; });
    run();
    for (std::thread& other : others) other.join();
    if (failure) std::rethrow_exception(failure);
    return !stopped_;
  }

  [[nodiscard]] ProgressCallback patient() {
    return [this](const Progress&) {
      if (stopped_) return false;
      const std::lock_guard lock(mutex_);
      return !progress_ || progress_(told_);
    };
  }

  /// That of the round before, which began alike.
  [[nodiscard]] std::optional<Sample> from_earlier(const std::vector<bool>& taut, Index number,
                                                   const Eigen::VectorXd& commands) const {
    const auto found = earlier_.find(taut);
    if (found == earlier_.end() || number >= static_cast<Index>(found->second.size())) return std::nullopt;
    const Sample& sample = found->second[static_cast<std::size_t>(number)];
    return sample.commands == commands ? std::optional(sample) : std::nullopt;
  }

  /// What the desk has of it.
  [[nodiscard]] std::optional<Sample> known(Index key, Index number, const Eigen::VectorXd& commands) {
    if (!desk_) return std::nullopt;
    const std::lock_guard lock(mutex_);
    return desk_->known(key, number, commands);
  }

  /// Every equilibrium is a function of those before this call, its commands and nothing else.
  bool solve(Piece& piece, const maps::RowMatrix& commands, std::vector<Sample>& found) {
    const Index key = maps::bits_of(piece.made.taut);
    const auto before = static_cast<Index>(piece.fit->samples().size());
    found.resize(static_cast<std::size_t>(commands.rows()));
    told_ = {equilibria_, 0, piece.fit->error(), doing(piece.made)};
    const bool done = together(static_cast<Index>(commands.rows()), [&](Index i) {
      const Eigen::VectorXd at = commands.row(i);
      std::optional<Sample> sample = from_earlier(piece.made.taut, before + i, at);
      if (!sample) sample = known(key, before + i, at);
      const bool is_known = sample.has_value();
      if (!is_known) sample = piece.solver->solve(at, piece.fit->nearest(at), options_.statics, patient());
      if (!sample) return false;
      const std::lock_guard lock(mutex_);
      if (!is_known && desk_) desk_->keep(key, before + i, *sample);
      found[static_cast<std::size_t>(i)] = std::move(*sample);
      ++told_.equilibria;
      return !progress_ || progress_(told_);
    });
    equilibria_ = told_.equilibria;
    return done;
  }

  /// A set of taut cables that some commands ask for and that is no piece yet.
  std::optional<std::vector<bool>> missing() {
    if (data().cables.empty()) return std::nullopt;
    const KinematicMap map(data());
    const auto samples = maps::random_commands(data(), looks, 0);
    Eigen::VectorXd values(map.outputs());
    for (Index i = 0; i < samples.rows(); ++i)
      if (auto asked = map.missing_piece(samples.row(i).data(), values.data())) return asked;
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

  struct Check {
    bool refused = false;  // by the map
    bool solved = false;
    Eigen::VectorXd errors;
    double shape_mm = 0, strain = 0;
  };

  bool check(int round) {
    const KinematicMap map(data());
    const std::uint64_t seed = options_.seed + static_cast<std::uint64_t>(round);
    const maps::RowMatrix commands = maps::random_commands(data(), options_.checks, seed);
    std::vector<Check> checks(static_cast<std::size_t>(options_.checks));
    told_ = {equilibria_, 0, 0, "checking"};
    const bool done = together(options_.checks, [&](Index i) {
      if (!check_at(map, commands.row(i), round, i, checks[static_cast<std::size_t>(i)])) return false;
      const std::lock_guard lock(mutex_);
      ++told_.checks;
      return !progress_ || progress_(told_);
    });
    if (done) judge(seed, checks);
    return done;
  }

  bool check_at(const KinematicMap& map, const Eigen::VectorXd& commands, int round, Index number, Check& check) {
    Eigen::VectorXd values(map.outputs());
    const auto place = map.evaluate(commands.data(), values.data());
    check.refused = !place;
    const Index key = -1 - round;
    std::optional<Sample> sample = known(key, number, commands);
    if (!sample) {
      sample = solve_robot(commands, place);
      if (!sample) return false;
      const std::lock_guard lock(mutex_);
      if (desk_) desk_->keep(key, number, *sample);
    }
    check.solved = sample->is_good();
    if (check.refused || !check.solved) return true;
    check.errors = (values - sample->values).cwiseAbs();
    if (data().shape) compare_shapes(map.shape(commands.data(), *place), sample->state.positions, check);
    return true;
  }

  void compare_shapes(const Points& mapped, const Points& solved, Check& check) const {
    check.shape_mm = largest_move(mapped, solved);
    const StrainHistogram of_map = strain_histogram(model_, deformation_of(model_, mapped)),
                          of_robot = strain_histogram(model_, deformation_of(model_, solved));
    check.strain = std::max(std::abs(of_map.least - of_robot.least), std::abs(of_map.greatest - of_robot.greatest));
  }

  /// The robot itself, from the nearest equilibrium of the piece that it is one of.
  std::optional<Sample> solve_robot(const Eigen::VectorXd& commands, const std::optional<KinematicMap::Place>& place) {
    StaticsOptions options = options_.statics;
    options.threads = 1;
    options.reuse_factor = false;
    options.keep_history = false;
    Sample sample;
    sample.commands = commands;
    Actuation actuation = data().actuation;
    for (Index i = 0; i < commands.size(); ++i)
      actuation[data().inputs[static_cast<std::size_t>(i)].actuator] = commands[i];
    State start = statics_.rest();
    if (place) {
      const Piece& piece = *pieces_[static_cast<std::size_t>(place->piece)];
      Eigen::VectorXd own(static_cast<Index>(piece.made.inputs.size()));
      for (Index j = 0; j < own.size(); ++j) own[j] = commands[piece.made.inputs[static_cast<std::size_t>(j)]];
      if (const Sample* nearest = piece.fit->nearest(own)) start = of_robot(nearest->state, piece.made.taut);
    }
    Equilibrium found = statics_.solve(actuation, start, options, patient());
    if (found.report.status == Status::interrupted) return std::nullopt;
    if (found.report.status != Status::converged) return sample;
    sample.values = maps::outputs_of(model_, data(), found.state);
    sample.state = std::move(found.state);
    return sample;
  }

  /// The state of a piece as one of the robot, whose slack cables are commanded as long as their paths; at rest where
  /// it is none.
  [[nodiscard]] State of_robot(State state, const std::vector<bool>& taut) const {
    for (std::size_t c = 0; c < taut.size(); ++c) {
      const Index a = result_.data.cables[c].actuator;
      const Actuator& cable = model_.actuators[static_cast<std::size_t>(a)];
      if (!taut[c]) state.actuation[a] = achieved_ratio(model_, cable, state.positions);
      const bool is_one =
          state.multipliers[a] >= 0 && state.actuation[a] >= cable.low && state.actuation[a] <= cable.high;
      if (!is_one) return statics_.rest();
    }
    return state;
  }

  void judge(std::uint64_t seed, const std::vector<Check>& checks) {
    MapCheck& made = data().check;
    made = {};
    made.seed = seed;
    made.largest = made.mean = Eigen::VectorXd::Zero(static_cast<Index>(data().outputs.size()));
    Index lost = 0;
    for (const Check& each : checks) {
      if (each.refused || !each.solved) {
        ++made.outside;
        if (!each.refused) ++lost;
        continue;
      }
      ++made.points;
      made.largest = made.largest.cwiseMax(each.errors);
      made.mean += each.errors;
      made.shape_largest_mm = std::max(made.shape_largest_mm, each.shape_mm);
      made.shape_mean_mm += each.shape_mm;
      made.strain_largest = std::max(made.strain_largest, each.strain);
    }
    if (made.points > 0) {
      made.mean /= made.points;
      made.shape_mean_mm /= made.points;
    }
    result_.remark.clear();
    for (std::size_t q = 0; q < data().outputs.size(); ++q) {
      const MapOutput& output = data().outputs[q];
      if (made.largest[static_cast<Index>(q)] <= output.accuracy) continue;
      if (result_.remark.empty())
        result_.remark = output.name + " was " + number(made.largest[static_cast<Index>(q)], 3) + " " + output.unit +
                         " off at a check, " + number(output.accuracy, 3) + " was asked for";
    }
    if (result_.remark.empty() && data().shape && made.shape_largest_mm > options_.shape_accuracy_mm)
      result_.remark = "a vertex was " + number(made.shape_largest_mm, 3) + " mm off at a check, " +
                       number(options_.shape_accuracy_mm, 3) + " was asked for";
    if (result_.remark.empty() && lost > 0)
      result_.remark = "at " + std::to_string(lost) + " checks inside the map the robot has no equilibrium";
    if (result_.remark.empty() && made.points == 0) result_.remark = "no check was inside the map";
    result_.accurate = result_.remark.empty();
    if (!result_.accurate && gave_up_)
      result_.remark += "; it ended after " + std::to_string(data().equilibria) + " equilibria";
  }

  const Model& model_;
  const MapOptions& options_;
  MapDesk* desk_;
  const MapCallback& progress_;
  Statics statics_;
  maps::Wanted wanted_;
  double strictness_ = 1, wanted_of_ = 0;
  std::vector<std::unique_ptr<Piece>> pieces_;
  std::map<std::vector<bool>, std::vector<Sample>> earlier_;  // of the round before, by what is taut
  MapResult result_;
  MapProgress told_;
  Index equilibria_ = 0;
  bool gave_up_ = false;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;
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
