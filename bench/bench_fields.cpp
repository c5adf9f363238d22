// What a step costs where the material is viscous, and where a magnetic field moves the robot: beside the same finger
// that is elastic and moved by pressure, step by step in turns.

#include <chrono>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/statics/viscous_clock.hpp>

#include "command_line.hpp"
#include "finger.hpp"
#include "machine.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

struct Options {
  std::vector<double> sizes{5000, 45000}, quadratic_sizes{5000, 15000};
  int steps = 30, threads = 0;
  std::string only;
};

/// A robot that follows a path of its single actuator.
class Tracked {
 public:
  Tracked(RobotSpec spec, double from, double to, const Options& options)
      : model_(compile(spec)), statics_(model_), clock_(statics_), from_(from), to_(to), steps_(options.steps) {
    options_.threads = options.threads;
    options_.keep_history = false;
    state_ = statics_.rest();
  }

  /// The first makes the work space. Flowing counts.
  void step(int number) {
    const double time = 0.1 * number;
    clock_.set(time, options_);
    const auto began = std::chrono::steady_clock::now();
    const Equilibrium found =
        statics_.solve(Actuation::Constant(1, from_ + (to_ - from_) * number / steps_), state_, options_);
    complete = complete && found.report.status == Status::converged;
    (void)clock_.pass(time, found.state);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    if (number > 0) seconds.push_back(took.count());
    state_ = found.state;
    iterations += found.report.iterations;
    factorisations += found.report.factorisations;
  }

  [[nodiscard]] double moved_mm() const { return largest_move(model_.rest, state_.positions); }

  std::vector<double> seconds;
  int iterations = 0, factorisations = 0;
  bool complete = true;

 private:
  Model model_;
  Statics statics_;
  ViscousClock clock_;
  StaticsOptions options_;
  State state_;
  double from_, to_;
  int steps_;
};

RobotSpec viscous(RobotSpec spec) {
  for (MaterialSpec& material : spec.materials) material.viscosity = {{2, 0.3}, {1, 3}, {0.5, 30}};
  return spec;
}

RobotSpec by_pressure(RobotSpec spec) {
  ActuatorSpec& air = spec.actuators[0];
  air.control = Control::load;
  air.low = -1000;
  air.high = 1000;
  air.rest = 0;
  return spec;
}

/// The finger's chamber becomes a hollow; its material is magnetic along x.
RobotSpec by_field(RobotSpec spec, const std::shared_ptr<const FieldSource>& source, FieldCommand command,
                   Magnetisation magnetisation) {
  const std::string chamber = *spec.actuators[0].as<PneumaticSpec>()->region;
  spec.voids.push_back(RegionRef{chamber, {}});
  auto remanence = std::make_shared<RemanenceSpec>();
  remanence->uniform = {100, 0, 0};
  remanence->magnetisation = magnetisation;
  for (MaterialSpec& material : spec.materials) material.remanence = remanence;
  ActuatorSpec field;
  field.name = "field";
  field.control = Control::load;
  field.low = -1e6;
  field.high = 1e6;
  field.rest = 0;
  field.drive = FieldSpec{source, command};
  spec.actuators = {field};
  return spec;
}

void compare(double size, FingerKind kind, const Options& options) {
  const double cell = cell_for(size);
  const RobotSpec finger = finger_robot(bellows_finger(cell), kind, "finger");
  const auto uniform = std::make_shared<const FieldSource>(FieldSource{"field", UniformField{{0, 0, 1}}});
  const auto coil =
      std::make_shared<const FieldSource>(FieldSource{"coil", CoilField{{{{60, 0, -80}, {0, 0, 1}, 60, 500}}}});
  std::vector<std::pair<std::string, std::unique_ptr<Tracked>>> all;
  all.emplace_back("volume", std::make_unique<Tracked>(finger, 1, 1.3, options));
  all.emplace_back("volume, viscous", std::make_unique<Tracked>(viscous(finger), 1, 1.3, options));
  all.emplace_back("pressure", std::make_unique<Tracked>(by_pressure(finger), 0, 20, options));
  for (const auto& [name, source, command, most] : {std::tuple("uniform", uniform, FieldCommand::flux_density, 40.0),
                                                    std::tuple("coil", coil, FieldCommand::current, 10.0)})
    for (const auto& [form, magnetisation] :
         {std::pair("", Magnetisation::turns), std::pair(", stretches", Magnetisation::stretches)})
      all.emplace_back(std::string(name) + form,
                       std::make_unique<Tracked>(by_field(finger, source, command, magnetisation), 0, most, options));
  const auto requested = [&](const std::string& what) { return options.only.empty() || options.only == what; };
  for (int step = 0; step <= options.steps; ++step)
    for (auto& [what, robot] : all)
      if (requested(what)) robot->step(step);
  const bool compared = options.only.empty();
  const double elastic = compared ? median(all[0].second->seconds) : 0,
               pressed = compared ? median(all[2].second->seconds) : 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!requested(all[i].first)) continue;
    const Tracked& robot = *all[i].second;
    const double typical = median(robot.seconds);
    std::printf(
        "%9lld  %-9s %-20s %10.1f %11.2f %8.2f %10.1f %10.2f%s\n", static_cast<long long>(body_tetrahedra(cell)),
        kind == FingerKind::physical ? "linear" : "quadratic", all[i].first.c_str(), robot.moved_mm(), 1e3 * typical,
        compared ? typical / (i < 2 ? elastic : pressed) : 1, static_cast<double>(robot.iterations) / options.steps,
        static_cast<double>(robot.factorisations) / options.steps, robot.complete ? "" : "  not all converged");
    std::fflush(stdout);
  }
}

int run(const Options& options) {
  print_machine();
  std::printf("%9s  %-9s %-20s %10s %11s %8s %10s %10s\n", "body tets", "elements", "moved by", "far [mm]",
              "median [ms]", "ratio", "iterations", "factorisat.");
  for (const double size : options.sizes) compare(size, FingerKind::physical, options);
  for (const double size : options.quadratic_sizes) compare(size, FingerKind::physical_quadratic, options);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CommandLine app{"Steps of a finger that is viscous or magnetic over those of one that is not.", "bench_fields"};
  app.add_option("--sizes", options.sizes, "body tetrahedra of order 1").split_at_commas();
  app.add_option("--quadratic-sizes", options.quadratic_sizes, "of order 2").split_at_commas();
  app.add_option("--steps", options.steps, "of the path").check(positive());
  app.add_option("--only", options.only, "one of what the robot is moved by, to profile it");
  app.add_option("--threads", options.threads, "0: as many as the machine has");
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
