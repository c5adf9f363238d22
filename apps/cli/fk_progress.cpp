#include "fk_progress.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace softkin::cli {

namespace {

constexpr double least_share = 0.02;  // of the work, before which the time left is not worth telling

}  // namespace

FkProgress::FkProgress(std::size_t first, std::size_t steps)
    : first_(first), steps_(steps), step_(first), start_(seconds_now()) {}

void FkProgress::begin_step(std::size_t step) {
  step_ = step;
  share_ = 0;
}

/// Moves shrink by about the same factor each iteration, so their logarithm tells how far the step is.
double FkProgress::share_of_moves(const Progress& p) const {
  const double gone = std::log(p.step_mm / first_move_) / std::log(p.tolerance_mm / first_move_);
  return std::isfinite(gone) ? std::clamp(gone, 0.0, 1.0) : 0;
}

void FkProgress::show(const Progress& p) {
  if (p.iteration == 1) first_move_ = p.step_mm;
  share_ = std::clamp(p.share < 0 ? share_of_moves(p) : p.share, share_, 1.0);
  const double done = static_cast<double>(step_ - first_) + share_, all = static_cast<double>(steps_ - first_);
  const double elapsed = seconds_now() - start_;
  std::string text = std::to_string(step_) + "/" + std::to_string(steps_) + " steps, " + duration(elapsed);
  if (done / all > least_share) text += ", " + duration(elapsed * (all - done) / done) + " left";
  text += ", iteration " + std::to_string(p.iteration) + ": " + number(p.step_mm, 2) + " mm";
  if (p.share >= 0) text += ", " + number(100 * p.share, 2) + " % of the way";
  line_.show((static_cast<double>(step_) + share_) / static_cast<double>(steps_), text);
}

}  // namespace softkin::cli
