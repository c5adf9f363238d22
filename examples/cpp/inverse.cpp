// Inverse kinematics: which commands bring the first marker of a scene some millimetres away from its place at rest?
//
//   inverse SCENE.yaml DX DY DZ

#include <cstdio>
#include <cstdlib>
#include <softkin/softkin.hpp>

int main(int argc, char** argv) try {
  if (argc < 5) {
    std::fprintf(stderr, "usage: inverse SCENE.yaml DX DY DZ\n");
    return 2;
  }
  const softkin::Model model = softkin::compile(softkin::read_scene(argv[1]));
  const softkin::Statics statics(model);
  if (model.markers.empty()) throw softkin::InvalidInput("the robot has no marker");
  const softkin::EmbeddedPoint& point = model.markers.front().point;

  softkin::PositionGoal goal;
  goal.marker = 0;
  goal.target = point.at(model.rest) + softkin::Vec3(std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4]));

  softkin::InverseOptions options;
  options.tolerance_mm = 1e-2;
  int told = 0;
  const auto progress = [&](const softkin::Progress& now) {
    if (now.iteration > told) std::printf("  %d equilibria, %.4f mm away\n", now.iteration, now.step_mm);
    told = now.iteration;
    return true;  // false stops the search
  };
  const softkin::InverseResult found = softkin::solve_inverse(statics, {{goal}}, statics.rest(), options, progress);

  std::printf("%s: %.4f mm away after %d equilibria, %.3f s\n", softkin::name_of(found.status), found.errors_mm[0],
              found.equilibria, found.seconds);
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    std::printf("  %s: %s\n", model.actuators[a].name.c_str(),
                softkin::command_text(model.actuators[a], found.equilibrium.actuation[static_cast<int>(a)]).c_str());

  // A target out of reach ends as near as the ranges allow. Actuators that stopped there say so.
  for (std::size_t a = 0; a < found.active.size(); ++a)
    if (found.active[a] != 0)
      std::printf("  %s is at an end of %s\n", model.actuators[a].name.c_str(),
                  softkin::range_text(model.actuators[a]).c_str());
  return found.status == softkin::InverseStatus::reached ? 0 : 1;
} catch (const softkin::InvalidInput& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
