#include "run_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/text.hpp>
#include <softkin/runs/records.hpp>
#include <utility>

#include "command.hpp"

namespace softkin::cli {

namespace {

std::string percent(double fraction) {
  return decimal(100 * fraction, 1) + " %";
}

}  // namespace

std::string resumed_text(std::size_t done, std::size_t all, const std::string& what) {
  if (done == 0) return "nothing to resume: starting with " + what + " 0";
  return std::to_string(done) + " of " + counted(all, what) +
         (done < all ? " were done before: going on" : " were done before: nothing is left");
}

int report_stopped(const Stopped& stopped) {
  std::string text = why_stopped();
  if (stopped.all > 1) text += " after " + std::to_string(stopped.done) + " of " + counted(stopped.all, stopped.what);
  if (stopped.done > 0 && !stopped.where.empty()) text += "; they are in " + stopped.where;
  if (stopped.done > 0 && stopped.resumes) text += ", the same command with --resume continues";
  if (stopped.record) {
    const StepRecord& record = *stopped.record;
    const std::string where = stopped.all > 1 ? " of the path to the next" : " of the path";
    if (record.reached_fraction) text += "; at " + percent(*record.reached_fraction) + where;
    if (!stopped.shape.empty()) text += "; the last good shape is in " + stopped.shape + ", --start continues from it";
  }
  std::fprintf(stderr, "softkin: %s\n", text.c_str());
  return not_converged;
}

RunProgress::RunProgress(std::size_t first, std::size_t all, std::string what)
    : first_(first), all_(all), at_(first), what_(std::move(what)), start_(seconds_now()) {}

void RunProgress::begin(std::size_t record) {
  at_ = record;
  fraction_ = 0;
}

void RunProgress::show(const std::string& detail, double fraction) {
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  const double done = static_cast<double>(at_ - first_) + fraction_, all = static_cast<double>(all_ - first_);
  const double elapsed = seconds_now() - start_;
  std::string text = std::to_string(at_) + "/" + std::to_string(all_) + " " + what_ + "s, " + duration(elapsed);
  if (const auto left = left_.at(elapsed, done / all)) text += ", " + duration(*left) + " left";
  line_.show((static_cast<double>(at_) + fraction_) / static_cast<double>(all_), text + ", " + detail);
}

/// Before the first equilibrium on the path, progress is estimated from the step lengths: they shrink by about the same
/// factor in each iteration, so that their logarithm measures the progress of a step that converges at once, as most
/// do.
double EquilibriumProgress::fraction(const Progress& p) {
  if (p.iteration == 1) {
    first_move_ = p.step_mm;
    guess_ = 0;
  }
  if (p.fraction > 0) return p.fraction;
  const double gone = std::log(p.step_mm / first_move_) / std::log(p.tolerance_mm / first_move_);
  if (std::isfinite(gone)) guess_ = std::clamp(gone, guess_, 1.0);
  return guess_;
}

std::string EquilibriumProgress::text(const Progress& p) {
  std::string text = "iteration " + std::to_string(p.iteration) + ": " + number(p.step_mm, 2) + " mm";
  if (p.fraction >= 0) text += ", " + number(100 * p.fraction, 2) + " % of the path";
  return text;
}

std::string findings_text(const Model& model, const StepRecord& step) {
  std::string text;
  for (const runs::FindingLine& line : runs::finding_lines(model, step, "--stable"))
    text += (text.empty() ? "" : "\n") + line.text;
  return text;
}

std::string unstable_text(const std::string& what, const std::vector<std::size_t>& numbers) {
  return "warning: the equilibrium of " + what + (numbers.size() == 1 ? " " : "s ") + list_text(numbers) +
         " is unstable: the robot would buckle or snap away from it; --stable looks for the shape that it goes to";
}

}  // namespace softkin::cli
