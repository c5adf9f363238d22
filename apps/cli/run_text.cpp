#include "run_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/finding_text.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/shortfall_text.hpp>
#include <utility>

#include "command.hpp"

namespace softkin::cli {

namespace {

std::string grouped(std::size_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

std::string percent(double share) {
  return decimal(100 * share, 1) + " %";
}

/// The materials' laws, each once.
std::string laws(const Model& model) {
  std::vector<std::string> names;
  for (const Material& material : model.materials) {
    const std::string name = law_name(material.elastic.law);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string command_range(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  return std::string(command_name(actuator)) + " " + number(actuator.low) + " to " + number(actuator.high) + " " +
         (unit.empty() ? "[-]" : unit);
}

const char* unit_of_measure(const Actuator& actuator) {
  return actuator.kind == ActuatorKind::cable ? "mm" : actuator.kind == ActuatorKind::dea ? "mm^2" : "mm^3";
}

}  // namespace

std::string resumed_text(std::size_t done, std::size_t all, const std::string& what) {
  if (done == 0) return "nothing to resume: starting with " + what + " 0";
  return std::to_string(done) + " of " + counted(all, what) +
         (done < all ? " were done before: going on" : " were done before: nothing is left");
}

int tell_stopped(const Stopped& stopped) {
  std::string text = why_stopped();
  if (stopped.all > 1) text += " after " + std::to_string(stopped.done) + " of " + counted(stopped.all, stopped.what);
  if (stopped.done > 0 && !stopped.where.empty()) text += "; they are in " + stopped.where;
  if (stopped.done > 0 && stopped.resumes) text += ", the same command with --resume goes on";
  if (stopped.record) {
    const StepRecord& record = *stopped.record;
    const std::string where = stopped.all > 1 ? " of the way to the next" : " of the way";
    if (record.reached_share) text += "; at " + percent(*record.reached_share) + where;
    if (!stopped.shape.empty()) text += "; the last good shape is in " + stopped.shape + ", --start goes on from it";
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
  share_ = std::clamp(share, 0.0, 1.0);
  const double done = static_cast<double>(at_ - first_) + share_, all = static_cast<double>(all_ - first_);
  const double elapsed = seconds_now() - start_;
  std::string text = std::to_string(at_) + "/" + std::to_string(all_) + " " + what_ + "s, " + duration(elapsed);
  if (const auto left = left_.at(elapsed, done / all)) text += ", " + duration(*left) + " left";
  line_.show((static_cast<double>(at_) + share_) / static_cast<double>(all_), text + ", " + detail);
}

/// Before the first equilibrium on the way moves tell: they shrink by about the same factor each iteration, so that
/// their logarithm tells how far a step is that leads there at once, as most do.
double EquilibriumProgress::share(const Progress& p) {
  if (p.iteration == 1) {
    first_move_ = p.step_mm;
    guess_ = 0;
  }
  if (p.share > 0) return p.share;
  const double gone = std::log(p.step_mm / first_move_) / std::log(p.tolerance_mm / first_move_);
  if (std::isfinite(gone)) guess_ = std::clamp(gone, guess_, 1.0);
  return guess_;
}

std::string EquilibriumProgress::text(const Progress& p) {
  std::string text = "iteration " + std::to_string(p.iteration) + ": " + number(p.step_mm, 2) + " mm";
  if (p.share >= 0) text += ", " + number(100 * p.share, 2) + " % of the way";
  return text;
}

std::string summary(const Model& model, const std::string& solver) {
  std::string text = grouped(static_cast<std::size_t>(model.robot_vertices())) + " vertices";
  if (!model.tetrahedra.empty())
    text += ", " + grouped(model.tetrahedra.size()) + " tetrahedra of order " + (model.edge_nodes.empty() ? "1" : "2");
  if (!model.prisms.empty()) text += ", " + grouped(model.prisms.size()) + " prisms";
  text += std::string("; ") + formulation_name(model.formulation) + " formulation";
  if (model.formulation == Formulation::physical) text += " (" + laws(model) + ")";
  if (model.weights != ElementWeights::printed) text += std::string(" (weights ") + weights_name(model.weights) + ")";
  if (!solver.empty()) text += ", solver " + solver;
  for (const FreeBody& body : model.bodies)
    text += "\nbody " + body.name + ": " + number(1000 * body.mass_kg) + " g; held while " + body.name +
            "_hold is 1, free at 0; forces " + body.name + "_fx, _fy and _fz [N]";
  for (const Actuator& a : model.actuators)
    if (a.kind == ActuatorKind::motion)
      text += "\nobstacle moved by " + a.name + " [mm]";
    else if (a.kind == ActuatorKind::turn)
      text +=
          "\nsupport '" + model.turns[static_cast<std::size_t>(a.other)].support + "' turned by " + a.name + " [deg]";
  for (const Actuator& a : model.actuators)
    if (drives(a))
      text += "\nactuator " + a.name + ": " + kind_name(a) + ", " +
              (has_measure(a) ? number(a.rest_measure) + " " + unit_of_measure(a) + " at rest, " : "") +
              command_range(a) + curve_text(a);
  for (const std::string& warning : model.warnings) text += "\nwarning: " + warning;
  for (const std::string& note : model.notes) text += "\nnote: " + note;
  return text;
}

std::string findings_text(const Model& model, const StepRecord& step) {
  std::string text;
  for (const runs::Finding& finding : runs::findings(model, step)) {
    text += (text.empty() ? "" : "\n") + runs::finding_text(model, finding);
    if (finding.kind == runs::Finding::Kind::unstable) text += "; --stable looks for the shape that it goes to";
    if (finding.kind == runs::Finding::Kind::unstable_way) text += "; --stable looks for it";
  }
  return text;
}

void OverlapTally::add(std::size_t number, const StepRecord& record) {
  if (record.self_overlap.points == 0) return;
  numbers_.push_back(number);
  if (record.self_overlap.deepest_mm <= deepest_.deepest_mm) return;
  deepest_ = record.self_overlap;
  at_ = number;
}

std::string OverlapTally::text(const std::string& what) const {
  if (numbers_.empty()) return "";
  return "warning: the shape passes through itself in " + what + (numbers_.size() == 1 ? " " : "s ") +
         list_text(numbers_) + ", the deepest " + runs::depth_text(deepest_.deepest_mm, deepest_.where) +
         (numbers_.size() == 1 ? "" : " in " + what + " " + std::to_string(at_)) + runs::overlap_cause(model_);
}

std::string unstable_text(const std::string& what, const std::vector<std::size_t>& numbers) {
  return "warning: the equilibrium of " + what + (numbers.size() == 1 ? " " : "s ") + list_text(numbers) +
         " is unstable: the robot would buckle or snap away from it; --stable looks for the shape that it goes to";
}

namespace {

/// Where a shape at a limit is deformed most, and what is there.
std::string worst_text(const WorstPlace& worst) {
  const bool crushed = worst.volume_ratio < 0.2, by_cable = worst.beside.find("cable") != std::string::npos;
  return ". Deformed most is " + std::string(worst.prism ? "prism " : "tetrahedron ") + std::to_string(worst.element) +
         " (from 0)" + (worst.region.empty() ? "" : " of region '" + worst.region + "'") + " at " +
         point_text(worst.at, 4, 1e-6) + " mm" + (worst.beside.empty() ? "" : ", next to " + worst.beside) +
         ": strain " + percent(worst.strain) + ", " + percent(worst.volume_ratio) + " of its volume" +
         (!crushed   ? ""
          : by_cable ? "; spread the cable's force over a rigid region there"
                     : "; make the mesh finer there");
}

}  // namespace

std::string shortfall_text(const Model& model, const StepRecord& step) {
  if (step.answered()) return step.remark + "; the shape is the last one";
  if (model.formulation == Formulation::physical && step.reached_share == 1)
    return step.remark + "; the shape is the last one";
  if (model.formulation == Formulation::physical)
    return runs::reached_text(model, step) + ": " + step.remark + "; the shape is the last good one" +
           (step.worst ? worst_text(*step.worst) : "");
  return (step.remark.empty() ? "" : step.remark + ", and ") + "the shape is that after " +
         counted(static_cast<std::size_t>(step.iterations), "iteration") + ", not an equilibrium";
}

}  // namespace softkin::cli
