// Compares estimates of a force at an unknown place on a synthetic finger with the drawn truth, tests how wrong
// readings are found, and measures the number of updates per second.

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/estimate/problem.hpp>
#include <softkin/kinematics/estimator.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/map_estimate.hpp>
#include <softkin/model/names.hpp>

#include "command_line.hpp"
#include "machine.hpp"
#include "touched_finger.hpp"

namespace {

using namespace softkin;
using softkin::bench::finger_length;

/// 90 % of a chi-square of 2 and 3 freedoms.
constexpr double ninety_of_2 = 4.6052, ninety_of_3 = 6.2514;
/// Of the largest force along each axis that maps are made for: under the whole one the finger has no equilibrium.
constexpr double map_force_fraction = 0.2;
/// Updates with at least this number of equilibria are printed individually.
constexpr int many_equilibria = 4;

struct Options {
  int draws = 100, swaps = 100, updates = 300, map_draws = 0;
  double noise_mm = 0.2, max_force_N = 2;
  unsigned seed = 1;
  double fade_s = 0;
  int places = 80, starts = 3;
  bool verbose = false, quadratic = false, volume_only = false;
  int threads = 1;
};

std::vector<PoseColumn> columns_of(const Model& model, bool volume_only) {
  if (volume_only) return {{"air_volume_mm3", -1, -1, 0, Reading::volume}};
  std::vector<PoseColumn> columns;
  for (Index m = 0; m < std::ssize(model.markers); ++m)
    for (int axis = 0; axis < 3; ++axis)
      columns.push_back({model.markers[m].name + "_" + "xyz"[axis] + "_mm", m, axis});
  return columns;
}

/// What was drawn, and what the robot does.
struct Truth {
  Actuation commands;
  Vec3 force{0, 0, 0}, place{0, 0, 0};  // at rest
  Points positions;
  Eigen::VectorXd readings;  // without noise
};

class Draws {
 public:
  Draws(const Model& model, const std::vector<PoseColumn>& columns, const Options& options)
      : model_(model),
        options_(options),
        random_(options.seed),
        problem_(model, {{"touch", true}}, columns, statics(options)) {}

  static StaticsOptions statics(const Options& options) {
    StaticsOptions statics;
    statics.threads = options.threads;
    return statics;
  }

  Truth draw() {
    for (;;) {
      Truth truth;
      truth.commands = model_.rest_actuation();
      truth.commands[0] = 20 * uniform_(random_);
      Vec3 direction(normal_(random_), normal_(random_), normal_(random_));
      truth.force = options_.max_force_N * uniform_(random_) * direction.normalized();
      const estimate::Patch& patch = *problem_.variables().forces()[0].patch;
      const estimate::Place place = patch.nearest({finger_length * uniform_(random_), 15 * uniform_(random_), 20});
      truth.place = patch.at(place, model_.rest);
      const estimate::Guess guess = problem_.solve(truth.commands, truth.force, {place}, nullptr, {});
      if (!guess.solved()) {
        ++without_equilibrium_;
        continue;
      }
      truth.positions = guess.equilibrium.state.positions;
      truth.readings = guess.computed;
      return truth;
    }
  }

  Eigen::VectorXd noisy(const Truth& truth, double deviation) {
    Eigen::VectorXd values = truth.readings;
    for (double& value : values) value += deviation * normal_(random_);
    return values;
  }
  std::mt19937& random() { return random_; }
  [[nodiscard]] int without_equilibrium() const { return without_equilibrium_; }

 private:
  const Model& model_;
  const Options& options_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_{0, 1};
  estimate::Problem problem_;
  int without_equilibrium_ = 0;
};

/// Of this thread, whatever else the machine does.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// Off squared over the covariance; of a place in the tangent plane of a flat back: along x and y.
double distance2(const Eigen::VectorXd& off, const Eigen::MatrixXd& covariance) {
  return off.dot(solve_symmetric(covariance, off));
}

/// Errors of some draws, and how often ellipsoids of 90 % hold the truth.
struct Errors {
  std::vector<double> force_N, force_fraction, force_deviation_N, place_mm, place_deviation_mm, shape_mm,
      shape_deviation_mm, predicted_mm, seconds;
  std::mt19937 random{17};
  int draws = 0, converged = 0, force_held = 0, place_held = 0, misfits = 0, left_out = 0;
  double vertices_held = 0;

  void add(const Truth& truth, const Estimate& estimated) {
    ++draws;
    seconds.push_back(estimated.seconds);
    if (estimated.status != Status::converged) return;
    ++converged;
    misfits += estimated.misfit() > 3;
    left_out += !estimated.left_out.empty();
    const Vec3 off(estimated.numbers[0].value - truth.force[0], estimated.numbers[1].value - truth.force[1],
                   estimated.numbers[2].value - truth.force[2]);
    const Mat3 covariance = estimated.covariance.topLeftCorner<3, 3>();
    force_N.push_back(off.norm());
    if (truth.force.norm() > 0.1) force_fraction.push_back(off.norm() / truth.force.norm());
    force_deviation_N.push_back(std::sqrt(covariance.trace()));
    force_held += distance2(off, covariance) < ninety_of_3;
    const Eigen::Vector2d slid = (estimated.places[0].at_rest - truth.place).head<2>();
    const Eigen::Matrix2d place_covariance = estimated.places[0].covariance.topLeftCorner<2, 2>();
    place_mm.push_back(slid.norm());
    place_deviation_mm.push_back(std::sqrt(place_covariance.trace()));
    place_held += distance2(slid, place_covariance) < ninety_of_2;
    add_shape(truth, estimated);
  }

  void add_shape(const Truth& truth, const Estimate& estimated) {
    double worst = 0, deviation = 0, held = 0;
    const Index count = truth.positions.rows();
    for (Index v = 0; v < count; ++v) {
      const Vec3 off = vertex_at(estimated.state.positions, v) - vertex_at(truth.positions, v);
      const Vec3 own = estimated.vertex_deviation(v);
      if (off.norm() >= worst) {
        worst = off.norm();
        deviation = own.norm();
      }
      for (int axis = 0; axis < 3; ++axis) held += std::abs(off[axis]) <= 1.645 * own[axis] + 1e-9;
    }
    shape_mm.push_back(worst);
    shape_deviation_mm.push_back(deviation);
    vertices_held += held / (3.0 * count);
    predicted_mm.push_back(predicted(estimated));
  }

  /// Returns the largest displacement error of a shape that is drawn from the estimated covariance: no estimator can
  /// determine what the readings do not contain.
  double predicted(const Estimate& estimated) {
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd& covariance = estimated.near_covariance;
    const SymmetricEigen eigen = symmetric_eigen(covariance);
    Eigen::VectorXd unknowns = Eigen::VectorXd::Zero(covariance.rows());
    for (Index k = 0; k < std::ssize(unknowns); ++k)
      unknowns += normal(random) * std::sqrt(std::max(0.0, eigen.values[k])) * eigen.vectors.col(k);
    Points moved = Points::Zero(estimated.moves.front().rows(), 3);
    for (std::size_t c = 0; c < estimated.moves.size(); ++c) moved += unknowns[c] * estimated.moves[c];
    return moved.rowwise().norm().maxCoeff();
  }

  /// Coverage counts draws that converged.
  void print(const char* what) const {
    const double n = std::max(1, converged);
    std::printf("%s: %d draws, %d converged, %d whose readings do not fit, %d with a reading left out\n", what, draws,
                converged, misfits, left_out);
    std::printf(
        "  force: median error %.3f N, %.2f %% of it; 90 %% below %.3f N; stated deviation, median %.3f N; "
        "ellipsoids of 90 %% hold %.1f %%\n",
        quantile(force_N, 0.5), 100 * quantile(force_fraction, 0.5), quantile(force_N, 0.9),
        quantile(force_deviation_N, 0.5), 100 * force_held / n);
    std::printf(
        "  place: median error %.2f mm, %.2f %% of the length; 90 %% below %.2f mm; stated deviation, median "
        "%.2f mm; ellipses of 90 %% hold %.1f %%\n",
        quantile(place_mm, 0.5), 100 * quantile(place_mm, 0.5) / finger_length, quantile(place_mm, 0.9),
        quantile(place_deviation_mm, 0.5), 100 * place_held / n);
    std::printf(
        "  shape: largest error anywhere, median %.3f mm, %.2f %% of the length; 90 %% below %.3f mm; stated there, "
        "median %.3f mm; intervals of 90 %% hold %.1f %% of all coordinates; drawn from what is told: median %.3f, "
        "90 %% below %.3f mm\n",
        quantile(shape_mm, 0.5), 100 * quantile(shape_mm, 0.5) / finger_length, quantile(shape_mm, 0.9),
        quantile(shape_deviation_mm, 0.5), 100 * vertices_held / n, quantile(predicted_mm, 0.5),
        quantile(predicted_mm, 0.9));
    std::printf("  seconds: median %.3f, 90 %% below %.3f\n", quantile(seconds, 0.5), quantile(seconds, 0.9));
    std::fflush(stdout);
  }
};

EstimatorOptions estimator_options(const Options& options) {
  EstimatorOptions own;
  own.statics = Draws::statics(options);
  own.fade_s = options.fade_s;
  own.candidates = options.places;
  own.starts = options.starts;
  return own;
}

/// Prints a line with the drawn values and the estimated ones.
void print_each(int draw, const Truth& truth, const std::vector<std::size_t>& wrong, const Estimate& estimated) {
  const auto list = [](const std::vector<std::size_t>& groups) {
    std::string text;
    for (const std::size_t g : groups) text += std::to_string(g + 1);
    return text.empty() ? std::string("none") : text;
  };
  const Vec3 off =
      Vec3(estimated.numbers[0].value, estimated.numbers[1].value, estimated.numbers[2].value) - truth.force;
  std::printf(
      "  %3d: %.2f kPa, (%.3f %.3f %.3f) N at (%.1f %.1f) mm; wrong %s, left out %s; %s, misfit %.1f, told "
      "(%.3f %.3f %.3f) N at (%.1f %.1f) mm, %.3f N off, %d equilibria, %.2f s\n",
      draw, truth.commands[0], truth.force[0], truth.force[1], truth.force[2], truth.place[0], truth.place[1],
      list(wrong).c_str(), list(estimated.left_out).c_str(), softkin::name_of(estimated.status), estimated.misfit(),
      estimated.numbers[0].value, estimated.numbers[1].value, estimated.numbers[2].value,
      estimated.places[0].at_rest[0], estimated.places[0].at_rest[1], off.norm(), estimated.equilibria,
      estimated.seconds);
  std::fflush(stdout);
}

void run_draws(const Model& model, const Options& options) {
  const std::vector<PoseColumn> columns = columns_of(model, options.volume_only);
  const double deviation = options.volume_only ? 5 : options.noise_mm;  // [mm^3] or [mm]
  Draws draws(model, columns, options);
  Estimator estimator(model, {{"touch", true}}, columns, Eigen::VectorXd::Constant(columns.size(), deviation),
                      estimator_options(options));
  Errors errors;
  for (int d = 0; d < options.draws; ++d) {
    const Truth truth = draws.draw();
    estimator.forget();
    const Estimate& estimated = estimator.update(truth.commands, draws.noisy(truth, deviation));
    errors.add(truth, estimated);
    if (options.verbose) print_each(d, truth, {}, estimated);
    if ((d + 1) % 50 == 0 && d + 1 < options.draws) errors.print("so far");
  }
  errors.print(options.volume_only ? "volume at a pressure, no marker" : "four markers");
  std::printf("  forces that were drawn again, as the finger has no equilibrium under them: %d\n",
              draws.without_equilibrium());
}

/// Two markers exchanged, or one that is 30 mm off.
void run_swaps(const Model& model, const Options& options) {
  const std::vector<PoseColumn> columns = columns_of(model, false);
  Draws draws(model, columns, options);
  Estimator estimator(model, {{"touch", true}}, columns, Eigen::VectorXd::Constant(columns.size(), options.noise_mm),
                      estimator_options(options));
  for (const bool swap : {true, false}) {
    int named = 0, exact = 0;
    std::vector<double> force_N, seconds;
    for (int d = 0; d < options.swaps; ++d) {
      const Truth truth = draws.draw();
      Eigen::VectorXd values = draws.noisy(truth, options.noise_mm);
      const auto a = static_cast<std::size_t>(draws.random()() % 4), b = (a + 1 + draws.random()() % 3) % 4;
      std::vector<std::size_t> wrong{a};
      if (swap) {
        const Vec3 first = values.segment<3>(3 * a);
        values.segment<3>(3 * a) = values.segment<3>(3 * b).eval();
        values.segment<3>(3 * b) = first;
        wrong = {std::min(a, b), std::max(a, b)};
      } else {
        Vec3 off(1 - 2.0 * (draws.random()() % 2), 0.3, 0.5);
        values.segment<3>(3 * a) += 30 * off.normalized();
      }
      estimator.forget();
      const Estimate& estimated = estimator.update(truth.commands, values);
      named += std::includes(estimated.left_out.begin(), estimated.left_out.end(), wrong.begin(), wrong.end());
      exact += estimated.left_out == wrong;
      if (options.verbose) print_each(d, truth, wrong, estimated);
      seconds.push_back(estimated.seconds);
      if (estimated.status == Status::converged)
        force_N.push_back(
            (Vec3(estimated.numbers[0].value, estimated.numbers[1].value, estimated.numbers[2].value) - truth.force)
                .norm());
    }
    std::printf("%s: %d of %d named, %d no other beside; force off by %.3f N in the median; %.2f s each\n",
                swap ? "two markers exchanged" : "one marker 30 mm off", named, options.swaps, exact,
                quantile(force_N, 0.5), quantile(seconds, 0.5));
    std::printf("  the longest took %.2f s\n", quantile(seconds, 1));
    std::fflush(stdout);
  }
}

/// Resident memory of this process [MiB].
double memory_MiB() {
  long total = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld %ld", &total, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// A force that wanders over the back while the pressure goes up and down.
void run_updates(const Model& model, const Options& options) {
  const std::vector<PoseColumn> columns = columns_of(model, false);
  Draws draws(model, columns, options);
  const estimate::Problem problem(model, {{"touch", true}}, columns, Draws::statics(options));
  Estimator estimator(model, {{"touch", true}}, columns, Eigen::VectorXd::Constant(columns.size(), options.noise_mm),
                      estimator_options(options));
  std::vector<double> seconds, processor, equilibria, force_N, place_mm;
  estimate::Guess guess;
  int failed = 0;
  Errors errors;
  for (int u = 0; u < options.updates; ++u) {
    if (u % 1000 == 100) {
      std::printf("update %d: %.2f MiB\n", u, memory_MiB());
      std::fflush(stdout);
    }
    const double t = 0.01 * u;  // [s], at 100 a second
    Truth truth;
    truth.commands = model.rest_actuation();
    truth.commands[0] = 10 + 5 * std::sin(t);
    truth.force = Vec3(0.1 * std::sin(2 * t), 0.2 * std::cos(1.5 * t), -0.8 - 0.4 * std::sin(3 * t));
    const estimate::Patch& patch = *problem.variables().forces()[0].patch;
    const estimate::Place place = patch.nearest({65 + 20 * std::sin(0.7 * t), 7.5 + 4 * std::cos(t), 20});
    truth.place = patch.at(place, model.rest);
    guess = problem.solve(truth.commands, truth.force, {place}, u > 0 ? &guess : nullptr, {});
    if (!guess.solved()) guess = problem.solve(truth.commands, truth.force, {place}, nullptr, {});
    truth.readings = guess.computed;
    const Eigen::VectorXd values = draws.noisy(truth, options.noise_mm);
    const double begin = processor_seconds();
    const Estimate& estimated = estimator.update(truth.commands, values, 0.01);
    if (u > 0) processor.push_back(processor_seconds() - begin);
    failed += estimated.status != Status::converged;
    truth.positions = guess.equilibrium.state.positions;
    if (options.verbose && (estimated.equilibria > many_equilibria || estimated.misfit() > 3))
      print_each(u, truth, {}, estimated);
    if (u == 0) continue;
    errors.add(truth, estimated);
    seconds.push_back(estimated.seconds);
    equilibria.push_back(estimated.equilibria);
    force_N.push_back(
        (Vec3(estimated.numbers[0].value, estimated.numbers[1].value, estimated.numbers[2].value) - truth.force)
            .norm());
    place_mm.push_back((estimated.places[0].at_rest - truth.place).norm());
  }
  double total = 0, solves = 0;
  for (const double s : seconds) total += s;
  for (const double e : equilibria) solves += e;
  const auto n = static_cast<double>(seconds.size());
  std::printf(
      "updates: %.1f a second (median %.1f; by processor time of this thread, median %.1f); %.2f equilibria each; %d "
      "not converged; force off by %.3f N, place by "
      "%.2f mm in the median\n",
      n / total, 1 / quantile(seconds, 0.5), 1 / quantile(processor, 0.5), solves / n, failed, quantile(force_N, 0.5),
      quantile(place_mm, 0.5));
  errors.print("in time");
}

/// Estimates a force of unknown size at a known place with a map of the finger, from readings of the solver's
/// equilibria.
void run_map(const Options& options) {
  RobotSpec spec = softkin::bench::touched_finger(options.quadratic);
  const double max_N = map_force_fraction * options.max_force_N;
  spec.actuators[0].low = 0;
  spec.actuators[0].high = 20;
  spec.loads.forces[0].at = {Vec3(80, 7.5, 20), {}};
  spec.loads.forces[0].range = std::array<Vec3, 2>{Vec3::Constant(-max_N), Vec3::Constant(max_N)};
  const Model model = compile(spec);
  MapOptions wanted;
  wanted.accuracy_mm = 0.1 * options.noise_mm;
  wanted.checks = 50;
  const MapResult made = build_map(model, wanted).value();
  const KinematicMap map(made.data);
  std::printf("map: %lld equilibria, markers within %.4f mm at %lld checks\n",
              static_cast<long long>(made.data.equilibria), made.data.check.largest.head(12).maxCoeff(),
              static_cast<long long>(made.data.check.points));
  std::vector<MapUnknown> unknowns;
  for (Index i = 1; i < map.inputs(); ++i) unknowns.push_back({i, 0, max_N / 2});
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  const Statics statics(model);
  std::vector<double> force_N, deviation_N;
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(map.outputs(), options.noise_mm);
  double seconds = 0;
  int held = 0, estimated = 0, calls = 0, outside = 0;
  for (int d = 0; d < options.map_draws; ++d) {
    Actuation commands = model.rest_actuation();
    const Vec3 force = max_N * uniform(random) * Vec3(normal(random), normal(random), normal(random)).normalized();
    commands << 20 * uniform(random), force;
    const Equilibrium truth = statics.solve(commands, statics.rest());
    Eigen::VectorXd values = Eigen::VectorXd::Constant(map.outputs(), std::nan("")), begin = map.commands(commands);
    for (Index m = 0; m < 4; ++m)
      for (int axis = 0; axis < 3; ++axis)
        values[3 * m + axis] = model.markers[m].at(truth.state.positions)[axis] + options.noise_mm * normal(random);
    begin.tail<3>().setZero();
    const auto start = std::chrono::steady_clock::now();
    std::optional<MapEstimate> found;
    for (int repeated = 0; repeated < 100; ++repeated, ++calls)
      found = estimate_by_map(map, unknowns, begin, values, deviations);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!found || !found->converged || truth.report.status != Status::converged) {
      ++outside;
      continue;
    }
    ++estimated;
    const Vec3 off = found->commands.tail<3>() - force;
    force_N.push_back(off.norm());
    deviation_N.push_back(std::sqrt(found->covariance.trace()));
    held += distance2(off, found->covariance) < ninety_of_3;
  }
  std::printf(
      "by a map: %.0f a second; %d of %d told; force off by %.3f N in the median, stated deviation %.3f N; ellipsoids "
      "of 90 %% hold %.1f %%\n",
      calls / seconds, estimated, estimated + outside, quantile(force_N, 0.5), quantile(deviation_N, 0.5),
      100.0 * held / std::max(1, estimated));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace softkin::bench;
  Options options;
  CommandLine app{"What is told of a force of unknown place on a made-up finger"};
  app.add_option("--draws", options.draws, "Forces that are drawn and told");
  app.add_option("--swaps", options.swaps, "Readings with two markers exchanged, and with one 30 mm off");
  app.add_option("--map-draws", options.map_draws, "Forces at a known place that are told by a map");
  app.add_option("--updates", options.updates, "Updates in time");
  app.add_option("--fade", options.fade_s, "Time in which an update forgets the last one [s]; 0: each by itself");
  app.add_option("--noise", options.noise_mm, "Of markers [mm]");
  app.add_option("--force", options.max_force_N, "Largest force [N]");
  app.add_option("--seed", options.seed, "Of what is drawn");
  app.add_option("--threads", options.threads, "Of the solver");
  app.add_option("--places", options.places, "Where a search begins to look");
  app.add_option("--starts", options.starts, "Of these that it follows");
  app.add_flag("--quadratic", options.quadratic, "Elements of order 2");
  app.add_flag("--verbose", options.verbose, "A line for each draw and swap, and for updates that took long");
  app.add_flag("--volume-only", options.volume_only, "Read the chamber's volume at a pressure instead of markers");
  return run_benchmark(app, argc, argv, [&] {
    const Model model = compile(touched_finger(options.quadratic));
    std::printf("%zu tetrahedra of order %d, %lld vertices\n", model.elements.tetrahedra.size(),
                options.quadratic ? 2 : 1, static_cast<long long>(model.rest.rows()));
    if (options.map_draws > 0) run_map(options);
    if (options.draws > 0) run_draws(model, options);
    if (options.updates > 1) run_updates(model, options);
    if (options.swaps > 0) run_swaps(model, options);
    return 0;
  });
}
