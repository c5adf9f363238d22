#include <algorithm>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/finding_text.hpp>

namespace softkin::runs {

namespace {

std::string percent(double share) {
  return decimal(100 * share, 1) + " %";
}

/// share  of the normal force, that slips
std::string slipping_text(double share) {
  if (share <= 0) return "; it sticks";
  return share >= 1 ? "; it slips" : "; " + number(100 * share, 3) + " % of it slips";
}

constexpr const char* units_text = " (mm, MPa, kPa, kV, N, kg/m^3, m/s^2)";

/// "(1.25, 0, -3)" of three numbers of a finding
std::string place_text(const double* xyz) {
  return softkin::point_text({xyz[0], xyz[1], xyz[2]}, 4, 1e-6);
}

/// "air by its volume: 0 kPa at 1, 9.1 kPa at 2.4, ..."
std::string branch_text(const Model& model, const Finding& finding) {
  const auto is_it = [&](const Actuator& actuator) { return actuator.name == finding.name; };
  const Actuator& actuator = *std::find_if(model.actuators.begin(), model.actuators.end(), is_it);
  std::string text = finding.name + " by its " + (actuator.kind == ActuatorKind::cable ? "length" : "volume") + " [-]:";
  for (std::size_t i = 0; i + 1 < finding.values.size(); i += 2)
    text += (i > 0 ? ", " : " ") + number(finding.values[i + 1], 4) + " " + command_unit(actuator) + " at " +
            number(finding.values[i], 4);
  return text;
}

std::string strain_text(const std::vector<double>& v) {
  return "principal strain of the body: " + percent(v[0]) + " to " + percent(v[1]) + ", 95 % of the volume within " +
         percent(v[2]);
}

std::string beyond_range_text(const Finding& finding) {
  return percent(finding.values[0]) + " of region '" + finding.name + "' is strained beyond its linear range of " +
         percent(finding.values[1]);
}

std::string slack_text(const Finding& finding) {
  return "cable '" + finding.name + "' is slack: its path is " + number(finding.values[0], 5) +
         " of its length at rest, the cable " + number(finding.values[1], 5);
}

std::string charged_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  return "dea '" + finding.name + "' holds " + number(v[0], 4) + " nC, " + number(v[1], 4) +
         " pF; the field in its layer is at most " + number(v[2], 4) + " kV/mm, where it is " + number(v[3], 4) +
         " mm thick, at " + place_text(&v[4]) + " mm";
}

std::string rubbing_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  return "cable '" + finding.name + "' rubs: of " + number(v[0], 4) + " N at the motor " + number(v[1], 4) +
         " N are left at its far end; it sticks in " + percent(v[2]) + " of its friction";
}

std::string fibre_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  return "fibre '" + finding.name + "' carries " + number(v[0], 4) + " N in the mean, " + number(v[2], 4) + " to " +
         number(v[1], 4) + " N, the most at " + place_text(&v[3]) + " mm; it is " + number(v[6], 6) +
         " times as long as at rest" + (v[7] > 0 ? ", and slack in " + percent(v[7]) + " of it" : "");
}

std::string layer_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  return "layer '" + finding.name + "' carries " + number(v[1], 4) + " to " + number(v[0], 4) + " N/mm, the most at " +
         place_text(&v[2]) + " mm; it is stretched by up to " + percent(v[5]) +
         (v[6] > 0 ? ", wrinkled in " + percent(v[6]) + " of its area" : "") +
         (v[7] > 0 ? ", slack in " + percent(v[7]) : "");
}

std::string accuracy_text(const std::vector<double>& v) {
  return "last step of the iteration " + number(v[0], 2) + " mm; estimated distance from the equilibrium " +
         number(v[1], 2) + " mm" +
         (v.size() > 2 ? "; " + number(v[2], 2) + " N out of balance, elements pull with " + number(v[3], 3) + " N"
                       : "");
}

std::string stress_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  return "stress in the body: von Mises at most " + number(v[0], 4) + " MPa, at " + place_text(&v[1]) + " mm" +
         (finding.name.empty() ? "" : " in region '" + finding.name + "'") + "; principal " + number(v[5], 4) + " to " +
         number(v[4], 4) + " MPa";
}

/// "(1, 0, 0) N and (0, 0, 0) N mm" of a force and a moment
std::string wrench_text(const double* xyz) {
  return place_text(xyz) + " N and " + place_text(xyz + 3) + " N mm";
}

std::string reaction_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  return "support '" + finding.name + "' exerts " + wrench_text(&v[0]) + " about " + place_text(&v[6]) + " mm";
}

std::string magnetic_text(const std::vector<double>& v) {
  return "magnetic fields exert " + wrench_text(&v[0]) + " about " + place_text(&v[6]) + " mm";
}

std::string contact_text(const Finding& finding) {
  const std::vector<double>& v = finding.values;
  const bool itself = finding.other.empty();
  return finding.name +
         (itself ? " presses on itself with " + number(v[9], 4) + " N" : " exerts " + wrench_text(&v[0])) + " about " +
         place_text(&v[6]) + " mm" + (itself ? "" : " on " + finding.other) + ", at most " + number(v[10], 4) +
         " kPa over " + number(v[11], 4) + " mm^2; least gap " + number(v[12], 3) + " mm" +
         (v.size() > 13 ? slipping_text(v[13]) : "");
}

std::string buckled_text(const std::vector<double>& v) {
  return "the robot left " + counted(static_cast<std::size_t>(v[0]), "unstable equilibrium", "unstable equilibria") +
         " for a stable one, moving by up to " + number(v[1], 3) + " mm";
}

std::string warning_text(const Model& model, const Finding& finding) {
  using Kind = Finding::Kind;
  const std::vector<double>& v = finding.values;
  switch (finding.kind) {
    case Kind::inverted:
      return counted(static_cast<std::size_t>(v[0]), "element") + (v[0] == 1 ? " is" : " are") + " inverted";
    case Kind::self_overlap:
      return "the shape passes through itself: " + counted(static_cast<std::size_t>(v[0]), "point") +
             " of its surface " + (v[0] == 1 ? "lies" : "lie") + " inside it, the deepest " +
             depth_text(v[1], {v[2], v[3], v[4]}) + overlap_cause(model);
    case Kind::motionless:
      return "nothing moved: the largest displacement is " + number(v[0], 2) +
             " mm; are what is asked for and the moduli in the right units?" + units_text;
    case Kind::far_strained:
      return "the body is strained by up to " + percent(v[0]) +
             ", where most elastomers have broken; are the loads and the moduli in the right units?" + units_text;
    case Kind::far_moved:
      return "a point moved by " + number(v[0], 4) + " mm, and the robot is " + number(v[1], 4) +
             " mm across; are the loads and the moduli in the right units?" + units_text;
    case Kind::unstable:
      return "this equilibrium is unstable in " + counted(static_cast<std::size_t>(v[0]), "way") +
             ": the robot would buckle or snap away from it";
    case Kind::snapped:
      return "at " + percent(v[1]) + " of the way the shape jumps by " + number(v[0], 3) +
             " mm: the robot snaps through, and what it does there depends on how fast it is moved";
    case Kind::unstable_way:
      return "from " + percent(v[0]) +
             " of the way on equilibria were unstable: the robot would leave the way there, for a shape that may be "
             "another one";
    default:
      return "the iteration diverged";
  }
}

}  // namespace

std::string overlap_cause(const Model& model) {
  const bool stopped = model.contact.any() && model.contact.pair(0, 0).touch;
  return (stopped ? "; parts that are closer at rest than " + number(2 * model.contact.distance_mm, 3) +
                        " mm, twice the contact distance, do not stop each other"
                  : std::string("; parts that meet do not stop each other here")) +
         ", so what lies beyond the first touch is not what the robot does: ask for less";
}

std::string depth_text(double deepest_mm, const Vec3& where) {
  const auto axis = [&](Index i) { return decimal(where[i], 2); };
  return number(deepest_mm, 2) + " mm at (" + axis(0) + ", " + axis(1) + ", " + axis(2) + ") mm";
}

std::string finding_text(const Model& model, const Finding& finding) {
  using Kind = Finding::Kind;
  switch (finding.kind) {
    case Kind::strain:
      return strain_text(finding.values);
    case Kind::beyond_linear_range:
      return beyond_range_text(finding);
    case Kind::slack:
      return slack_text(finding);
    case Kind::charged:
      return charged_text(finding);
    case Kind::rubbing:
      return rubbing_text(finding);
    case Kind::fibre:
      return fibre_text(finding);
    case Kind::layer:
      return layer_text(finding);
    case Kind::accuracy:
      return accuracy_text(finding.values);
    case Kind::stress:
      return stress_text(finding);
    case Kind::reaction:
      return reaction_text(finding);
    case Kind::contact:
      return contact_text(finding);
    case Kind::magnetic:
      return magnetic_text(finding.values);
    case Kind::untouched:
      return "nothing touches";
    case Kind::buckled:
      return buckled_text(finding.values);
    case Kind::branch:
      return branch_text(model, finding);
    case Kind::inverted:
    case Kind::self_overlap:
    case Kind::motionless:
    case Kind::far_strained:
    case Kind::far_moved:
    case Kind::unstable:
    case Kind::snapped:
    case Kind::unstable_way:
    case Kind::diverged:
      break;
  }
  return "warning: " + warning_text(model, finding);
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
