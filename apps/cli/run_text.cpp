#include "run_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "command.hpp"

namespace softkin::cli {

namespace {

constexpr double least_share = 0.02;  // of the work, before which the time left is not worth telling

}  // namespace

std::string resumed_text(std::size_t done, std::size_t all, const std::string& what) {
  if (done == 0) return "nothing to resume: starting with " + what + " 0";
  return std::to_string(done) + " of " + counted(all, what) +
         (done < all ? " were done before: going on" : " were done before: nothing is left");
}

int tell_stopped(std::size_t done, std::size_t all, const std::string& what, const std::string& where, bool goes_on) {
  std::string text = "interrupted";
  if (done == 0) {
    text += "; nothing was finished";
  } else {
    text += " after " + std::to_string(done) + " of " + counted(all, what);
    if (!where.empty()) text += "; they are in " + where;
    if (goes_on) text += ", the same command with --resume goes on";
  }
  std::fprintf(stderr, "softkin: %s\n", text.c_str());
  return not_converged;
}

RunProgress::RunProgress(std::size_t first, std::size_t all, std::string what)
    : first_(first), all_(all), at_(first), what_(std::move(what)), start_(seconds_now()) {}

void RunProgress::begin(std::size_t record) {
  at_ = record;
  share_ = 0;
}

void RunProgress::show(const std::string& detail, double share) {
  share_ = std::clamp(share, share_, 1.0);
  const double done = static_cast<double>(at_ - first_) + share_, all = static_cast<double>(all_ - first_);
  const double elapsed = seconds_now() - start_;
  std::string text = std::to_string(at_) + "/" + std::to_string(all_) + " " + what_ + "s, " + duration(elapsed);
  if (done / all > least_share) text += ", " + duration(elapsed * (all - done) / done) + " left";
  line_.show((static_cast<double>(at_) + share_) / static_cast<double>(all_), text + ", " + detail);
}

/// Moves shrink by about the same factor each iteration, so their logarithm tells how far the step is.
double EquilibriumProgress::share(const Progress& p) {
  if (p.iteration == 1) first_move_ = p.step_mm;
  if (p.share >= 0) return p.share;
  const double gone = std::log(p.step_mm / first_move_) / std::log(p.tolerance_mm / first_move_);
  return std::isfinite(gone) ? std::clamp(gone, 0.0, 1.0) : 0;
}

std::string EquilibriumProgress::text(const Progress& p) {
  std::string text = "iteration " + std::to_string(p.iteration) + ": " + number(p.step_mm, 2) + " mm";
  if (p.share >= 0) text += ", " + number(100 * p.share, 2) + " % of the way";
  return text;
}

}  // namespace softkin::cli
