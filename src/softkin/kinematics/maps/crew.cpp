#include <algorithm>
#include <softkin/core/together.hpp>
#include <softkin/kinematics/maps/crew.hpp>

namespace softkin::maps {

bool Crew::each(Index count, const MapProgress& from, Index MapProgress::*counted,
                const std::function<bool(Index)>& work) {
  reported_ = from;
  stopped_ = false;
  std::atomic<Index> next = 0;
  work_together(std::min<int>(threads_, count), stopped_, [&] {
    const Index i = next++;
    if (i >= count) return false;
    bool goes_on = work(i);
    if (goes_on) {
      const std::lock_guard lock(mutex_);
      ++(reported_.*counted);
      goes_on = !progress_ || progress_(reported_);
    }
    if (!goes_on) stopped_ = true;
    return true;
  });
  return !stopped_;
}

std::optional<Sample> Crew::found(Index key, Index number, const Eigen::VectorXd& commands,
                                  const std::function<std::optional<Sample>()>& solve) {
  if (desk_) {
    const std::lock_guard lock(mutex_);
    if (std::optional<Sample> known = desk_->known(key, number, commands)) return known;
  }
  std::optional<Sample> made = solve();
  if (made && desk_) {
    const std::lock_guard lock(mutex_);
    desk_->keep(key, number, *made);
  }
  return made;
}

ProgressCallback Crew::patience() {
  return [this](const Progress&) {
    if (stopped_) return false;
    const std::lock_guard lock(mutex_);
    return !progress_ || progress_(reported_);
  };
}

}  // namespace softkin::maps
