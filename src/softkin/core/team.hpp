#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <softkin/core/types.hpp>
#include <thread>
#include <vector>

namespace softkin {

/// Threads that all run `work`.
///
/// stop    called where not all can be started: makes `work` return
/// throws  InvalidInput where the machine does not let so many start; those that did have ended by then
[[nodiscard]] std::vector<std::thread> start_threads(int count, const std::function<void()>& work,
                                                     const std::function<void()>& stop);

/// Threads that work on one loop after another. Idle ones sleep, and a loop waits only for threads that have begun a
/// piece of it: a busy machine slows the team down only in proportion to the processors that it takes (OpenMP's
/// barriers, which wait for every thread, were five times slower there). Several threads may share a team of one.
class Team {
 public:
  /// threads >= 1, the caller's included; 0: as many as the machine has. Throws as start_threads, and target()
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  [[nodiscard]] int size() const { return static_cast<int>(workers_.size()) + 1; }

  /// body(i) once for every i in [0, count), on any thread, in any order. body must not throw.
  template <class Body>
  void each(Index count, const Body& body) {
    run(
        count, [](const void* b, Index i) { (*static_cast<const Body*>(b))(i); }, &body);
  }

  /// body(begin, end) on contiguous pieces that cover [0, count).
  template <class Body>
  void pieces(Index count, const Body& body) {
    // more pieces than threads: who is interrupted leaves the rest to the others
    const std::int64_t parts = size() == 1 ? 1 : std::min<std::int64_t>(count, 4 * size());
    each(parts,
         [&](Index i) { body(static_cast<Index>(count * i / parts), static_cast<Index>(count * (i + 1) / parts)); });
  }

 private:
  using Call = void (*)(const void*, Index);
  void end();
  void run(Index count, Call call, const void* body);
  void work();
  void take_pieces();

  std::vector<std::thread> workers_;
  Call call_ = nullptr;
  const void* body_ = nullptr;
  Index count_ = 0;
  std::atomic<Index> next_{0};
  std::atomic<std::uint32_t> loops_{0};  // started so far; workers sleep on it
  std::atomic<std::uint32_t> state_{0};  // bit 0: a loop is open; above: workers inside it
  std::atomic<bool> ended_{false};
};

/// Teams that sleep until somebody needs one: starting a thread costs more than a small robot's equilibrium.
class TeamPool {
 public:
  class GiveBack {
   public:
    explicit GiveBack(TeamPool* pool) : pool_(pool) {}
    void operator()(Team* team) const;

   private:
    TeamPool* pool_;
  };
  /// For one user at a time, as a Team is; goes back by itself, before the pool ends.
  using Lent = std::unique_ptr<Team, GiveBack>;

  /// A team of so many threads, >= 1; one is made where none is idle, so that there are as many as were ever lent at
  /// once. May be called on several threads at once. Throws as start_threads
  [[nodiscard]] Lent lend(int threads);

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Team>> idle_;
};

}  // namespace softkin
