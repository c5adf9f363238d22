// Inverse kinematics: how many random targets are reached how well at what cost, what becomes of those that cannot be
// reached, how many updates per second follow a moving target, and how well forces are met while the marker stays.

#include <cmath>
#include <ctime>
#include <numbers>
#include <random>
#include <softkin/io/scene/scene.hpp>
#include <softkin/kinematics/inverse.hpp>

#include "command_line.hpp"
#include "machine.hpp"
#include "model/block_mesh.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

struct Options {
  std::string robot = "examples/three_chamber_actuator/three_chamber_actuator.yaml", mode = "reach";
  std::string method = "newton", press;
  int targets = 100, unreachable = 20, threads = 0, order = 0, updates = 300, other_starts = 3;
  unsigned seed = 1;
  double tolerance_mm = 1e-3, size = 2000, millimetres_per_update = 0.5;
  bool touching = false;
};

/// Returns a beam of 64 x 20 x 20 mm with three chambers around its axis, of about `size` tetrahedra.
RobotSpec beam(double size) {
  const int across = 5 * std::max(1, static_cast<int>(std::lround(std::cbrt(size / 2000))));
  const int along = std::max(8, static_cast<int>(std::lround(size / (0.91 * 6 * across * across))));
  Mesh mesh = testing::block_mesh({along, across, across}, {64, 20, 20});
  const double places[3][2] = {{4, 4}, {12, 4}, {8, 12}};
  for (int i = 0; i < 3; ++i)
    testing::add_volume_region(mesh, "chamber" + std::to_string(i + 1), [&](const Vec3& p) {
      return p.x() > 8 && p.x() < 56 && p.y() > places[i][0] && p.y() < places[i][0] + 4 && p.z() > places[i][1] &&
             p.z() < places[i][1] + 4;
    });
  RobotSpec spec = testing::block_robot(std::move(mesh));
  spec.formulation = Formulation::physical;
  spec.materials[0].elastic.emplace().youngs_modulus = 1;
  spec.materials[0].elastic->poisson_ratio = 0.4;
  spec.materials[0].shape_ratio.reset();
  for (int i = 0; i < 3; ++i) {
    ActuatorSpec air;
    air.name = "chamber" + std::to_string(i + 1);
    air.drive = PneumaticSpec{.region = air.name};
    air.low = 1;
    air.high = 2;
    spec.actuators.push_back(air);
  }
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

RobotSpec robot_of(const Options& options) {
  if (options.robot == "beam") return beam(options.size);
  RobotSpec spec = read_scene(options.robot);
  return spec;
}

struct Answer {
  InverseResult result;
  double processor = 0;  // time of all threads [s]
};

struct Tally {
  int count = 0, reached = 0, flagged = 0, lost = 0, max_equilibria = 0;
  double worst_mm = 0, equilibria = 0, iterations = 0, seconds = 0, processor = 0, slope = 0;
  bool inside = true;

  void add(const Model& model, const Answer& answer) {
    const InverseResult& result = answer.result;
    processor += answer.processor;
    ++count;
    const double error = result.errors_mm.maxCoeff();
    reached += result.status == InverseStatus::reached ? 1 : 0;
    flagged += result.status == InverseStatus::unreachable ? 1 : 0;
    lost += result.status == InverseStatus::not_converged ? 1 : 0;
    if (result.status == InverseStatus::reached) worst_mm = std::max(worst_mm, error);
    slope = std::max(slope, result.slope);
    equilibria += result.equilibria;
    max_equilibria = std::max(max_equilibria, result.equilibria);
    iterations += result.iterations;
    seconds += result.seconds;
    for (const InverseTrial& record : result.history)
      for (std::size_t a = 0; a < model.actuators.size(); ++a)
        inside =
            inside && record.actuation[a] >= model.actuators[a].low && record.actuation[a] <= model.actuators[a].high;
  }
};

Vec3 tip_of(const Model& model, const State& state) {
  return model.markers[0].point.at(state.positions);
}

constexpr double min_force_N = 0.05;  // of a pose that presses

class Bench {
 public:
  explicit Bench(const Options& options)
      : options_(options), model_(compile(robot_of(options))), statics_(model_), engine_(options.seed) {
    inverse_.statics.threads = options.threads;
    inverse_.statics.keep_history = false;
    inverse_.tolerance_mm = options.tolerance_mm;
    inverse_.other_starts = options.other_starts;
    if (options.method == "gradient") inverse_.method = InverseMethod::gradient;
    std::printf("%s: %zu tetrahedra of order %d, %zu actuators, marker '%s'; seed %u\n", options.robot.c_str(),
                model_.elements.tetrahedra.size(), model_.elements.edge_nodes.empty() ? 1 : 2, model_.actuators.size(),
                model_.markers.at(0).name.c_str(), options.seed);
    std::fflush(stdout);
  }

  int reach() {
    rest_ = statics_.solve(model_.rest_actuation(), statics_.rest(), inverse_.statics).state;
    Tally near, far;
    double reach_mm = 0;
    const int tries = (options_.touching ? 20 : 1) * options_.targets;
    for (int i = 0; i < tries && near.count < options_.targets; ++i) {
      const Equilibrium made = statics_.solve(random_actuation(), rest_, inverse_.statics);
      if (made.report.status != Status::converged || (options_.touching && !touches(made.state))) continue;
      reach_mm = std::max(reach_mm, (tip_of(model_, made.state) - tip_of(model_, rest_)).norm());
      const Answer answer = solve(tip_of(model_, made.state), rest_);
      near.add(model_, answer);
    }
    print("reachable", near);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < options_.unreachable; ++i) {
      Vec3 direction(any(engine_), any(engine_), any(engine_));
      // twice as far from the tip at rest as any point that was reached
      const Answer answer = solve(tip_of(model_, rest_) + 2 * reach_mm * direction.normalized(), rest_);
      far.add(model_, answer);
    }
    print("out of reach", far);
    return 0;
  }

  /// Solves inverse kinematics for random poses that press on an obstacle. The goals are the largest component of the
  /// force and the marker's coordinates along the other two axes. Forward kinematics from rest checks the answers.
  int press() {
    const ForceGoal on = force_on(model_, options_.press);
    rest_ = statics_.solve(model_.rest_actuation(), statics_.rest(), inverse_.statics).state;
    Tally tally;
    int met = 0;
    double worst_fraction = 0, worst_mm = 0, min_N = HUGE_VAL, max_N = 0;
    for (int i = 0; i < 20 * options_.targets && tally.count < options_.targets; ++i) {
      const Equilibrium made = statics_.solve(random_actuation(), rest_, inverse_.statics);
      const Vec3 force = made.report.status == Status::converged ? exerted(on, made.state) : Vec3::Zero();
      if (!(force.norm() > min_force_N)) continue;
      const std::vector<Goal> goals = pressing_goals(on, force, tip_of(model_, made.state));
      const Answer answer = solve(goals, rest_);
      tally.add(model_, answer);
      const Equilibrium again = statics_.solve(answer.result.equilibrium.actuation, rest_, inverse_.statics);
      const auto& requested = std::get<ForceGoal>(goals[0].what);
      Vec3 missed = exerted(on, again.state) - requested.force,
           off = tip_of(model_, again.state) - tip_of(model_, made.state);
      for (int axis = 0; axis < 3; ++axis) (requested.axes[axis] ? off : missed)[axis] = 0;
      const double size = requested.force.cwiseAbs().maxCoeff(), fraction = missed.norm() / size;
      met += fraction <= 0.01 && off.norm() <= 0.1 ? 1 : 0;
      worst_fraction = std::max(worst_fraction, fraction);
      worst_mm = std::max(worst_mm, off.norm());
      min_N = std::min(min_N, size);
      max_N = std::max(max_N, size);
    }
    print("pressing", tally);
    std::printf(
        "%d of %d within 1 %% of the force and 0.1 mm of the place; farthest %.2g %% and %.2g mm; forces %.3g to %.3g "
        "N\n",
        met, tally.count, 100 * worst_fraction, worst_mm, min_N, max_N);
    return 0;
  }

  /// Draws the tip along a closed curve inside the reach, in steps of constant length.
  int drag() {
    State state = statics_.rest();
    const Index m = model_.actuators.size();
    const int points = 48;
    std::vector<Vec3> curve;
    std::vector<State> states;
    for (int i = 0; i < points; ++i) {
      Actuation actuation(m);
      for (Index a = 0; a < m; ++a) {
        const Actuator& actuator = model_.actuators[a];
        const double phase = 2 * std::numbers::pi * (static_cast<double>(i) / points + static_cast<double>(a) / 3.0);
        actuation[a] = actuator.low + (actuator.high - actuator.low) * (0.35 + 0.25 * std::cos(phase));
      }
      state = statics_.solve(actuation, state, inverse_.statics).state;
      states.push_back(state);
      curve.push_back(tip_of(model_, state));
    }
    state = states[0];
    Tally tally;
    Vec3 at = curve[0];
    std::size_t next = 1;
    Sensitivity last;
    std::vector<double> times;
    for (int i = 0; i < options_.updates; ++i) {
      double left = options_.millimetres_per_update;
      while ((curve[next] - at).norm() < left) {
        left -= (curve[next] - at).norm();
        at = curve[next];
        next = (next + 1) % curve.size();
      }
      at += left * (curve[next] - at).normalized();
      Answer answer = solve(at, state, last.regular ? &last : nullptr);
      tally.add(model_, answer);
      times.push_back(answer.result.seconds);
      state = std::move(answer.result.equilibrium.state);
      last = std::move(answer.result.sensitivity);
    }
    std::printf("target moves %.3g mm per update: %.1f updates/s (median %.1f), %.2f equilibria per update\n",
                options_.millimetres_per_update, tally.count / tally.seconds, 1 / median(times),
                tally.equilibria / tally.count);
    print("dragged", tally);
    return 0;
  }

 private:
  Actuation random_actuation() {
    Actuation actuation(model_.actuators.size());
    for (Index a = 0; a < actuation.size(); ++a) {
      const Actuator& actuator = model_.actuators[a];
      actuation[a] = std::uniform_real_distribution<double>(actuator.low, actuator.high)(engine_);
    }
    return actuation;
  }

  [[nodiscard]] bool touches(const State& state) const {
    const std::optional<ContactForces> contacts = statics_.measured(state).contacts;
    return contacts && !contacts->pairs.empty();
  }

  [[nodiscard]] Vec3 exerted(const ForceGoal& on, const State& state) const {
    const ElementDeformation found = statics_.measured(state);
    std::optional<std::vector<PairForces>> pairs;
    if (found.contacts) pairs = found.contacts->pairs;
    return exerted_force(on, reactions(model_, state.positions, found), pairs);
  }

  [[nodiscard]] std::vector<Goal> pressing_goals(ForceGoal on, const Vec3& force, const Vec3& tip) const {
    Index along = 0;
    (void)force.cwiseAbs().maxCoeff(&along);
    PositionGoal place{0, tip};
    for (int axis = 0; axis < 3; ++axis) {
      on.axes[axis] = axis == along;
      place.axes[axis] = axis != along;
    }
    on.force = force[along] * Vec3::Unit(along);
    on.mm_per_N = usual_mm_per_N(on, inverse_.tolerance_mm, std::nullopt);
    return {{on}, {place}};
  }

  Answer solve(const Vec3& target, const State& start, const Sensitivity* sensitivity = nullptr) {
    return solve({{PositionGoal{0, target}}}, start, sensitivity);
  }

  Answer solve(const std::vector<Goal>& goals, const State& start, const Sensitivity* sensitivity = nullptr) {
    inverse_.start_sensitivity = sensitivity;
    const std::clock_t begin = std::clock();
    Answer answer{solve_inverse(statics_, goals, start, inverse_), 0};
    answer.processor = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    return answer;
  }

  static void print(const char* what, const Tally& t) {
    if (t.count == 0) return;
    std::printf(
        "%s: %d targets, %d reached (%.1f %%, worst error %.2e mm), %d flagged unreachable, %d not converged; largest "
        "slope %.1e mm per range; mean %.2f equilibria (most %d), %.2f iterations, %.1f ms (%.1f ms of processor "
        "time); ranges %s\n",
        what, t.count, t.reached, 100.0 * t.reached / t.count, t.worst_mm, t.flagged, t.lost, t.slope,
        t.equilibria / t.count, t.max_equilibria, t.iterations / t.count, 1e3 * t.seconds / t.count,
        1e3 * t.processor / t.count, t.inside ? "held by every equilibrium" : "VIOLATED");
    std::fflush(stdout);
  }

  const Options& options_;
  Model model_;
  Statics statics_;
  InverseOptions inverse_;
  State rest_;
  std::mt19937 engine_;
};

int run(const Options& options) {
  print_machine();
  Bench bench(options);
  if (!options.press.empty()) return bench.press();
  return options.mode == "drag" ? bench.drag() : bench.reach();
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Inverse kinematics of a robot: random targets, or a target that moves.", "bench_inverse"};
  Options options;
  app.add_option("--robot", options.robot, "a scene, or 'beam': three chambers in a block");
  app.add_option("--mode", options.mode, "reach: random targets; drag: one that moves")
      .check(one_of({"reach", "drag"}));
  app.add_option("--press", options.press, "a support, an obstacle or a body on which random poses press");
  app.add_option("--method", options.method).check(one_of({"newton", "gradient"}));
  app.add_option("--targets", options.targets, "reachable ones, made by forward kinematics");
  app.add_option("--unreachable", options.unreachable);
  app.add_flag("--touching", options.touching, "only reachable targets at which the robot touches something");
  app.add_option("--tolerance", options.tolerance_mm, "[mm]").check(positive());
  app.add_option("--other-starts", options.other_starts).check(within(0, 100));
  app.add_option("--updates", options.updates, "drag: how many").check(within(1, 1000000));
  app.add_option("--move", options.millimetres_per_update, "drag: of the target per update [mm]").check(positive());
  app.add_option("--size", options.size, "of the beam, tetrahedra").check(within(1000.0, 1e6));
  app.add_option("--seed", options.seed);
  app.add_option("--threads", options.threads, "0: all").check(within(0, 256));
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
