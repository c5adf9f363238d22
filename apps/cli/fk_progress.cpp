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

void FkProgress::show(const Progress& p) {
  if (p.iteration == 1) first_move_ = p.step_mm;
  // moves shrink by about the same factor each iteration, so their logarithm tells how far the step is
  const double gone = std::log(p.step_mm / first_move_) / std::log(p.tolerance_mm / first_move_);
  if (std::isfinite(gone)) share_ = std::clamp(gone, share_, 1.0);
  const double done = static_cast<double>(step_ - first_) + share_, all = static_cast<double>(steps_ - first_);
  const double elapsed = seconds_now() - start_;
  std::string text = std::to_string(step_) + "/" + std::to_string(steps_) + " steps, " + duration(elapsed);
  if (done / all > least_share) text += ", " + duration(elapsed * (all - done) / done) + " left";
  text += ", iteration " + std::to_string(p.iteration) + ": " + number(p.step_mm, 2) + " mm";
  line_.show((static_cast<double>(step_) + share_) / static_cast<double>(steps_), text);
}

}  // namespace softkin::cli
