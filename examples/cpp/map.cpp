// What a kinematic map costs, and whether its inverse kinematics is that of the solver. `softkin map SCENE.yaml -o
// F.skmap` makes it.
//
//   map SCENE.yaml F.skmap [TARGETS [SOLVED]]     1000 random targets, so many of which the solver answers, too (0)

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <softkin/kinematics/map_robot.hpp>
#include <softkin/runs/map_file.hpp>
#include <softkin/softkin.hpp>

namespace {

double microseconds() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: map SCENE.yaml F.skmap [TARGETS [SOLVED]]\n");
    return 2;
  }
  const softkin::Model model = softkin::compile(softkin::read_scene(argv[1]));
  const softkin::KinematicMap map(softkin::runs::read_map(argv[2]));
  softkin::runs::check_robot(map.data(), model, argv[2]);
  std::printf("%s\n", softkin::runs::map_text(map.data()).c_str());
  const int targets = argc > 3 ? std::atoi(argv[3]) : 1000, solved = argc > 4 ? std::atoi(argv[4]) : 0;
  const softkin::Actuations commands = softkin::sample_actuations(model, {softkin::Sampling::random, targets, 7});

  // Forward kinematics needs the map alone: outputs, and their slopes by the commands.
  Eigen::VectorXd values(map.outputs()), slopes(map.inputs() * map.outputs());
  std::vector<softkin::Vec3> tips;
  double begin = microseconds();
  for (int i = 0; i < targets; ++i) {
    const Eigen::VectorXd of_map = map.commands(commands.row(i));
    if (map.evaluate(of_map.data(), values.data(), slopes.data())) tips.emplace_back(values.head<3>());
  }
  std::printf("forward kinematics with Jacobian: %.2f us\n", (microseconds() - begin) / targets);

  // What needs markers and loads alone takes a MapRobot for the robot. Every fifth target is out of reach, or nearly.
  const softkin::MapRobot robot(model, map);
  const softkin::Statics statics(model);
  std::vector<double> times;
  int reached = 0, compared = 0, alike = 0;
  double apart_mm = 0;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const softkin::Vec3 target = i % 5 == 4 ? 1.15 * tips[i] : tips[i];
    const std::vector<softkin::Goal> goals{{softkin::PositionGoal{0, target}, 1}};
    begin = microseconds();
    const softkin::InverseResult found = softkin::solve_inverse_from(robot.statics(), goals, model.rest_actuation());
    times.push_back(microseconds() - begin);
    reached += found.status == softkin::InverseStatus::reached ? 1 : 0;
    if (static_cast<int>(i) >= solved) continue;
    const softkin::InverseResult exact = softkin::solve_inverse_from(statics, goals, model.rest_actuation());
    ++compared;
    alike += exact.status == found.status ? 1 : 0;
    apart_mm = std::max(apart_mm, (robot.model().markers[0].point.at(found.equilibrium.state.positions) -
                                   model.markers[0].point.at(exact.equilibrium.state.positions))
                                      .norm());
  }
  std::sort(times.begin(), times.end());
  std::printf("inverse kinematics: %d of %zu targets reached, %.1f us in the middle\n", reached, tips.size(),
              times.empty() ? 0 : times[times.size() / 2]);
  if (compared > 0)
    std::printf("beside the solver: %d of %d alike, tips at most %.2g mm apart\n", alike, compared, apart_mm);
  return 0;
} catch (const softkin::InvalidInput& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
