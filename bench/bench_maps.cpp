// What kinematic maps cost and whether the errors that they state are honest: equilibria for an accuracy against the
// number of actuators, and fresh points beside what the checks found.

#include <chrono>
#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <thread>

#include "command_line.hpp"
#include "model/physical_robots.hpp"

namespace {

using namespace softkin;
using namespace softkin::bench;

struct Options {
  double accuracy = 0.01;
  std::vector<int> inputs{1, 2, 3, 4, 6};
  Index checks = 200, fresh = 0;
  int threads = 0;
  bool errors = false;
  std::string plot;
};

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

ActuatorSpec ranged_actuator(const std::string& name, DriveSpec drive, double low, double high) {
  ActuatorSpec spec;
  spec.name = name;
  spec.drive = std::move(drive);
  spec.low = low;
  spec.high = high;
  return spec;
}

ActuatorSpec cable(const std::string& name, const std::vector<Vec3>& points, double low, double high) {
  ActuatorSpec spec = ranged_actuator(name, CableSpec{}, low, high);
  for (const Vec3& point : points) spec.as<CableSpec>()->points.push_back({point, {}});
  return spec;
}

/// Returns an arm of 180 x 12 x 12 mm with a number of tendons, pulled with 0 to 1.5 N: two at every third of its
/// length, at right angles to each other.
RobotSpec arm(int tendons) {
  RobotSpec spec = softkin::testing::physical_robot(softkin::testing::block_mesh({36, 2, 2}, {180, 12, 12}));
  spec.materials[0].elastic->youngs_modulus = 1;
  for (int i = 0; i < tendons; ++i) {
    const double end = 180 - 60 * static_cast<double>(i / 2);
    std::vector<Vec3> points;
    for (double x = 0; x <= end; x += 20) points.push_back(i % 2 == 0 ? Vec3(x, 6, 11) : Vec3(x, 11, 6));
    ActuatorSpec& tendon = spec.actuators.emplace_back(cable("tendon" + std::to_string(i + 1), points, 0, 1.5));
    tendon.control = Control::load;
    tendon.rest = 0;
  }
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// A beam of 48 x 20 x 20 mm with up to three chambers along it.
RobotSpec chambers(int count, double high) {
  Mesh mesh = softkin::testing::block_mesh({8, 5, 5}, {48, 20, 20});
  const double places[3][2] = {{4, 4}, {12, 4}, {8, 12}};
  for (int i = 0; i < count; ++i)
    softkin::testing::add_volume_region(mesh, "chamber" + std::to_string(i + 1), [&](const Vec3& p) {
      return p.x() > 6 && p.x() < 42 && p.y() > places[i][0] && p.y() < places[i][0] + 4 && p.z() > places[i][1] &&
             p.z() < places[i][1] + 4;
    });
  RobotSpec spec = softkin::testing::physical_robot(std::move(mesh));
  for (int i = 0; i < count; ++i) {
    const std::string name = "chamber" + std::to_string(i + 1);
    spec.actuators.push_back(ranged_actuator(name, PneumaticSpec{.region = name}, 1, high));
  }
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

/// A beam of 60 x 10 x 10 mm with cables along its top and its bottom, one of which is slack.
RobotSpec two_cables(double low) {
  RobotSpec spec = softkin::testing::physical_robot(softkin::testing::block_mesh({12, 2, 2}, {60, 10, 10}));
  const auto along = [](double z) { return std::vector<Vec3>{{0, 5, z}, {20, 5, z}, {40, 5, z}, {60, 5, z}}; };
  spec.actuators = {cable("top", along(9), low, 1.1), cable("bottom", along(1), low, 1.1)};
  spec.markers.push_back({"tip", {std::string("x_high"), {}}});
  return spec;
}

MapOptions map_options(const Options& options) {
  MapOptions map;
  map.accuracy_mm = options.accuracy;
  map.shape_accuracy_mm = 0;
  map.checks = options.checks;
  map.max_equilibria = 20000;
  map.threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return map;
}

/// Points of the full grid of Chebyshev polynomials that has all terms which matter: along each input the least degree
/// beyond which the coefficients of the markers sum to less than the accuracy.
double full_grid(const MapData& data) {
  const maps::Polynomials& polynomials = data.pieces[0].cells[0].outputs;
  double points = 1;
  for (Index j = 0; j < polynomials.variables(); ++j) {
    int degree = polynomials.terms().col(j).maxCoeff();
    for (; degree > 0; --degree) {
      double beyond = 0;
      for (Index q = 0; q < polynomials.count(); ++q) {
        if (data.outputs[q].unit != "mm") continue;
        double sum = 0;
        for (Index t = 0; t < polynomials.terms().rows(); ++t)
          if (polynomials.terms()(t, j) >= degree) sum += std::abs(polynomials.coefficients()(t, q));
        beyond = std::max(beyond, sum);
      }
      if (beyond > data.outputs[0].accuracy) break;
    }
    points *= degree + 1;
  }
  return points;
}

double largest_marker(const MapData& data) {
  double largest = 0;
  for (std::size_t q = 0; q < data.outputs.size(); ++q)
    if (data.outputs[q].unit == "mm") largest = std::max(largest, data.check.largest[q]);
  return largest;
}

int economy(const Options& options) {
  std::printf("tendons  equilibria  terms  full grid  largest error at %d checks [mm]  seconds\n", options.checks);
  PlotSeries made{"map", {}, {}}, grid{"full grid", {}, {}};
  bool accurate = true;
  for (const int tendons : options.inputs) {
    const Model model = compile(arm(tendons));
    const double begin = seconds_now();
    const MapResult result = build_map(model, map_options(options)).value();
    const double full = full_grid(result.data);
    std::printf("%7d  %10d  %5d  %9.0f  %31.2g  %7.1f%s\n", tendons, result.data.equilibria,
                static_cast<int>(result.data.pieces[0].cells[0].outputs.terms().rows()), full,
                largest_marker(result.data), seconds_now() - begin, result.accurate ? "" : "  NOT ACCURATE");
    std::fflush(stdout);
    accurate = accurate && result.accurate;
    made.x.push_back(tendons), made.y.push_back(result.data.equilibria);
    grid.x.push_back(tendons), grid.y.push_back(full);
  }
  if (!options.plot.empty()) {
    PlotPanel panel;
    panel.title = "Equilibria for " + number(options.accuracy) + " mm";
    panel.x.label = "tendons";
    panel.x.whole = true;
    panel.y.label = "equilibria";
    panel.series = {made, grid};
    panel.y.logarithmic = true;
    write_svg(options.plot, {"Kinematic maps of an arm", {{panel}}});
  }
  return accurate ? 0 : 1;
}

/// The largest error at checks against the equilibria that it took.
int errors(const Options& options) {
  std::printf("tendons  asked for [mm]  equilibria  largest error at %d checks [mm]\n", options.checks);
  PlotPanel panel;
  panel.x.label = "equilibria that the map is made of";
  panel.y.label = "largest error of the tip at checks [mm]";
  panel.x.logarithmic = panel.y.logarithmic = true;
  for (const int tendons : options.inputs) {
    PlotSeries& series = panel.series.emplace_back();
    series.label = std::to_string(tendons) + (tendons == 1 ? " tendon" : " tendons");
    const Model model = compile(arm(tendons));
    for (const double accuracy : {10.0, 1.0, 0.1, 0.01, 1e-3, 1e-4}) {
      MapOptions map = map_options(options);
      map.accuracy_mm = accuracy;
      map.statics.step_tolerance_mm = 1e-9;
      const MapData data = build_map(model, map).value().data;
      std::printf("%7d  %14g  %10d  %31.2g\n", tendons, accuracy, data.equilibria, largest_marker(data));
      std::fflush(stdout);
      if (!series.x.empty() && series.x.back() == data.equilibria) continue;
      series.x.push_back(data.equilibria), series.y.push_back(largest_marker(data));
    }
  }
  if (!options.plot.empty()) write_svg(options.plot, {"Kinematic maps of an arm of 180 mm", {{panel}}, 760, 320});
  return 0;
}

/// Fresh points, solved and compared.
void judge(const char* name, const RobotSpec& spec, const Options& options) {
  const Model model = compile(spec);
  const MapResult result = build_map(model, map_options(options)).value();
  const KinematicMap map(result.data);
  const Statics statics(model);
  StaticsOptions alone;
  alone.threads = 1;
  alone.keep_history = false;
  alone.step_tolerance_mm = 1e-9;  // stated errors are often less than what the solver leaves by default
  const maps::RowMatrix commands = maps::random_commands(result.data, options.fresh, 424242);
  Index compared = 0, beyond = 0, twice = 0;
  double worst = 0;
  State near = statics.rest();
  for (Index i = 0; i < options.fresh; ++i) {
    Actuation actuation = model.rest_actuation();
    for (Index j = 0; j < map.inputs(); ++j) actuation[result.data.inputs[j].actuator] = commands(i, j);
    Eigen::VectorXd values(map.outputs());
    if (!map.evaluate(commands.row(i).data(), values.data())) continue;
    const Equilibrium found = statics.solve(actuation, near, alone);
    if (found.report.status != Status::converged) continue;
    near = found.state;
    const Eigen::VectorXd off = (values - maps::outputs_of(model, result.data, found.state)).cwiseAbs();
    double ratio = 0;
    for (Index q = 0; q < off.size(); ++q)  // outputs that are exact up to rounding are left out
      if (off[q] > 1e-6 * result.data.outputs[q].accuracy)
        ratio = std::max(ratio, off[q] / result.data.check.largest[q]);
    ++compared;
    beyond += ratio > 1 ? 1 : 0;
    twice += ratio > 2 ? 1 : 0;
    worst = std::max(worst, ratio);
  }
  std::printf("%-22s  %10d  %8d  %9.3f  %15.3f  %16.2f\n", name, result.data.equilibria, compared,
              100.0 * beyond / std::max<Index>(1, compared), 100.0 * twice / std::max<Index>(1, compared), worst);
  std::fflush(stdout);
}

int honesty(const Options& options) {
  std::printf("robot                   equilibria  compared  beyond [%%]  beyond twice [%%]  largest over stated\n");
  judge("arm of 1", arm(1), options);
  judge("arm of 2", arm(2), options);
  judge("arm of 3", arm(3), options);
  judge("arm of 4", arm(4), options);
  judge("1 chamber", chambers(1, 2), options);
  judge("2 chambers", chambers(2, 1.6), options);
  judge("3 chambers", chambers(3, 1.5), options);
  judge("2 cables", two_cables(0.85), options);
  judge("2 cables, farther", two_cables(0.7), options);
  RobotSpec mixed = chambers(2, 1.5);
  mixed.actuators.push_back(cable("side", {{0, 10, 19}, {24, 10, 19}, {48, 10, 19}}, 0.85, 1.05));
  judge("2 chambers and a cable", mixed, options);
  return 0;
}

int run(const Options& options) {
  print_machine();
  return options.fresh > 0 ? honesty(options) : options.errors ? errors(options) : economy(options);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine app{"Kinematic maps: equilibria for an accuracy, and whether stated errors are honest.", "bench_maps"};
  Options options;
  app.add_option("--accuracy", options.accuracy, "of the tip [mm]");
  app.add_option("--inputs", options.inputs, "tendons of the arms").split_at_commas();
  app.add_option("--check", options.checks, "random actuations at which a map is checked");
  app.add_option("--fresh", options.fresh, "random actuations beside what the checks found, of ten robots; 0: none");
  app.add_flag("--errors", options.errors, "errors against equilibria, for accuracies from 10 mm to 1e-4 mm");
  app.add_option("--threads", options.threads, "0: as many as the machine has");
  app.add_option("--plot", options.plot, "F.svg: equilibria against tendons, or errors against equilibria");
  return run_benchmark(app, argc, argv, [&] { return run(options); });
}
