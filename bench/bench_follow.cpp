// Paths followed by Gauss-Newton with exact Jacobians and by the paper's Algorithm 2, the same equilibrium solver
// inside (the paper's Fig. 13).

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <softkin/io/scene/scene.hpp>
#include <softkin/io/table/marker_path.hpp>
#include <softkin/kinematics/trajectory.hpp>
#include <softkin/model/robot_spec.hpp>
#include <string>

#include "command_line.hpp"
#include "machine.hpp"
#include "model/block_mesh.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

// of examples/knuckle_finger.geo [mm]
constexpr double length = 120, width = 25, height = 25, hinge = 5, flat = 4, slope = 0.4, cable_z = 21.5;
constexpr std::array<double, 3> notches{30, 64, 98};

/// Of the upper side.
double top_at(double x) {
  double top = height;
  for (const double notch : notches) top = std::min(top, hinge + std::max(0.0, std::abs(x - notch) - flat) / slope);
  return top;
}

/// Planes across the finger: the corners of its profile, and planes evenly between them, no farther apart than a size.
std::vector<double> planes(double size) {
  std::vector<double> corners{0};
  for (const double notch : notches)
    for (const double half : {-(flat + (height - hinge) * slope), -flat, flat, flat + (height - hinge) * slope})
      corners.push_back(notch + half);
  corners.push_back(length);
  std::vector<double> planes{0};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const double extent = corners[i] - corners[i - 1], parts = std::max(1.0, std::round(extent / size));
    for (double part = 1; part <= parts; ++part) planes.push_back(corners[i - 1] + extent * part / parts);
  }
  return planes;
}

/// Cells along x, y and z for cells of a size.
std::array<int, 3> cells_for(double size) {
  const auto count = [size](double extent) { return std::max(2, 2 * static_cast<int>(std::round(extent / size / 2))); };
  return {static_cast<int>(planes(size).size()) - 1, count(width), count(0.7 * height)};
}

double tetrahedra_for(double size) {
  const std::array<int, 3> cells = cells_for(size);
  return 6.0 * cells[0] * cells[1] * cells[2];
}

double size_for(double tetrahedra) {
  double best = 5;
  for (double size = 12; size > 0.8; size *= 0.99)
    if (std::abs(std::log(tetrahedra_for(size) / tetrahedra)) < std::abs(std::log(tetrahedra_for(best) / tetrahedra)))
      best = size;
  return best;
}

Mesh finger_mesh(double size) {
  const std::array<int, 3> cells = cells_for(size);
  Mesh mesh = testing::block_mesh(cells, {1, 1, 1}, testing::Split::six);
  const std::vector<double> x = planes(size);
  for (Index v = 0; v < mesh.vertices.rows(); ++v) {
    auto p = mesh.vertices.row(v);
    p.x() = x[std::lround(p.x() * cells[0])];
    p.y() = width * (p.y() - 0.5);
    p.z() *= top_at(p.x());
  }
  for (Region& region : mesh.regions) {
    if (region.name == "x_low") region.name = "base";
    if (region.name == "x_high") region.name = "tip";
  }
  return mesh;
}

/// Returns the robot of examples/three_tendon_finger with a mesh of about `tetrahedra` elements in place of its own:
/// the same shape, in hexahedra of six tetrahedra each; the tendons enter and leave the body at points.
///
/// scene   of that example
/// order   of the tetrahedra in the physical formulation, 1 or 2
RobotSpec knuckle_finger(const std::string& scene, double tetrahedra, int order) {
  RobotSpec spec = read_scene(scene);
  spec.mesh = finger_mesh(size_for(tetrahedra));
  spec.mesh_options.quadratic = order == 2;
  const double beside = flat + (cable_z - hinge) * slope;  // of the notch's middle, where the cable leaves its wall
  for (std::size_t a = 0; a < spec.actuators.size() && a < notches.size(); ++a) {
    spec.actuators[a].as<CableSpec>()->points[1].point = Vec3(notches[a] - beside, 0, cable_z);
    spec.actuators[a].as<CableSpec>()->points[2].point = Vec3(notches[a] + beside, 0, cable_z);
  }
  return spec;
}

struct Options {
  std::string scene = "examples/three_tendon_finger/three_tendon_finger.yaml";
  std::vector<std::string> paths{"examples/three_tendon_finger/letter_l.csv", "examples/three_tendon_finger/flame.csv"};
  std::vector<std::string> formulations{"physical", "target-shape"};
  double size = 10000, local_size = 600, limit = 120;
  double local_tolerance_mm = 1e-6;
  int anderson = 0;
  int order = 1, threads = 0, waypoints = 1000000;
};

struct Method {
  const char* name;
  InverseMethod method;
  double requested_mm;
};

constexpr Method methods[] = {{"newton", InverseMethod::newton, 1e-3},
                              {"gradient", InverseMethod::gradient, 0.2},
                              {"gradient", InverseMethod::gradient, 0.01}};

struct Followed {
  std::vector<InverseResult> waypoints;
  double seconds = 0;
  bool whole = true;  // not stopped by the limit

  [[nodiscard]] double seconds_of(std::size_t count) const {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += waypoints[i].seconds;
    return sum;
  }
};

Followed follow(const Statics& statics, const MarkerPath& path, const TrajectoryOptions& options, double limit) {
  Followed result;
  const double begin = now();
  result.waypoints = follow_path(statics, path, options, [=](const Progress&) { return now() - begin < limit; });
  result.seconds = now() - begin;
  result.whole = result.waypoints.size() == path.waypoints.size();
  return result;
}

TrajectoryOptions trajectory(const Method& method, Solver solver, const Options& options) {
  TrajectoryOptions result;
  result.inverse.method = method.method;
  result.inverse.tolerance_mm = method.requested_mm;
  result.inverse.max_iterations = 1000;  // or the paper's 30 would end it short of 0.01 mm
  result.inverse.statics.solver = solver;
  if (solver == Solver::local_global) {
    result.inverse.statics.step_tolerance_mm = options.local_tolerance_mm;
    result.inverse.statics.anderson = options.anderson;
  }
  result.inverse.statics.threads = options.threads;
  result.inverse.statics.keep_history = false;
  return result;
}

/// The sample of a workspace in steps of a tenth of every range that is next to the path's beginning: from there all
/// methods begin, as Algorithm 3 does.
Actuation sample_near(const Model& model, const Statics& statics, const MarkerPath& path, const Options& options) {
  constexpr double steps = 10;
  MarkerPath begin{path.markers, path.axes, {path.waypoints.front()}};
  Actuation near =
      follow_path(statics, begin, trajectory(methods[0], Solver::newton, options)).at(0).equilibrium.actuation;
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const double low = model.actuators[a].low, range = model.actuators[a].high - low;
    double& value = near[a];
    value = std::clamp(low + range * std::round((value - low) / range * steps) / steps, low, low + range);
  }
  return near;
}

void print_row(const Method& method, const Followed& found, const Followed& newton, std::size_t requested) {
  double worst = 0, equilibria = 0;
  std::size_t missed = 0;
  for (const InverseResult& each : found.waypoints) {
    worst = std::max(worst, each.errors_mm.maxCoeff());
    equilibria += each.equilibria;
    missed += each.status == InverseStatus::reached ? 0 : 1;
  }
  const std::size_t count = found.waypoints.size();
  std::printf("    %-9s %7.3g  %4zu of %-4zu", method.name, method.requested_mm, count, requested);
  if (count == 0) {
    std::printf("  none within the limit of %.0f s", found.seconds);
    if (!newton.waypoints.empty())
      std::printf(": newton is more than %.1f times faster", found.seconds / newton.seconds_of(1));
    std::printf("\n");
    return;
  }
  std::printf("  %11.2f  %12.2e  %6zu  %9.2f  %13.1f", equilibria / static_cast<double>(count), worst, missed,
              found.seconds, 1e3 * found.seconds_of(count) / static_cast<double>(count));
  if (&found != &newton)
    std::printf("  %10.1f", found.seconds_of(count) / newton.seconds_of(std::min(count, newton.waypoints.size())));
  std::printf("%s\n", found.whole ? "" : "  stopped by the limit; the ratio is of the waypoints done");
  std::fflush(stdout);
}

void compare(const RobotSpec& spec, Solver solver, const Options& options) {
  const Model model = compile(spec);
  const Statics statics(model);
  std::printf("\n%zu tetrahedra of order %d, %s, %s inside\n", model.elements.tetrahedra.size(),
              model.elements.edge_nodes.empty() ? 1 : 2,
              model.formulation == Formulation::physical ? "physical" : "target-shape",
              solver == Solver::newton ? "newton" : "local-global");
  std::printf("    %-9s %7s  %-12s  %11s  %12s  %6s  %9s  %13s  %10s\n", "method", "asked", "waypoints", "equilibria",
              "worst error", "missed", "time", "a waypoint", "newton");
  std::printf("    %-9s %7s  %-12s  %11s  %12s  %6s  %9s  %13s  %10s\n", "", "[mm]", "", "a waypoint", "[mm]", "",
              "[s]", "[ms]", "faster");
  for (const std::string& file : options.paths) {
    MarkerPath path = read_marker_path(file, model);
    if (path.waypoints.size() > static_cast<std::size_t>(options.waypoints)) path.waypoints.resize(options.waypoints);
    const Actuation start = sample_near(model, statics, path, options);
    std::printf("  %s\n", std::filesystem::path(file).stem().c_str());
    Followed newton;
    for (const Method& method : methods) {
      TrajectoryOptions how = trajectory(method, solver, options);
      how.start = start;
      if (method.method == InverseMethod::newton) {
        newton = follow(statics, path, how, options.limit);
        print_row(method, newton, newton, path.waypoints.size());
      } else {
        print_row(method, follow(statics, path, how, options.limit), newton, path.waypoints.size());
      }
    }
  }
}

int run(const Options& options) {
  print_machine();
  for (const std::string& formulation : options.formulations) {
    RobotSpec spec = knuckle_finger(options.scene, options.size, options.order);
    spec.formulation = formulation == "physical" ? Formulation::physical : Formulation::target_shape;
    compare(spec, Solver::newton, options);
  }
  if (options.local_size > 0) {
    RobotSpec spec = knuckle_finger(options.scene, options.local_size, 1);
    spec.formulation = Formulation::target_shape;
    compare(spec, Solver::local_global, options);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Paths on the three-tendon finger: Gauss-Newton against Algorithm 2, the same solver inside.",
                  "bench_follow"};
  Options options;
  app.add_option("--scene", options.scene, "of the three-tendon finger");
  app.add_option("--paths", options.paths, "of its tip, .csv").split_at_commas();
  app.add_option("--formulations", options.formulations, "with newton inside")
      .split_at_commas()
      .check(one_of({"physical", "target-shape"}));
  app.add_option("--size", options.size, "tetrahedra").check(within(200.0, 1e6));
  app.add_option("--order", options.order, "of the tetrahedra, physical").check(within(1, 2));
  app.add_option("--local-size", options.local_size, "tetrahedra with local-global inside; 0: not")
      .check(within(0.0, 1e6));
  app.add_option(
         "--local-tolerance", options.local_tolerance_mm,
         "step at which local-global ends [mm]; at the paper's 1e-5 its error is as large as the tolerance of newton")
      .check(positive());
  app.add_option("--anderson", options.anderson, "steps that Anderson acceleration combines; 0: as the paper ran it")
      .check(within(0, 20));
  app.add_option("--waypoints", options.waypoints, "of each path, at most").check(within(1, 1000000));
  app.add_option("--limit", options.limit, "of each method on each path [s]").check(positive());
  app.add_option("--threads", options.threads, "0: all").check(within(0, 256));
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
