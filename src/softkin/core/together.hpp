#pragma once

#include <atomic>
#include <functional>

namespace softkin {

/// So many threads, the caller's included, each run `step` again and again until it returns false or `stopped` is set.
/// What a step throws sets it, too, and is thrown again when all have ended.
///
/// throws  as start_threads
void work_together(int threads, std::atomic<bool>& stopped, const std::function<bool()>& step);

}  // namespace softkin
