#pragma once

#include <filesystem>
#include <softkin/model/robot_spec.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A scene, and what the user changes in it.
struct AskedScene {
  std::string scene;                // file
  std::string formulation;          // "physical" or "target-shape"; empty: the scene's
  std::vector<std::string> forces;  // NAME=FX,FY,FZ [N]
};

/// inputs  the files that the scene names are added
/// throws  InvalidInput naming --force, or file and line
[[nodiscard]] RobotSpec read_asked_scene(const AskedScene& asked, std::vector<std::filesystem::path>& inputs);

}  // namespace softkin
