#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/runs/page_document.hpp>
#include <softkin/statics/statics.hpp>
#include <thread>
#include <variant>

#include "live_estimate.hpp"
#include "live_messages.hpp"

namespace softkin::view {

/// A request to the robot.
struct LiveRequest {
  std::uint64_t asker = 0;  // who has control and gets the answer
  std::variant<CommandRequest, TargetRequest, ReadingsRequest> what;
};

/// A shape, and for whom it was solved.
struct LiveAnswer {
  std::uint64_t asker = 0;
  LiveShape shape;
};

/// What the solver found, as the page shows it; none where it is not finite.
///
/// page  of the same model
[[nodiscard]] std::optional<LiveShape> live_shape(const Statics& statics, const runs::PageDocument& page,
                                                  const Equilibrium& found);

/// A robot that deforms interactively: a thread solves the newest request, each from the last equilibrium.
///
/// A newer request ends a search for a target, and an equilibrium that takes longer than 0.3 s; neither is answered
/// then. A solve that does not converge is answered with the last shape that did. A target out of reach is answered at
/// once from the last shape, and again where another start then finds a better one. An estimate from readings is always
/// completed, so that a stream that is faster than the solver is answered, too.
class LiveRobot {
 public:
  /// Called by the robot's thread for every answer.
  using Publish = std::function<void(std::shared_ptr<const LiveAnswer>)>;

  /// All must outlive the object. rest: the equilibrium to begin from; page: of the same model; estimator: estimates
  /// from readings; null: readings are answered by an error
  LiveRobot(const Statics& statics, const runs::PageDocument& page, const StaticsOptions& options, Equilibrium rest,
            Publish publish, LiveEstimator* estimator = nullptr);
  ~LiveRobot();
  LiveRobot(const LiveRobot&) = delete;
  LiveRobot& operator=(const LiveRobot&) = delete;

  /// Replaces a request that has not begun. May be called on any thread.
  void ask(LiveRequest request);

  /// Ends the answers. false: the solver has not ended within these seconds, and the object cannot be destroyed before
  /// it does.
  bool stop(double seconds);

 private:
  void work();
  void answer(const LiveRequest& request);
  void solve(const CommandRequest& request, std::uint64_t asker);
  void search(const TargetRequest& request, std::uint64_t asker);
  void send(const ReadingsRequest& request, std::uint64_t asker);
  [[nodiscard]] InverseResult searched(const std::vector<Goal>& goals, int other_starts) const;
  [[nodiscard]] ProgressCallback patience(double seconds) const;
  [[nodiscard]] bool has_newer() const;
  [[nodiscard]] bool is_stopped() const;
  void stand(Equilibrium found, LiveShape shape);
  void say(std::uint64_t asker, LiveShape shape) const;

  const Model& model_;
  const Statics& statics_;
  const runs::PageDocument& page_;
  StaticsOptions options_;
  Publish publish_;
  LiveEstimator* estimator_;

  // of the thread alone
  Equilibrium last_;                        // converged
  std::optional<Sensitivity> sensitivity_;  // of it
  LiveShape shape_;                         // of it

  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::optional<LiveRequest> next_;
  bool stopped_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace softkin::view
