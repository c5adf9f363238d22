#include <algorithm>
#include <cstdio>
#include <iterator>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/settings.hpp>
#include <softkin/model/model.hpp>
#include <softkin/model/names.hpp>

namespace softkin {

namespace {

/// Takes an end, and blanks before it, off a text that has it.
bool take_end(std::string& text, const std::string& end) {
  if (!text.ends_with(end)) return false;
  text.resize(text.size() - end.size());
  while (text.ends_with(' ')) text.pop_back();
  return true;
}

std::string input_text(const ActuatorCurve& curve, double input) {
  return number(input) + unit_of_input(curve.input) + (curve.input == CurveInput::pressure ? " (gauge)" : "");
}

}  // namespace

std::optional<CurveSetting> parse_curve_setting(const Actuator& actuator, const std::string& text) {
  if (!actuator.curve) return std::nullopt;
  CurveSetting setting{0, actuator.branch};
  std::string rest = text;
  for (const Branch branch : {Branch::unloading, Branch::loading})
    if (take_end(rest, std::string(":") + branch_name(branch))) {
      setting.branch = branch;
      break;
    }
  const bool absolute = actuator.curve->input == CurveInput::pressure && take_end(rest, "kPa_abs");
  if (!absolute && !take_end(rest, unit_of_input(actuator.curve->input) + 1)) return std::nullopt;
  if (!parse_real(rest, setting.input)) return std::nullopt;
  if (absolute) setting.input -= actuator.curve->atmosphere_kPa;
  return setting;
}

double ratio_of(const Actuator& actuator, const CurveSetting& setting) {
  const std::string name = "actuator '" + actuator.name + "': ";
  double ratio = 0;
  try {
    ratio = ratio_by_curve(actuator, setting.input, setting.branch);
  } catch (const InvalidInput& error) {
    throw InvalidInput(name + error.what());
  }
  if (!(ratio >= actuator.low && ratio <= actuator.high))
    throw InvalidInput(name + input_text(*actuator.curve, setting.input) + " is a ratio of " + number(ratio) +
                       " by curve " + actuator.curve->file + ", outside " + range_text(actuator));
  return ratio;
}

std::vector<std::string> curve_units(const Actuator& actuator) {
  if (!actuator.curve) return {};
  if (actuator.curve->input == CurveInput::voltage) return {"kV"};
  return {"kPa", "kPa_abs"};
}

std::string curve_remarks(const Model& model, const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings)
    for (const Actuator& actuator : model.actuators) {
      const std::string_view whole = setting;
      const std::size_t equals = whole.find('=');
      if (equals == std::string_view::npos || trimmed(whole.substr(0, equals)) != actuator.name) continue;
      const auto requested = parse_curve_setting(actuator, std::string(trimmed(whole.substr(equals + 1))));
      if (!requested) continue;
      const std::optional<double> spread = spread_by_curve(actuator, requested->input, requested->branch);
      text += actuator.name + ": " + input_text(*actuator.curve, requested->input) + ", " +
              branch_name(requested->branch) + " branch of " + actuator.curve->file + ": ratio " +
              number(ratio_of(actuator, *requested)) + (spread ? " +- " + number(*spread, 2) : "") + " [-]\n";
    }
  return text;
}

std::string curve_text(const Actuator& actuator) {
  if (!actuator.curve) return "";
  const std::vector<double>& inputs = actuator.curve->branch(actuator.branch).ratio.x();
  return "; curve " + actuator.curve->file + ": " + number(inputs.front()) + " to " +
         input_text(*actuator.curve, inputs.back()) + ", " + branch_name(actuator.branch) + " branch";
}

std::string unknown_actuator(const Model& model, const std::string& name) {
  std::vector<std::string> names;
  for (const Actuator& actuator : model.actuators) names.push_back(actuator.name);
  return "no actuator " + excerpt(name) + (names.empty() ? "; the scene has none" : suggest_name(name, names));
}

namespace {

/// What may stand in place of a ratio; "" without a curve.
std::string curve_hint(const Actuator& actuator) {
  if (!actuator.curve) return "";
  const bool dea = actuator.is<DeaDrive>();
  return dea ? "; or a voltage by its curve, such as 2.5kV" +
                   std::string(actuator.curve->unloading ? " or 2.5kV:unloading" : "")
             : "; or a pressure by its curve, such as 50kPa (gauge), 150kPa_abs" +
                   std::string(actuator.curve->unloading ? " or 50kPa:unloading" : "");
}

/// A unit that users take for that of a load, and what one of it is.
struct OtherUnit {
  const char *unit, *own;
  double factor;
};

// longer names before those that they end in
constexpr OtherUnit other_units[] = {
    {"MPa", "kPa", 1000}, {"hPa", "kPa", 0.1},  {"mbar", "kPa", 0.1}, {"bar", "kPa", 100}, {"psi", "kPa", 6.894757},
    {"Pa", "kPa", 0.001}, {"mN", "N", 0.001},   {"kN", "N", 1000},    {"V", "kV", 0.001},  {"uL", "mL", 0.001},
    {"cm3", "mL", 1},     {"mm3", "mL", 0.001}, {"L", "mL", 1000}};

bool is_kPa(const std::string& unit) {
  return unit == "kPa";
}

/// Where to get a curve, for a pressure or voltage given to an actuator that has none; else "".
std::string missing_curve(const Actuator& actuator, const std::string& text) {
  if (actuator.curve || actuator.control != Control::ratio) return "";
  if (actuator.is<ChamberDrive>() &&
      (text.ends_with("kPa_abs") ||
       std::any_of(std::begin(other_units), std::end(other_units),
                   [&](const auto& each) { return is_kPa(each.own) && text.ends_with(each.unit); }) ||
       text.ends_with("kPa")))
    return "; '" + actuator.name +
           "' is commanded by its volume: a pressure needs a curve in the scene (softkin calibrate pressure), or "
           "'control: "
           "pressure' with a range in kPa (physical)";
  if (actuator.is<DeaDrive>() && text.ends_with("kV"))
    return "; a voltage needs 'control: voltage', or a curve in the scene (softkin calibrate dea)";
  return "";
}

/// What a number with another unit of the actuator's load is in its own: "; 0.5bar is 50kPa"; else "".
std::string converted_hint(const Actuator& actuator, const std::string& text) {
  for (const OtherUnit& other : other_units) {
    std::string digits = text;
    double value = 0;
    if (command_unit(actuator) != other.own || !take_end(digits, other.unit) || !parse_real(digits, value)) continue;
    return "; " + text + " is " + number(value * other.factor) + other.own;
  }
  return "";
}

/// What a number outside the range may have been meant as; else "".
std::string meant_hint(const Actuator& actuator, double value) {
  for (const OtherUnit& other : other_units) {
    const double meant = value * other.factor;
    if (command_unit(actuator) == other.own && meant != 0 && meant >= actuator.low && meant <= actuator.high)
      return "; is it in " + std::string(other.unit) + "? That would be " + number(meant) + other.own;
  }
  return "";
}

/// How to set several actuators, where "left=20,right=20" sets them in one; else "".
std::string several_hint(const std::string& option, const std::string& name, const std::string& text) {
  const std::size_t comma = text.find_first_of(",;"), equals = text.find('=');
  if (comma == std::string::npos || equals == std::string::npos || comma > equals) return "";
  return "; set each actuator on its own: " + option + " " + printable(name + "=" + text.substr(0, comma)) + " " +
         option + " " + printable(text.substr(comma + 1));
}

/// Reads a value as the user gives it: a ratio without unit, a load with or without its own, or the pressure or voltage
/// of the actuator's curve with its unit, which becomes a ratio; false where it is none of these.
bool parse_command(const Actuator& actuator, const std::string& text, double& value) {
  if (const auto setting = parse_curve_setting(actuator, text)) {
    value = ratio_of(actuator, *setting);
    return true;
  }
  const std::string unit = command_unit(actuator);
  std::string digits = text;
  if (!unit.empty()) (void)take_end(digits, unit);
  return parse_real(digits, value);
}

/// "the pressure must be a finite number in kPa, such as 5 or 5kPa".
std::string expected_command(const Actuator& actuator) {
  const std::string unit = command_unit(actuator);
  if (unit.empty()) return "the ratio to rest must be a finite number without unit" + curve_hint(actuator);
  return std::string("the ") + command_name(actuator) + " must be a finite number in " + unit + ", such as 5 or 5" +
         unit;
}

}  // namespace

Settings read_settings(const Model& model, const std::string& option, const std::vector<std::string>& settings) {
  Settings values(model.actuators.size());
  for (const std::string& setting : settings) {
    const auto refuse = [&](const std::string& why) {
      throw InvalidInput(option + " " + excerpt(setting) + ": " + why);
    };
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) refuse("expected ACTUATOR=VALUE, for example " + option + " air=1.5");
    const std::string name(trimmed(std::string_view(setting).substr(0, equals)));
    const std::string text(trimmed(std::string_view(setting).substr(equals + 1)));
    const std::optional<Index> a = find_actuator(model, name);
    if (!a) refuse(unknown_actuator(model, name));
    const Actuator& actuator = model.actuators[*a];
    double value = 0;
    if (!parse_command(actuator, text, value))
      refuse(expected_command(actuator) + ", not " + excerpt(text) + missing_curve(actuator, text) +
             converted_hint(actuator, text) + decimal_comma_hint(text) + several_hint(option, name, text));
    if (!(value >= actuator.low && value <= actuator.high))
      refuse(std::string("the ") + command_name(actuator) + " is outside " + range_text(actuator) +
             meant_hint(actuator, value));
    if (values[*a]) refuse("actuator '" + name + "' is set twice");
    values[*a] = value;
  }
  return values;
}

Actuation with_settings(Actuation actuation, const Settings& settings) {
  for (std::size_t a = 0; a < settings.size(); ++a)
    if (settings[a]) actuation[a] = *settings[a];
  return actuation;
}

Index read_body(const Model& model, const std::string& option, const std::string& name) {
  std::vector<std::string> names;
  for (const FreeBody& body : model.bodies) names.push_back(body.name);
  if (names.empty()) throw InvalidInput({model.name}, "there is no body to grasp: give it 'bodies'");
  if (name.empty() && names.size() > 1)
    throw InvalidInput(option + ": there are " + std::to_string(names.size()) + " bodies, " + names[0] + ", " +
                       names[1] + (names.size() > 2 ? ", ..." : "") + ": say which one is pulled");
  for (std::size_t b = 0; b < names.size(); ++b)
    if (name.empty() || names[b] == name) return b;
  throw InvalidInput(option + ": there is no body " + excerpt(name) + suggest_name(name, names));
}

Vec3 read_direction(const std::string& option, const std::string& text) {
  const bool minus = text.starts_with('-');
  const std::string axis = text.substr(minus ? 1 : 0);
  const std::size_t named = axis.size() == 1 ? std::string("xyz").find(axis) : std::string::npos;
  if (named != std::string::npos) return (minus ? -1 : 1) * Vec3::Unit(named);
  Vec3 direction;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &direction[0], &direction[1], &direction[2], &rest) != 3 ||
      !direction.allFinite() || direction.norm() == 0)
    throw InvalidInput(option + " must be x, -x, y, -y, z, -z or DX,DY,DZ that are not all 0, not " + excerpt(text));
  return direction.normalized();
}

}  // namespace softkin
