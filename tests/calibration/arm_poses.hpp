#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <softkin/calibration/robot_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <string>
#include <vector>

#include "model/block_mesh.hpp"
#include "support/temporary_folder.hpp"

namespace softkin::calibration {

/// An arm of 60 x 10 x 10 mm that hangs along x under its weight, with a tendon along its top, by its tension, and a
/// marker on a stem.
inline const char* const arm_scene = R"(softkin: 1
mesh: {file: arm.msh}
materials: [{region: body, youngs_modulus: 0.3, poisson_ratio: 0.45, density: 1100}]
fixed: [{region: x_low}]
gravity: [0, 0, -9.81]
actuators:
  - {name: t1, kind: cable, control: tension, range: [0, 2], points: [[0, 5, 9], [20, 5, 9], [40, 5, 9], [60, 5, 9]]}
  - {name: t2, kind: cable, control: tension, range: [0, 2], points: [[0, 9, 5], [20, 9, 5], [40, 9, 5], [60, 9, 5]]}
markers:
  - {name: tip, region: x_high, offset: [3, 0, 8]}
  - {name: half, point: [30, 0, 5]}
)";

class Arm {
 public:
  explicit Arm(const std::string& text = arm_scene) {
    write_mesh(folder_ / "arm.msh", testing::block_mesh({6, 2, 2}, {60, 10, 10}));
    std::ofstream(folder_ / "arm.yaml") << text;
  }

  [[nodiscard]] NumberedRobot robot(const std::vector<std::string>& numbers,
                                    const std::vector<GivenNumber>& given = {}) const {
    std::vector<FittedNumber> all;
    for (const std::string& text : numbers) all.push_back(parse_fitted_number("--fit", text));
    std::vector<std::filesystem::path> inputs;
    RequestedScene requested;
    requested.scene = folder_ / "arm.yaml";
    return {requested, all, inputs, given};
  }

  /// Its poses where it has these numbers, with noise and some readings far off.
  [[nodiscard]] MeasuredPoses poses(const std::vector<std::string>& numbers, double noise = 0, unsigned seed = 1,
                                    double wrong = 0) const {
    const NumberedRobot truth = robot(numbers);
    MeasuredPoses poses = empty(truth.model(truth.start()));
    const RobotFit found = predict_poses(truth, poses, truth.start(), {});
    poses.values = found.computed.values;
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal(0, 1);
    std::uniform_real_distribution<double> fraction(0, 1);
    for (Index pose = 0; pose < poses.values.rows(); ++pose)
      for (Index c = 0; c < poses.values.cols(); c += 3) {
        const Vec3 route(normal(engine), normal(engine), normal(engine));
        const bool off = fraction(engine) < wrong;
        for (Index axis = 0; axis < 3; ++axis)
          poses.values(pose, c + axis) += noise * normal(engine) + (off ? 30 * route.normalized()[axis] : 0);
      }
    return poses;
  }

 private:
  [[nodiscard]] static MeasuredPoses empty(const Model& model) {
    MeasuredPoses poses;
    poses.file = "poses.csv";
    const Index markers = model.markers.size();
    for (Index m = 0; m < markers; ++m)
      for (int axis = 0; axis < 3; ++axis) {
        const std::string name = model.markers[m].name;
        poses.columns.push_back({name + "_" + std::string(1, "xyz"[axis]) + "_mm", m, axis});
      }
    for (const auto& [one, two] : {std::pair{0.0, 0.0}, std::pair{0.1, 0.0}, std::pair{0.2, 0.0}, std::pair{0.0, 0.1},
                                   std::pair{0.0, 0.2}, std::pair{0.1, 0.1}}) {
      Actuation command(2);
      command << one, two;
      poses.commands.push_back(command);
      poses.lines.push_back(poses.commands.size() + 1);
    }
    poses.values = Eigen::MatrixXd::Zero(6, 3 * markers);
    return poses;
  }

  testing::TemporaryFolder folder_;
};

/// Is what it does refused, and with these words?
template <class Act>
void expect_refused(const Act& act, const std::string& why) {
  try {
    act();
    ADD_FAILURE() << "not refused: " << why;
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
  }
}

}  // namespace softkin::calibration
