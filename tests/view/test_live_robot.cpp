#include <gtest/gtest.h>

#include <condition_variable>

#include "served_robot.hpp"

namespace softkin::view {
namespace {

using runs::testing::bending_model;
using runs::testing::one_thread;

/// A robot whose answers are kept.
class Kept {
 public:
  explicit Kept(const Model& of, const StaticsOptions& options = one_thread())
      : model(of), statics(model), document(model, ""), robot_(statics, document, options, rest(), taker()) {}

  void ask(LiveRequest request) { robot_.ask(std::move(request)); }
  void command(RequestId id, const Eigen::VectorXd& commands) { ask({5, CommandRequest{id, commands}}); }

  /// The first answer to a request.
  LiveShape answer(RequestId id) {
    std::unique_lock<std::mutex> lock(mutex_);
    LiveShape found;
    const bool came = changed_.wait_for(lock, std::chrono::duration<double>(testing::patient(20)), [&] {
      for (const auto& each : answers_)
        if (each->shape.id == id) return found = each->shape, true;
      return false;
    });
    EXPECT_TRUE(came) << id;
    return found;
  }
  [[nodiscard]] std::vector<std::shared_ptr<const LiveAnswer>> answers() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return answers_;
  }
  [[nodiscard]] Equilibrium rest() const { return statics.solve(model.rest_actuation(), statics.rest(), one_thread()); }

  const Model& model;
  Statics statics;
  runs::PageDocument document;

 private:
  LiveRobot::Publish taker() {
    return [this](std::shared_ptr<const LiveAnswer> answer) {
      const std::lock_guard<std::mutex> lock(mutex_);
      answers_.push_back(std::move(answer));
      changed_.notify_all();
    };
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::shared_ptr<const LiveAnswer>> answers_;
  LiveRobot robot_;
};

/// The farthest that a vertex of the page is from where the positions have it [mm].
double distance(const runs::PageDocument& document, const std::vector<float>& numbers, const Points& positions) {
  double farthest = 0;
  for (std::size_t i = 0; i < document.vertices().size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      farthest = std::max(
          farthest, std::abs(static_cast<double>(numbers.at(3 * i + axis)) - positions(document.vertices()[i], axis)));
  return farthest;
}

TEST(LiveRobot, CommandsGiveTheEquilibriaOfStatics) {
  const Model model = bending_model();
  Kept kept(model);
  for (const auto& [id, air, tendon] :
       {std::tuple{RequestId{1}, 1.4, 0.97}, {RequestId{2}, 1.1, 1.1}, {RequestId{3}, 0.8, 1.0}}) {
    kept.command(id, Eigen::Vector2d(air, tendon));
    const LiveShape shape = kept.answer(id);
    const Statics own(model);
    const Equilibrium wanted = own.solve(Eigen::Vector2d(air, tendon), own.rest(), one_thread());
    ASSERT_EQ(wanted.report.status, Status::converged);
    EXPECT_EQ(shape.status, "converged");
    EXPECT_EQ(shape.commands, Eigen::Vector2d(air, tendon));
    EXPECT_LT(distance(kept.document, shape.numbers, wanted.state.positions), 2e-6);
    for (std::size_t a = 0; a < 2; ++a) EXPECT_NEAR(shape.loads.at(a).value(), wanted.state.multipliers[a], 1e-4);
    EXPECT_FALSE(shape.measures.at(0).has_value());  // a volume that is commanded
    EXPECT_NEAR(shape.measures.at(1).value(), achieved_ratio(model, model.actuators[1], wanted.state.positions), 1e-9);
    EXPECT_LT((shape.markers.at(1) - model.markers[1].point.at(wanted.state.positions)).norm(), 1e-6);
    // the fields are those of a page that is written
    ASSERT_EQ(shape.arrays, (std::vector<std::string>{"strain", "volume_ratio"}));
    const auto fields = kept.document.fields(own.measured(wanted.state));
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t v = 0; v < shape.vertices; ++v)
        EXPECT_NEAR(shape.numbers.at((3 + k) * shape.vertices + v), fields[k].values[v], 1e-6);
  }
  EXPECT_EQ(kept.answers().front()->shape.id, 0u);  // at rest
  EXPECT_EQ(kept.answers().front()->asker, 0u);
  EXPECT_EQ(kept.answers().back()->asker, 5u);
}

TEST(LiveRobot, TargetsAreReachedOrItSaysWhy) {
  const Model model = bending_model();
  Kept kept(model);
  const Statics own(model);
  const Eigen::Vector2d there(1.3, 0.95);
  const Vec3 tip = model.markers[0].point.at(own.solve(there, own.rest(), one_thread()).state.positions);
  const auto ask = [&](RequestId id, const Vec3& at) {
    kept.ask({1, TargetRequest{id, 0, at}});
    const LiveShape shape = kept.answer(id);
    EXPECT_EQ(shape.status, "converged");
    const TargetAnswer answer = shape.target.value();
    EXPECT_EQ(answer.at, at);
    EXPECT_NEAR(answer.error_mm, (shape.markers.at(0) - at).norm(), 1e-12);
    // what is shown is the equilibrium of its commands
    const Equilibrium wanted = own.solve(shape.commands, own.rest(), one_thread());
    EXPECT_LT(distance(kept.document, shape.numbers, wanted.state.positions), 1e-5);
    return answer;
  };
  // two actuators reach two of three coordinates, as the tip of a robot without a third has them
  const TargetAnswer reached = ask(1, tip);
  EXPECT_TRUE(reached.reached) << reached.why;
  EXPECT_LT(reached.error_mm, 1e-3);
  EXPECT_EQ(reached.why, "");
  const TargetAnswer missed = ask(2, tip + Vec3(30, 0, 0));
  EXPECT_FALSE(missed.reached);
  EXPECT_GT(missed.error_mm, 10);
  EXPECT_NE(missed.why.find("not reached: "), std::string::npos) << missed.why;
  EXPECT_NE(missed.why.find("air is at the high end of its range, 3 [-]"), std::string::npos) << missed.why;
}

TEST(LiveRobot, NewestRequestWins) {
  const Model model = bending_model();
  Kept kept(model);
  const auto at = [](RequestId id) { return Eigen::Vector2d(1 + 0.001 * static_cast<double>(id), 1); };
  for (RequestId id = 1; id <= 500; ++id) kept.command(id, at(id));
  const LiveShape last = kept.answer(500);
  EXPECT_EQ(last.commands, at(500));
  const Statics own(model);
  EXPECT_LT(distance(kept.document, last.numbers, own.solve(at(500), own.rest(), one_thread()).state.positions), 2e-6);
  EXPECT_LT(kept.answers().size(), 100u);
  EXPECT_EQ(kept.answers().back()->shape.id, 500u);
}

TEST(LiveRobot, SearchesEndWhenSomethingNewerIsAsked) {
  const Model model = bending_model();
  Kept kept(model);
  // that is searched for from several starts, in vain
  kept.ask({1, TargetRequest{1, 0, {100, 100, 100}}});
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  kept.command(2, Eigen::Vector2d(1.1, 1));
  EXPECT_EQ(kept.answer(2).commands, Eigen::Vector2d(1.1, 1));
  EXPECT_FALSE(kept.answer(2).target.has_value());
}

TEST(LiveRobot, StaysWhereItWasWhatDoesNotConverge) {
  const Model model = runs::testing::block_model(softkin::testing::loaded_scene(), 5);
  Kept kept(model);
  kept.command(1, Eigen::Vector2d(50, 0));
  const LiveShape before = kept.answer(1);
  EXPECT_EQ(before.status, "converged");
  kept.command(2, Eigen::Vector2d(3000, 0));  // more pressure than there is an equilibrium for
  const LiveShape beyond = kept.answer(2);
  EXPECT_EQ(beyond.status, "limit");
  EXPECT_EQ(beyond.remark.find("air reached "), 0u) << beyond.remark;
  EXPECT_NE(beyond.remark.find(" of 3000 kPa: the pressure of chamber 'air' has its maximum there"), std::string::npos)
      << beyond.remark;
  EXPECT_EQ(beyond.commands, Eigen::Vector2d(50, 0));
  EXPECT_EQ(beyond.numbers, before.numbers);
  kept.ask({1, CommandRequest{3, Eigen::Vector3d(1, 1, 1)}});  // which the reader would not let pass
  const LiveShape refused = kept.answer(3);
  EXPECT_EQ(refused.status, "not converged");
  EXPECT_NE(refused.remark.find("3"), std::string::npos) << refused.remark;
  EXPECT_EQ(refused.numbers, before.numbers);
  kept.command(4, Eigen::Vector2d(60, 0));
  EXPECT_EQ(kept.answer(4).status, "converged");
}

TEST(LiveRobot, EndsAmidASolve) {
  const Model model = bending_model();
  const Statics statics(model);
  const runs::PageDocument document(model, "");
  LiveRobot robot(statics, document, one_thread(), statics.solve(model.rest_actuation(), statics.rest(), one_thread()),
                  [](const auto&) {});
  robot.ask({1, TargetRequest{1, 0, {100, 100, 100}}});
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(robot.stop(testing::patient(5)));
}

}  // namespace
}  // namespace softkin::view
