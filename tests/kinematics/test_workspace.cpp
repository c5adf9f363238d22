#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <softkin/kinematics/workspace.hpp>
#include <softkin/statics/statics.hpp>

#include "statics/physical_samples.hpp"

namespace softkin {
namespace {

using testing::air;
using testing::bending_finger;
using testing::by_load;
using testing::cable_beam;

RobotSpec two_ranged_cables(Formulation formulation = Formulation::physical) {
  RobotSpec spec = cable_beam();
  spec.formulation = formulation;
  for (ActuatorSpec& actuator : spec.actuators) {
    actuator.low = 0.8;
    actuator.high = 1;
  }
  if (formulation == Formulation::target_shape) spec.materials[0].shape_ratio = 0.8;
  return spec;
}

struct PlannedRobot {
  Model model;
  Statics statics;
  WorkspacePlan plan;

  PlannedRobot(const RobotSpec& spec, Sampling kind, Index samples)
      : model(compile(spec)), statics(model), plan(plan_workspace(model, {kind, samples, 3})) {}
};

/// Keeps samples in memory.
class GroupMemory : public GroupDesk {
 public:
  explicit GroupMemory(const WorkspacePlan& plan, std::map<Index, WorkspaceSample> before = {})
      : samples(std::move(before)), plan_(plan) {}

  std::optional<GroupTask> take() override {
    const std::lock_guard lock(mutex_);
    if (next_ == plan_.groups.size()) return std::nullopt;
    GroupTask task{static_cast<Index>(next_), {}};
    for (const Index number : plan_.groups[next_]) {
      const auto found = samples.find(number);
      task.known.push_back(found == samples.end() ? std::nullopt : std::optional(found->second.status));
    }
    ++next_;
    return task;
  }

  void keep(const WorkspaceSample& sample) override {
    const std::lock_guard lock(mutex_);
    EXPECT_TRUE(samples.emplace(sample.number, sample).second) << "sample " << sample.number << " came twice";
  }

  std::map<Index, WorkspaceSample> samples;

 private:
  const WorkspacePlan& plan_;
  std::mutex mutex_;
  std::size_t next_ = 0;
};

std::map<Index, WorkspaceSample> solved(const PlannedRobot& robot, int threads,
                                        std::map<Index, WorkspaceSample> before = {}) {
  GroupMemory desk(robot.plan, std::move(before));
  solve_groups(robot.statics, robot.plan, {}, threads, desk);
  return desk.samples;
}

/// To the last bit.
void expect_same(const std::map<Index, WorkspaceSample>& a, const std::map<Index, WorkspaceSample>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [number, sample] : a) {
    const WorkspaceSample& other = b.at(number);
    EXPECT_EQ(sample.status, other.status) << number;
    EXPECT_EQ(sample.iterations, other.iterations) << number;
    EXPECT_EQ(sample.markers, other.markers) << number;
    EXPECT_EQ(sample.multipliers, other.multipliers) << number;
  }
}

void expect_those_from_rest(const PlannedRobot& robot, const std::map<Index, WorkspaceSample>& samples) {
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(robot.plan.samples()));
  for (const auto& [number, sample] : samples) {
    const Actuation actuation = robot.plan.actuations.row(number);
    EXPECT_EQ(sample.actuation, actuation);
    const Equilibrium cold = robot.statics.solve(actuation, robot.statics.rest());
    ASSERT_EQ(cold.report.status, Status::converged);
    ASSERT_EQ(sample.status, Status::converged) << number;
    EXPECT_LE((sample.markers.row(0).transpose() - testing::marker_at(robot.model, cold)).norm(), 1e-4) << number;
    EXPECT_LE((sample.multipliers - cold.state.multipliers).norm(), 1e-4 * (1 + cold.state.multipliers.norm()));
  }
}

TEST(Workspace, EverySampleIsInOneGroupThatBeginsNearItsMiddle) {
  const PlannedRobot robot(two_ranged_cables(), Sampling::sobol, 900);
  std::set<Index> seen;
  for (const auto& group : robot.plan.groups) {
    EXPECT_LE(static_cast<Index>(group.size()), group_size(900));
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(2);
    for (const Index number : group) {
      EXPECT_TRUE(seen.insert(number).second);
      mean += robot.plan.actuations.row(number) / static_cast<double>(group.size());
    }
    for (const Index number : group)
      EXPECT_LE((robot.plan.actuations.row(group[0]) - mean).norm(),
                (robot.plan.actuations.row(number) - mean).norm() + 1e-12);
  }
  EXPECT_EQ(seen.size(), 900u);
}

TEST(Workspace, SamplesAreTheEquilibriaThatAreFoundFromRest) {
  const PlannedRobot robot(two_ranged_cables(), Sampling::grid, 25);
  expect_those_from_rest(robot, solved(robot, 1));
}

TEST(Workspace, SamplesOfTargetShapesAreThoseFromRestToo) {
  const PlannedRobot robot(two_ranged_cables(Formulation::target_shape), Sampling::random, 20);
  expect_those_from_rest(robot, solved(robot, 2));
}

TEST(Workspace, IsTheSameOnAnyNumberOfThreads) {
  const PlannedRobot robot(two_ranged_cables(), Sampling::sobol, 40);
  const auto alone = solved(robot, 1);
  ASSERT_EQ(alone.size(), 40u);
  expect_same(alone, solved(robot, 3));
}

TEST(Workspace, IsTheSameWhateverHasBeenDoneBefore) {
  const PlannedRobot robot(two_ranged_cables(), Sampling::random, 24);
  const auto whole = solved(robot, 1);
  for (const int keep_every : {2, 3, 7}) {
    std::map<Index, WorkspaceSample> some;
    for (const auto& [number, sample] : whole)
      if (number % keep_every == 0) some.emplace(number, sample);
    expect_same(whole, solved(robot, 2, some));
  }
}

TEST(Workspace, OfAnotherObjectIsTheSame) {
  const PlannedRobot first(two_ranged_cables(), Sampling::random, 16),
      second(two_ranged_cables(), Sampling::random, 16);
  const auto before = solved(first, 1);
  (void)second.statics.solve(second.plan.actuations.row(3), second.statics.rest());
  expect_same(before, solved(second, 1));
}

TEST(Workspace, SamplesWithoutAnEquilibriumAreTold) {
  RobotSpec spec = bending_finger();
  spec.actuators = {by_load(air("chamber"), 0, 4000)};
  const PlannedRobot robot(spec, Sampling::grid, 3);
  const auto samples = solved(robot, 1);
  ASSERT_EQ(samples.size(), 3u);
  int missing = 0;
  for (const auto& [number, sample] : samples) {
    const Equilibrium cold = robot.statics.solve(robot.plan.actuations.row(number), robot.statics.rest());
    if (cold.report.status == Status::converged) {
      EXPECT_EQ(sample.status, Status::converged) << number;
      continue;
    }
    if (sample.status == Status::converged) continue;  // along another path
    ++missing;
    ASSERT_EQ(sample.status, Status::limit);
    ASSERT_GT(sample.reached, 0);
    EXPECT_LT(sample.reached, 1);
    const Equilibrium good =
        robot.statics.solve(sample.reached * robot.plan.actuations.row(number), robot.statics.rest());
    EXPECT_EQ(good.report.status, Status::converged);
    EXPECT_LT((testing::marker_at(robot.model, good) - sample.markers.row(0).transpose()).norm(), 0.01);
    EXPECT_NEAR(sample.multipliers[0], sample.reached * sample.actuation[0], 1e-9 * sample.actuation[0]);
  }
  EXPECT_GT(missing, 0);
  EXPECT_EQ(samples.at(0).status, Status::converged);
  expect_same(samples, solved(robot, 2));
}

TEST(Workspace, StopsWhereProgressSaysSoAndKeepsWhatIsDone) {
  const PlannedRobot robot(two_ranged_cables(), Sampling::grid, 16);
  const auto whole = solved(robot, 1);
  GroupMemory desk(robot.plan);
  const auto go_on = [&](const Progress&) { return desk.samples.size() < 5; };
  solve_groups(robot.statics, robot.plan, {}, 1, desk, go_on);
  EXPECT_GE(desk.samples.size(), 5u);
  EXPECT_LT(desk.samples.size(), 16u);
  expect_same(whole, solved(robot, 1, desk.samples));
}

TEST(Workspace, FailuresOfTheDeskComeThrough) {
  struct Full : GroupMemory {
    using GroupMemory::GroupMemory;
    void keep(const WorkspaceSample&) override { throw std::runtime_error("full"); }
  };
  const PlannedRobot robot(two_ranged_cables(), Sampling::grid, 16);
  Full desk(robot.plan);
  EXPECT_THROW(solve_groups(robot.statics, robot.plan, {}, 2, desk), std::runtime_error);
}

TEST(Neighbourhood, PredictsToFirstOrder) {
  const PlannedRobot robot(two_ranged_cables(), Sampling::grid, 4);
  const Actuation centre = testing::values({0.9, 0.98}), change = testing::values({0.01, -0.004});
  const Equilibrium at = testing::solve_converged(robot.statics, centre);
  Neighbourhood around(robot.statics, at.state);
  const auto error = [&](double size) {
    const Actuation there = centre + size * change;
    const State predicted = around.predict(there);
    EXPECT_EQ(predicted.actuation, there);
    return testing::distance(predicted.positions, testing::solve_converged(robot.statics, there).state.positions);
  };
  const double whole = error(1), half = error(0.5), quarter = error(0.25);
  EXPECT_NEAR(whole / half, 4, 0.8);
  EXPECT_NEAR(half / quarter, 4, 0.8);
  EXPECT_LE(error(0), 1e-9);
}

}  // namespace
}  // namespace softkin
