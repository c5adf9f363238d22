#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/finding_text.hpp>

namespace softkin::runs {

namespace {

std::string percent(double fraction) {
  return decimal(100 * fraction, 1) + " %";
}

/// fraction  of the normal force, that slips
std::string slipping_text(double fraction) {
  if (fraction <= 0) return "; it sticks";
  return fraction >= 1 ? "; it slips" : "; " + number(100 * fraction, 3) + " % of it slips";
}

constexpr const char* units_text = " (mm, MPa, kPa, kV, N, kg/m^3, m/s^2)";

std::string place_text(const Vec3& place) {
  return softkin::point_text(place, 4, 1e-6);
}

/// "(1, 0, 0) N and (0, 0, 0) N mm about (0, 0, 0) mm" of a force and its moment about a centre
template <class Forces>
std::string wrench_text(const Forces& of) {
  return place_text(of.force) + " N and " + place_text(of.moment) + " N mm about " + place_text(of.center) + " mm";
}

/// Returns the text of each finding.
struct FindingText {
  const Model& model;

  std::string operator()(const finding::Strain& of) const {
    return "principal strain of the body: " + percent(of.least) + " to " + percent(of.greatest) +
           ", 95 % of the volume within " + percent(of.percentile_95);
  }
  std::string operator()(const StrainHistogram::Beyond& of) const {
    return percent(of.fraction) + " of region '" + of.region + "' is strained beyond its linear range of " +
           percent(of.linear_range);
  }
  std::string operator()(const finding::Slack& of) const {
    return "cable '" + of.cable + "' is slack: its path is " + number(of.path, 5) +
           " of its length at rest, the cable " + number(of.length, 5);
  }
  std::string operator()(const finding::Charged& of) const {
    const ElectricLayer& layer = of.layer;
    return "dea '" + of.dea + "' holds " + number(layer.charge_nC, 4) + " nC, " + number(layer.capacitance_pF, 4) +
           " pF; the field in its layer is at most " + number(layer.field_kV_mm, 4) + " kV/mm, where it is " +
           number(layer.thickness_mm, 4) + " mm thick, at " + place_text(layer.at) + " mm";
  }
  std::string operator()(const finding::CableFriction& of) const {
    return "cable '" + of.cable + "' has friction: of " + number(of.motor_N, 4) + " N at the motor " +
           number(of.forces.end_N, 4) + " N are left at its far end; it sticks in " + percent(of.forces.sticks) +
           " of its friction";
  }
  std::string operator()(const finding::Fibre& of) const {
    const FibreForces& f = of.forces;
    return "fibre '" + of.name + "' carries " + number(f.mean_N, 4) + " N in the mean, " + number(f.min_N, 4) + " to " +
           number(f.largest_N, 4) + " N, the most at " + place_text(f.where) + " mm; it is " + number(f.stretch, 6) +
           " times as long as at rest" + (f.slack > 0 ? ", and slack in " + percent(f.slack) + " of it" : "");
  }
  std::string operator()(const finding::Layer& of) const {
    const LayerForces& f = of.forces;
    return "layer '" + of.name + "' carries " + number(f.min_N_mm, 4) + " to " + number(f.largest_N_mm, 4) +
           " N/mm, the most at " + place_text(f.where) + " mm; it is stretched by up to " + percent(f.strain) +
           (f.wrinkled > 0 ? ", wrinkled in " + percent(f.wrinkled) + " of its area" : "") +
           (f.slack > 0 ? ", slack in " + percent(f.slack) : "");
  }
  std::string operator()(const finding::Accuracy& of) const {
    return "last step of the iteration " + number(of.step_mm, 2) + " mm; estimated distance from the equilibrium " +
           number(of.estimated_error_mm, 2) + " mm" +
           (of.physical ? "; " + number(of.residual_N, 2) + " N out of balance, elements pull with " +
                              number(of.pull_N, 3) + " N"
                        : "");
  }
  std::string operator()(const StressExtremes& of) const {
    const auto& [most, greatest, least] = of;
    return "stress in the body: von Mises at most " + number(most.value, 4) + " MPa, at " + place_text(most.at) +
           " mm" + (most.region.empty() ? "" : " in region '" + most.region + "'") + "; principal " +
           number(least.value, 4) + " to " + number(greatest.value, 4) + " MPa";
  }
  std::string operator()(const finding::Support& of) const {
    std::string text = "support '" + of.name + "' exerts " + wrench_text(of.exerts);
    for (const ChamberForce& chamber : of.exerts.chambers)
      text += "; the pressure of '" + model.actuators[chamber.actuator].name + "' acts on the support with " +
              place_text(chamber.force) + " N";
    return text;
  }
  std::string operator()(const MagneticLoad& of) const { return "magnetic fields exert " + wrench_text(of); }
  std::string operator()(const finding::Contact& of) const {
    const PairForces& f = of.forces;
    const bool itself = of.other.empty();
    return of.part +
           (itself ? " presses on itself with " + number(f.normal_N, 4) + " N about " + place_text(f.center) + " mm"
                   : " exerts " + wrench_text(f) + " on " + of.other) +
           ", at most " + number(f.pressure_kPa, 4) + " kPa over " + number(f.area_mm2, 4) + " mm^2; least gap " +
           number(f.gap_mm, 3) + " mm" + (f.slipping ? slipping_text(*f.slipping) : "");
  }
  std::string operator()(const finding::Untouched&) const { return "nothing touches"; }
  std::string operator()(const finding::Buckled& of) const {
    return "the robot left " +
           counted(static_cast<std::size_t>(of.times), "unstable equilibrium", "unstable equilibria") +
           " for a stable one, moving by up to " + number(of.largest_mm, 3) + " mm";
  }
  /// "air by its volume [-]: 0 kPa at 1, 9.1 kPa at 2.4, ..."
  std::string operator()(const LoadBranch& of) const {
    const Actuator& actuator = model.actuators[of.actuator];
    std::string text = actuator.name + " by its " + measure_name(actuator) + " [-]:";
    for (std::size_t i = 0; i < of.points.size(); ++i)
      text += (i > 0 ? ", " : " ") + number(of.points[i].load, 4) + " " + command_unit(actuator) + " at " +
              number(of.points[i].measure, 4);
    return text;
  }

  std::string operator()(const finding::Inverted& of) const {
    return "warning: " + counted(of.elements, "element") + (of.elements == 1 ? " is" : " are") + " inverted";
  }
  std::string operator()(const SelfOverlap& of) const {
    return "warning: the shape passes through itself: " + counted(of.points, "point") + " of its surface " +
           (of.points == 1 ? "lies" : "lie") + " inside it, the deepest " + depth_text(of.deepest_mm, of.where) +
           overlap_cause(model);
  }
  std::string operator()(const finding::Motionless& of) const {
    return "warning: nothing moved: the largest displacement is " + number(of.largest_mm, 2) +
           " mm; are the commands and the moduli in the right units?" + units_text;
  }
  std::string operator()(const finding::FarStrained& of) const {
    return "warning: the body is strained by up to " + percent(of.greatest) +
           ", where most elastomers have broken; are the loads and the moduli in the right units?" + units_text;
  }
  std::string operator()(const finding::FarMoved& of) const {
    return "warning: a point moved by " + number(of.largest_mm, 4) + " mm, and the robot is " +
           number(of.diagonal_mm, 4) + " mm across; are the loads and the moduli in the right units?" + units_text;
  }
  std::string operator()(const finding::Unstable& of) const {
    return "warning: this equilibrium is unstable in " + counted(static_cast<std::size_t>(of.modes), "mode") +
           ": the robot would buckle or snap away from it";
  }
  std::string operator()(const finding::Snapped& of) const {
    return "warning: at " + percent(of.from) + " of the path the shape jumps by " + number(of.largest_mm, 3) +
           " mm: the robot snaps through, and what it does there depends on how fast it is moved";
  }
  std::string operator()(const finding::UnstablePath& of) const {
    return "warning: from " + percent(of.from) +
           " of the path on equilibria were unstable: the robot would leave the path there, for a shape that may be "
           "another one";
  }
  std::string operator()(const finding::Diverged&) const { return "warning: the iteration diverged"; }
};

}  // namespace

std::string overlap_cause(const Model& model) {
  const bool stopped = model.contact.any() && model.contact.pair(0, 0).touch;
  return (stopped ? "; parts that are closer at rest than " + number(2 * model.contact.distance_mm, 3) +
                        " mm, twice the contact distance, do not stop each other"
                  : std::string("; parts that meet do not stop each other here")) +
         ", so shapes beyond the first touch are not those of the robot: request less";
}

std::string depth_text(double deepest_mm, const Vec3& where) {
  const auto axis = [&](Index i) { return decimal(where[i], 2); };
  return number(deepest_mm, 2) + " mm at (" + axis(0) + ", " + axis(1) + ", " + axis(2) + ") mm";
}

std::string finding_text(const Model& model, const Finding& finding) {
  return std::visit(FindingText{model}, finding);
}

std::vector<FindingLine> finding_lines(const Model& model, const StepRecord& record, const std::string& stable) {
  std::vector<FindingLine> lines;
  for (const Finding& finding : findings(model, record)) {
    std::string text = finding_text(model, finding);
    if (std::holds_alternative<finding::Unstable>(finding))
      text += "; " + stable + " looks for the shape that it goes to";
    if (std::holds_alternative<finding::UnstablePath>(finding)) text += "; " + stable + " looks for it";
    const bool is_warning = text.starts_with("warning: ");
    lines.push_back({finding.index(), is_warning, std::move(text)});
  }
  return lines;
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

}  // namespace softkin::runs
