#include <algorithm>
#include <softkin/io/scene/scene.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/statics.hpp>

#include "statics/robots.hpp"

namespace softkin {

namespace {

namespace fs = std::filesystem;

/// Contact is physical, and materials without a shape ratio are, and robots of layers alone.
bool can_be_of_target_shapes(const fs::path& scene) {
  const RobotSpec spec = read_scene(scene);
  return !spec.contact && !spec.materials.empty() &&
         std::all_of(spec.materials.begin(), spec.materials.end(),
                     [](const MaterialSpec& material) { return material.shape_ratio.has_value(); });
}

std::vector<fs::path> scenes() {
  std::vector<fs::path> found;
  for (const auto& folder : fs::directory_iterator(fs::path(SOFTKIN_SOURCE_DIR) / "examples")) {
    if (!folder.is_directory()) continue;
    for (const auto& file : fs::directory_iterator(folder))
      if (file.path().extension() == ".yaml" && file.path().stem().extension() != ".hardware" &&
          can_be_of_target_shapes(file.path()))
        found.push_back(file.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

class NewtonExample : public ::testing::TestWithParam<fs::path> {
 protected:
  NewtonExample() : model_(compile(target_shape_scene())), statics_(model_) {}

  static RobotSpec target_shape_scene() {
    RobotSpec spec = read_scene(GetParam());
    spec.formulation = Formulation::target_shape;
    return spec;
  }

  /// One call from rest with the default options. Two inflated chambers side by side crush the third: there Algorithm 1
  /// ends with inverted elements too.
  Equilibrium expect_solved(const Actuation& actuation) {
    SCOPED_TRACE(actuation.transpose());
    const Equilibrium found = statics_.solve(actuation, statics_.rest());
    EXPECT_EQ(found.report.status, Status::converged) << found.report.remark;
    EXPECT_LE(found.report.continuation_steps, 4);  // one of the grippers takes 1 or 3, as rounding has it
    EXPECT_LE(found.report.iterations, 400);
    const ElementDeformation deformation = deformation_of(model_, found.state.positions);
    if (((actuation - model_.rest_actuation()).array() != 0).count() <= 1) {
      EXPECT_GT(*std::min_element(deformation.volume_ratio.begin(), deformation.volume_ratio.end()), 0);
    }
    return found;
  }

  const Model model_;
  const Statics statics_;
};

std::string test_name(const ::testing::TestParamInfo<fs::path>& scene) {
  std::string name = scene.param.parent_path().filename().string();
  if (scene.param.stem() != name) name += "_" + scene.param.stem().string();
  return name;
}

}  // namespace

TEST_P(NewtonExample, FromRestToEveryCornerOfTheRangesInOneCall) {
  const std::size_t count = model_.actuators.size();
  for (unsigned corner = 0; corner < 1u << count; ++corner) {
    Actuation actuation(count);
    for (std::size_t a = 0; a < count; ++a)
      actuation[a] = corner >> a & 1 ? model_.actuators[a].high : model_.actuators[a].low;
    expect_solved(actuation);
  }
}

TEST_P(NewtonExample, FromRestToValuesInside) {
  std::mt19937 engine(8);
  for (int round = 0; round < 4; ++round) {
    Actuation actuation = model_.rest_actuation();
    for (std::size_t a = 0; a < model_.actuators.size(); ++a)
      actuation[a] = std::uniform_real_distribution<double>(model_.actuators[a].low, model_.actuators[a].high)(engine);
    const Equilibrium found = expect_solved(actuation);
    if (round > 0) continue;
    StaticsOptions options;
    options.solver = Solver::local_global;
    options.step_tolerance_mm = 1e-8;  // its estimate of the error is only good near the end
    const Equilibrium slow = statics_.solve(actuation, statics_.rest(), options);
    EXPECT_EQ(slow.report.status, Status::converged);
    const double distance = (slow.state.positions - found.state.positions).rowwise().norm().maxCoeff();
    EXPECT_LT(distance, 10 * slow.report.estimated_error_mm);  // an estimate
  }
}

INSTANTIATE_TEST_SUITE_P(All, NewtonExample, ::testing::ValuesIn(scenes()), test_name);

}  // namespace softkin
