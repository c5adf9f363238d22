#include <softkin/core/error.hpp>
#include <softkin/core/target.hpp>
#include <softkin/core/team.hpp>
#include <system_error>

namespace softkin {

namespace {

/// Some microseconds: shorter than falling asleep and waking, long enough for the gap between two loops.
constexpr int spins = 1000;

void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Returns once value differs from old.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  for (int i = 0; i < spins; ++i) {
    const std::uint32_t now = value.load(std::memory_order_acquire);
    if (now != old) return now;
    pause();
  }
  value.wait(old, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

}  // namespace

std::vector<std::thread> start_threads(int count, const std::function<void()>& work,
                                       const std::function<void()>& stop) {
  std::vector<std::thread> threads;
  const auto give_up = [&](const std::string& why) {
    stop();
    for (std::thread& thread : threads) thread.join();
    throw InvalidInput("only " + std::to_string(threads.size()) + " of " + std::to_string(count) +
                       " more threads could be started (" + why + "): ask for fewer threads");
  };
  try {
    threads.reserve(count);
    for (int i = 0; i < count; ++i) threads.emplace_back(work);
  } catch (const std::system_error& error) {
    give_up(error.code().message());
  } catch (const std::bad_alloc&) {
    give_up("out of memory");
  }
  return threads;
}

Team::Team(int threads) {
  // chosen, or refused, before a loop calls a kernel: what is thrown there ends the program
  static_cast<void>(target());
  const int size = threads > 0 ? threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  workers_ = start_threads(
      size - 1, [this] { work(); }, [this] { end(); });
}

void Team::end() {
  ended_.store(true);
  loops_.fetch_add(1, std::memory_order_release);
  loops_.notify_all();
}

Team::~Team() {
  end();
  for (std::thread& worker : workers_) worker.join();
}

void Team::run(Index count, Call call, const void* body) {
  if (workers_.empty() || count < 2) {  // uses no state of the team: threads may share one without helpers
    for (Index i = 0; i < count; ++i) call(body, i);
    return;
  }
  call_ = call;
  body_ = body;
  count_ = count;
  next_.store(0, std::memory_order_relaxed);
  state_.store(1, std::memory_order_release);
  loops_.fetch_add(1, std::memory_order_release);
  loops_.notify_all();
  take_pieces();
  // closed: workers that are still asleep stay out
  std::uint32_t state = state_.fetch_and(~1u, std::memory_order_acq_rel) & ~1u;
  while (state != 0) state = wait_for_change(state_, state);
}

void Team::take_pieces() {
  for (Index i = next_.fetch_add(1, std::memory_order_relaxed); i < count_;
       i = next_.fetch_add(1, std::memory_order_relaxed))
    call_(body_, i);
}

void Team::work() {
  std::uint32_t seen = 0;
  while (true) {
    seen = wait_for_change(loops_, seen);
    if (ended_.load()) return;
    std::uint32_t state = state_.load(std::memory_order_acquire);
    while (state & 1u) {
      if (!state_.compare_exchange_weak(state, state + 2, std::memory_order_acq_rel)) continue;
      take_pieces();
      state_.fetch_sub(2, std::memory_order_acq_rel);
      state_.notify_all();
      break;
    }
  }
}

TeamPool::Lent TeamPool::lend(int threads) {
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(idle_.begin(), idle_.end(), [threads](const auto& team) { return team->size() == threads; });
    if (found != idle_.end()) {
      Lent lent(found->release(), GiveBack(this));
      idle_.erase(found);
      return lent;
    }
  }
  return Lent(new Team(threads), GiveBack(this));
}

void TeamPool::GiveBack::operator()(Team* team) const {
  const std::lock_guard lock(pool_->mutex_);
  pool_->idle_.emplace_back(team);
}

}  // namespace softkin
