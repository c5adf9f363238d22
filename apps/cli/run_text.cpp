#include "run_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/core/text.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/names.hpp>
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

/// share  of the normal force, that slips
std::string slipping_text(double share) {
  if (share <= 0) return "; it sticks";
  return share >= 1 ? "; it slips" : "; " + number(100 * share, 3) + " % of it slips";
}

/// Why parts of the robot can be in each other.
std::string overlap_cause(const Model& model) {
  const bool stopped = model.contact.any() && model.contact.pair(0, 0).touch;
  return (stopped ? "; parts that are closer at rest than " + number(2 * model.contact.distance_mm, 3) +
                        " mm, twice the contact distance, do not stop each other"
                  : std::string("; parts that meet do not stop each other here")) +
         ", so what lies beyond the first touch is not what the robot does: ask for less";
}

constexpr const char* units_text = " (mm, MPa, kPa, kV, N, kg/m^3, m/s^2)";

std::string depth_text(double deepest_mm, const Vec3& where) {
  const auto axis = [&](Index i) { return decimal(where[i], 2); };
  return number(deepest_mm, 2) + " mm at (" + axis(0) + ", " + axis(1) + ", " + axis(2) + ") mm";
}

/// "(1.25, 0, -3)" of three numbers of a finding
std::string point_text(const double* xyz) {
  return softkin::point_text({xyz[0], xyz[1], xyz[2]}, 4, 1e-6);
}

/// "air by its volume: 0 kPa at 1, 9.1 kPa at 2.4, ..."
std::string branch_text(const Model& model, const runs::Finding& finding) {
  const auto is_it = [&](const Actuator& actuator) { return actuator.name == finding.name; };
  const Actuator& actuator = *std::find_if(model.actuators.begin(), model.actuators.end(), is_it);
  std::string text = finding.name + " by its " + (actuator.kind == ActuatorKind::cable ? "length" : "volume") + " [-]:";
  for (std::size_t i = 0; i + 1 < finding.values.size(); i += 2)
    text += (i > 0 ? ", " : " ") + number(finding.values[i + 1], 4) + " " + command_unit(actuator) + " at " +
            number(finding.values[i], 4);
  return text;
}

std::string finding_text(const Model& model, const runs::Finding& finding) {
  using Kind = runs::Finding::Kind;
  const std::vector<double>& v = finding.values;
  switch (finding.kind) {
    case Kind::strain:
      return "principal strain of the body: " + percent(v[0]) + " to " + percent(v[1]) +
             ", 95 % of the volume within " + percent(v[2]);
    case Kind::beyond_linear_range:
      return percent(v[0]) + " of region '" + finding.name + "' is strained beyond its linear range of " +
             percent(v[1]);
    case Kind::inverted:
      return "warning: " + counted(static_cast<std::size_t>(v[0]), "element") + (v[0] == 1 ? " is" : " are") +
             " inverted";
    case Kind::slack:
      return "cable '" + finding.name + "' is slack: its path is " + number(v[0], 5) +
             " of its length at rest, the cable " + number(v[1], 5);
    case Kind::charged:
      return "dea '" + finding.name + "' holds " + number(v[0], 4) + " nC, " + number(v[1], 4) +
             " pF; the field in its layer is at most " + number(v[2], 4) + " kV/mm, where it is " + number(v[3], 4) +
             " mm thick, at " + point_text(&v[4]) + " mm";
    case Kind::self_overlap:
      return "warning: the shape passes through itself: " + counted(static_cast<std::size_t>(v[0]), "point") +
             " of its surface " + (v[0] == 1 ? "lies" : "lie") + " inside it, the deepest " +
             depth_text(v[1], {v[2], v[3], v[4]}) + overlap_cause(model);
    case Kind::motionless:
      return "warning: nothing moved: the largest displacement is " + number(v[0], 2) +
             " mm; are what is asked for and the moduli in the right units?" + units_text;
    case Kind::far_strained:
      return "warning: the body is strained by up to " + percent(v[0]) +
             ", where most elastomers have broken; are the loads and the moduli in the right units?" + units_text;
    case Kind::far_moved:
      return "warning: a point moved by " + number(v[0], 4) + " mm, and the robot is " + number(v[1], 4) +
             " mm across; are the loads and the moduli in the right units?" + units_text;
    case Kind::accuracy:
      return "last step of the iteration " + number(v[0], 2) + " mm; estimated distance from the equilibrium " +
             number(v[1], 2) + " mm" +
             (v.size() > 2 ? "; " + number(v[2], 2) + " N out of balance, elements pull with " + number(v[3], 3) + " N"
                           : "");
    case Kind::stress:
      return "stress in the body: von Mises at most " + number(v[0], 4) + " MPa, at " + point_text(&v[1]) + " mm" +
             (finding.name.empty() ? "" : " in region '" + finding.name + "'") + "; principal " + number(v[5], 4) +
             " to " + number(v[4], 4) + " MPa";
    case Kind::reaction:
      return "support '" + finding.name + "' exerts " + point_text(&v[0]) + " N and " + point_text(&v[3]) +
             " N mm about " + point_text(&v[6]) + " mm";
    case Kind::contact:
      return finding.name +
             (finding.other.empty() ? " presses on itself with " + number(v[9], 4) + " N"
                                    : " exerts " + point_text(&v[0]) + " N and " + point_text(&v[3]) + " N mm") +
             " about " + point_text(&v[6]) + " mm" + (finding.other.empty() ? "" : " on " + finding.other) +
             ", at most " + number(v[10], 4) + " kPa over " + number(v[11], 4) + " mm^2; least gap " +
             number(v[12], 3) + " mm" + (v.size() > 13 ? slipping_text(v[13]) : "");
    case Kind::magnetic:
      return "magnetic fields exert " + point_text(&v[0]) + " N and " + point_text(&v[3]) + " N mm about " +
             point_text(&v[6]) + " mm";
    case Kind::untouched:
      return "nothing touches";
    case Kind::unstable:
      return "warning: this equilibrium is unstable in " + counted(static_cast<std::size_t>(v[0]), "way") +
             ": the robot would buckle or snap away from it; --stable looks for the shape that it goes to";
    case Kind::buckled:
      return "the robot left " +
             counted(static_cast<std::size_t>(v[0]), "unstable equilibrium", "unstable equilibria") +
             " for a stable one, moving by up to " + number(v[1], 3) + " mm";
    case Kind::snapped:
      return "warning: at " + percent(v[1]) + " of the way the shape jumps by " + number(v[0], 3) +
             " mm: the robot snaps through, and what it does there depends on how fast it is moved";
    case Kind::unstable_way:
      return "warning: from " + percent(v[0]) +
             " of the way on equilibria were unstable: the robot would leave the way there, for a shape that may be "
             "another one; --stable looks for it";
    case Kind::branch:
      return branch_text(model, finding);
    case Kind::diverged:
      break;
  }
  return "warning: the iteration diverged";
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
  for (const runs::Finding& finding : runs::findings(model, step))
    text += (text.empty() ? "" : "\n") + finding_text(model, finding);
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
         list_text(numbers_) + ", the deepest " + depth_text(deepest_.deepest_mm, deepest_.where) +
         (numbers_.size() == 1 ? "" : " in " + what + " " + std::to_string(at_)) + overlap_cause(model_);
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
         point_text(worst.at.data()) + " mm" + (worst.beside.empty() ? "" : ", next to " + worst.beside) + ": strain " +
         percent(worst.strain) + ", " + percent(worst.volume_ratio) + " of its volume" +
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
