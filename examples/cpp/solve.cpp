// Reads a scene, moves its first actuator from rest to an end of its range in some steps, and prints where the markers
// go and what the actuator answers with.
//
//   solve SCENE.yaml [STEPS]

#include <cstdio>
#include <cstdlib>
#include <softkin/softkin.hpp>

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: solve SCENE.yaml [STEPS]\n");
    return 2;
  }
  const int steps = argc > 2 ? std::atoi(argv[2]) : 4;

  // What the user wrote, and what it means: a Model does not change any more. Statics holds on to it.
  const softkin::Model model = softkin::compile(softkin::read_scene(argv[1]));
  const softkin::Statics statics(model);
  if (model.actuators.empty()) throw softkin::InvalidInput("the robot has no actuator");
  const softkin::Actuator& first = model.actuators.front();
  std::printf("softkin %s, %s: %s (%s), %s\n", softkin::version(), argv[1], first.name.c_str(),
              softkin::kind_name(first), softkin::range_text(first).c_str());

  // A command per actuator, in the order of model.actuators. Of both ends of the range the one farther from rest.
  softkin::Actuation command = model.rest_actuation();
  const double rest = command[0], end = rest - first.low > first.high - rest ? first.low : first.high;

  softkin::State state = statics.rest();
  for (int step = 1; step <= steps; ++step) {
    command[0] = rest + (end - rest) * step / steps;
    // from the shape of the step before: that is quicker, and follows the branch on which the robot is
    const softkin::Equilibrium found = statics.solve(command, state);
    std::printf("%s %.4f: %s after %d iterations, %.3f s", first.name.c_str(), command[0],
                softkin::name_of(found.report.status), found.report.iterations, found.report.seconds);
    if (found.report.status != softkin::Status::converged) {  // a status, never an exception
      std::printf(": %s\n", found.report.remark.c_str());
      return 1;
    }
    const std::string key = softkin::multiplier_key(first);  // pressure_kPa, tension_N or none
    if (!key.empty()) std::printf(", %s %.4f", key.c_str(), found.state.multipliers[0]);
    for (const softkin::Marker& marker : model.markers) {
      const softkin::Vec3 at = marker.point.at(found.state.positions);
      std::printf(", %s at (%.3f, %.3f, %.3f) mm", marker.name.c_str(), at.x(), at.y(), at.z());
    }
    std::printf("\n");
    state = found.state;
  }
  return 0;
} catch (const softkin::InvalidInput& error) {  // a file, a number or an option that is refused, in one sentence
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
