#pragma once

#include <algorithm>
#include <exception>
#include <softkin/statics/physical/equilibria.hpp>

namespace softkin::physical {

/// A workspace, for the time of a solve.
class Equilibria::WorkspaceHandle {
 public:
  /// Takes a workspace that was left at the start, if there is one and it may be reused: its factor is as good as new.
  /// Else the workspace has no solved shape, and nothing in it is used.
  ///
  /// options  tuned constants for the time of the handle
  WorkspaceHandle(const Equilibria& owner, const Points& start, bool reuse, const SolverOptions& options)
      : owner_(owner) {
    {
      const std::lock_guard lock(owner_.mutex_);
      auto& idle = owner_.idle_;
      auto found = std::find_if(idle.begin(), idle.end(), [&](const auto& work) { return is_at(*work, start); });
      if (found == idle.end() && !idle.empty()) found = idle.end() - 1;
      if (found != idle.end()) {
        work_ = std::move(*found);
        idle.erase(found);
      }
    }
    if (!work_) work_ = std::make_unique<Workspace>(owner_.system_);
    work_->options = options;
    if (reuse && is_at(*work_, start)) return;
    work_->solved_shape.resize(0, 3);
    work_->tangents.at.resize(0, 3);
    work_->initial_guess.reset();
    work_->saddle.factor().forget();
    if (work_->contacts) work_->contacts->around = work_->contacts->before = {};  // the pairs of other shapes
  }
  /// Gives the workspace back, unless an exception has interrupted its use.
  ~WorkspaceHandle() {
    if (std::uncaught_exceptions() > exceptions_) return;
    const std::lock_guard lock(owner_.mutex_);
    owner_.idle_.push_back(std::move(work_));
  }
  WorkspaceHandle(const WorkspaceHandle&) = delete;
  WorkspaceHandle& operator=(const WorkspaceHandle&) = delete;
  [[nodiscard]] Workspace& work() { return *work_; }

 private:
  static bool is_at(const Workspace& work, const Points& shape) {
    return work.solved_shape.rows() == shape.rows() && work.solved_shape == shape;
  }

  const Equilibria& owner_;
  const int exceptions_ = std::uncaught_exceptions();
  std::unique_ptr<Workspace> work_;
};

/// A state in the form that the system takes. Without mixed elements it refers to the given one, which must outlive it.
class Equilibria::Inside {
 public:
  Inside(const Equilibria& owner, const State& at, Team& team) : at_(&at) {
    if (!owner.system_.pressures()) return;
    own_ = owner.inside(at, team);
    at_ = &own_;
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
  const State& operator*() const { return *at_; }
  const State* operator->() const { return at_; }

 private:
  State own_;
  const State* at_;
};

}  // namespace softkin::physical
