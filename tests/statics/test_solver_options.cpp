#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <set>
#include <softkin/core/error.hpp>
#include <sstream>

#include "statics/physical_samples.hpp"

namespace softkin {

namespace {

using namespace testing;

std::string refusal_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST(SolverOptions, EachHasADescriptionAndAnAdmissibleDefault) {
  std::set<std::string> names;
  for (const OptionValue& option : list_options()) {
    const std::string name = option.group + "." + option.field.name;
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(option.value, option.standard) << name;
    const std::string sentence = option.field.sentence;
    EXPECT_GT(sentence.size(), 15u) << name;
    EXPECT_TRUE(std::isupper(sentence.front()) && sentence.ends_with(".")) << name;
    EXPECT_NE(std::string(option.field.unit), "") << name;
  }
  EXPECT_GT(names.size(), 200u);
  EXPECT_NO_THROW(check_options({}));
}

TEST(SolverOptions, AreSetByNameAndListedWhereTheyDiffer) {
  for (const OptionValue& option : list_options()) {
    SolverOptions options;
    const double other = option.field.range == OptionRange::count ? option.standard + 1 : 0.75 * option.standard + 0.25;
    set_option(options, option.group, option.field.name, other == option.standard ? 0.5 : other);
    EXPECT_NE(options, SolverOptions{}) << option.field.name;
    const std::vector<OptionValue> changed = changed_options(options);
    ASSERT_EQ(changed.size(), 1u) << option.field.name;
    EXPECT_EQ(changed[0].group, option.group);
    EXPECT_EQ(std::string(changed[0].field.name), option.field.name);
    EXPECT_EQ(changed[0].standard, option.standard);
  }
  SolverOptions options;
  EXPECT_EQ(changes_text(options), "");
  set_option(options, "step", "max_turn", 20);
  set_option(options, "newton", "max_iterations", 40);
  EXPECT_EQ(options.path.step.max_turn, 20);
  EXPECT_EQ(options.newton.convergence.max_iterations, 40);
  EXPECT_EQ(changes_text(options), "step.max_turn = 20, newton.max_iterations = 40");
}

TEST(SolverOptions, RefuseUnknownNamesAndInadmissibleValues) {
  SolverOptions options;
  EXPECT_TRUE(contains(refusal_of([&] { set_option(options, "stpe", "max_turn", 1); }), "did you mean 'step'?"));
  EXPECT_TRUE(contains(refusal_of([&] { set_option(options, "step", "max_trun", 1); }), "did you mean 'max_turn'?"));
  EXPECT_TRUE(contains(refusal_of([&] { set_option(options, "step", "shortening", 1); }),
                       "the option step.shortening must be between 0 and 1, not 1"));
  EXPECT_TRUE(contains(refusal_of([&] { set_option(options, "newton", "max_iterations", 2.5); }),
                       "a whole number of at least 1, not 2.5"));
  EXPECT_TRUE(contains(refusal_of([&] { set_option(options, "measure", "growth", 1); }), "above 1"));
  EXPECT_TRUE(contains(refusal_of([&] { set_option(options, "beyond_turn", "min_load_factor", NAN); }), "finite"));
  EXPECT_EQ(options, SolverOptions{});

  const Model model = compile(cable_beam());
  const Statics statics(model);
  StaticsOptions wrong;
  wrong.tuning.newton.regularisation.shift_growth = 1;  // no shift would ever be large enough
  EXPECT_THROW((void)statics.solve(model.rest_actuation(), statics.rest(), wrong), InvalidInput);
}

TEST(SolverOptions, ReachThePhysicalSolver) {
  const Model model = compile(cable_beam());
  const Statics statics(model);
  const Actuation bent = values({0.85, 1.2});
  StaticsOptions few = tight();
  few.reuse_factor = false;
  const Equilibrium usual = solve_converged(statics, bent, few);
  few.tuning.newton.factor.max_updates = 1;  // a new factor every second step
  const Equilibrium other = solve_converged(statics, bent, few);
  EXPECT_GT(other.report.factorisations, usual.report.factorisations);
  EXPECT_LT(largest_move(other.state.positions, usual.state.positions), 1e-6);
}

/// A shallow arch near its limit load takes several steps; shorter ones after a failed step are more.
TEST(SolverOptions, ReachThePathTracker) {
  RobotSpec spec = physical_robot(block_mesh({20, 1, 1}, {100, 10, 2}));
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
    spec.mesh.vertices(v, 2) += 6 * std::sin(EIGEN_PI * spec.mesh.vertices(v, 0) / 100);
  spec.mesh_options.quadratic = true;
  spec.fixed.push_back({{std::string("x_high"), {}}});
  spec.loads.forces = {{"weight", {Vec3(50, 5, 7), {}}, {0, 0, -0.0095}}};
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  const Equilibrium usual = solve_converged(statics, {}, options);
  EXPECT_GT(usual.report.continuation_steps, 1);
  options.tuning.path.step.shortening = 0.05;
  const Equilibrium shorter = solve_converged(statics, {}, options);
  EXPECT_GT(shorter.report.continuation_steps, usual.report.continuation_steps);
  EXPECT_LT(largest_move(shorter.state.positions, usual.state.positions), 1e-3);
}

TEST(SolverOptions, ReachTheTargetShapeSolver) {
  const Model model = compile(finger_robot(true));
  const Statics statics(model);
  const Actuation bent = Actuation::Constant(static_cast<Index>(model.actuators.size()), 1.2);
  StaticsOptions options;
  const Equilibrium usual = solve_converged(statics, bent, options);
  options.tuning.target_shape.max_steps = 1;  // so that it goes through intermediate equilibria
  const Equilibrium other = solve_converged(statics, bent, options);
  EXPECT_GT(other.report.iterations, usual.report.iterations);
  EXPECT_LT(largest_move(other.state.positions, usual.state.positions), 1e-3);
}

/// `scripts/option_tables.py` writes them.
TEST(SolverOptions, TablesOfTheDocumentAreUpToDate) {
  std::ostringstream text;
  text << std::ifstream(std::string(SOFTKIN_SOURCE_DIR) + "/docs/path_tracking.md").rdbuf();
  const std::string page = text.str(), begin = "<!-- options -->\n\n", end = "<!-- end of options -->\n";
  const std::size_t from = page.find(begin), to = page.find(end);
  ASSERT_NE(from, std::string::npos);
  ASSERT_NE(to, std::string::npos);
  EXPECT_EQ(page.substr(from + begin.size(), to - from - begin.size()), option_tables());
}

}  // namespace softkin
