// A program that includes every public header, and calls each module of an installed softkin (tests/installed.cmake).
//   every_module SCENE

#include "public_headers.hpp"  // written by installed.cmake

#include <cstdio>
#include <iostream>

namespace {

using namespace softkin;

void solve(const char* scene) {
  const Model model = compile(read_scene(scene));
  const Statics statics(model);
  const Equilibrium found = statics.solve(model.rest_actuation(), statics.rest());
  const ElementDeformation measured = statics.measured(found.state);
  std::printf("%s, %s: %s\n", model.name.c_str(), formulation_name(model.formulation), name_of(found.report.status));

  std::vector<Index> markers;
  for (std::size_t i = 0; i < model.markers.size(); ++i) markers.push_back(i);
  std::cout << "Jacobian [mm per unit]:\n" << jacobian(statics, found, markers) << "\n";

  const runs::StepRecord record = runs::step_record(model, found, measured);
  std::printf("%zu findings; report:\n", runs::findings(model, record).size());
  runs::step_report(model, scene, {}, {}, record).report([](std::string_view piece) { std::cout << piece; });
}

}  // namespace

int main(int count, char** words) try {
  if (count != 2) return 2;
  std::printf("softkin %s, %s, %s\n", version(), name_of(target()), duration(75).c_str());
  solve(words[1]);
  const calibration::IncompressibleLaw silicone{Law::neo_hookean, 0.1};
  std::printf("silicone at a strain of 1: %g MPa\n", calibration::uniaxial_stress(silicone, 1));
  std::printf("a stream that was %s\n", drive::name_of(drive::StreamEnd::finished));
  Points corners(4, 3);
  corners << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  std::printf("hull of a corner: %g mm^3\n", convex_hull(corners).volume);
  return 0;
} catch (const InvalidInput& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
