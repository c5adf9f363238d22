#include <algorithm>
#include <cmath>
#include <softkin/calibration/pressure_check.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::calibration {

namespace {

double misfit(const std::vector<double>& measured, const std::vector<double>& predicted, double factor) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    difference += std::pow(measured[i] - factor * predicted[i], 2);
    size += measured[i] * measured[i];
  }
  return size > 0 ? std::sqrt(difference / size) : 0;
}

/// The chamber's volume is controlled up to the highest ratio; the other chambers are open.
void prepare(RobotSpec& spec, std::size_t chamber, double highest) {
  spec.formulation = Formulation::physical;
  for (std::size_t a = 0; a < spec.actuators.size(); ++a) {
    ActuatorSpec& each = spec.actuators[a];
    auto* open = each.as<PneumaticSpec>();
    if (open == nullptr) continue;
    open->filling.reset();
    each.curve.reset();
    each.branch = Branch::loading;
    const bool tested = a == chamber;
    each.control = tested ? Control::ratio : Control::load;
    each.low = tested ? 1 : 0;
    each.high = tested ? highest : 0;
    each.rest = tested ? 1 : 0;
  }
}

/// Of the ratios that both know, where these are two or more.
void add_check(Branch branch, const MonotoneCurve& curve, PressureComparison& comparison) {
  std::vector<double> measured, predicted;
  for (std::size_t i = 0; i < comparison.ratios.size(); ++i) {
    const double ratio = comparison.ratios[i];
    if (!comparison.predicted[i] || ratio < curve.y().front() || ratio > curve.y().back()) continue;
    measured.push_back(curve.inverse(ratio));
    predicted.push_back(*comparison.predicted[i]);
  }
  if (measured.size() >= 2) comparison.branches.emplace_back(branch, check_modulus(measured, predicted));
}

}  // namespace

std::vector<std::optional<double>> predicted_pressures(const Model& model, Index actuator,
                                                       const std::vector<double>& ratios, int threads,
                                                       const ProgressCallback& progress) {
  const Actuator& chamber = model.actuators.at(actuator);
  if (model.formulation != Formulation::physical || !chamber.is<ChamberDrive>() || chamber.control != Control::ratio)
    throw InvalidInput("actuator '" + chamber.name +
                       "': pressures are predicted for a chamber of the physical "
                       "formulation whose volume is controlled");
  const Statics statics(model);
  StaticsOptions options;
  options.threads = threads;
  State state = statics.rest();
  std::vector<std::optional<double>> pressures;
  for (const double ratio : ratios) {
    Actuation actuation = model.rest_actuation();
    actuation[actuator] = ratio;
    const Equilibrium found = statics.solve(actuation, state, options, progress);
    const bool converged = found.report.status == Status::converged;
    pressures.push_back(converged ? std::optional(found.state.multipliers[actuator]) : std::nullopt);
    if (converged) state = found.state;
    if (found.report.stopped) break;
  }
  pressures.resize(ratios.size());
  return pressures;
}

ModulusCheck check_modulus(const std::vector<double>& measured, const std::vector<double>& predicted) {
  if (measured.size() != predicted.size()) throw InvalidInput("as many pressures must be measured as predicted");
  double product = 0, square = 0;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    product += measured[i] * predicted[i];
    square += predicted[i] * predicted[i];
  }
  if (!(square > 0)) throw InvalidInput("no pressure is predicted that could be compared");
  const double factor = product / square;
  return {factor, misfit(measured, predicted, 1), misfit(measured, predicted, factor)};
}

std::size_t tested_chamber(const RobotSpec& spec, const std::string& requested) {
  std::vector<std::string> names;
  std::size_t chamber = 0;
  for (std::size_t a = 0; a < spec.actuators.size(); ++a) {
    if (!spec.actuators[a].is<PneumaticSpec>()) continue;
    names.push_back(spec.actuators[a].name);
    if (names.back() == requested || requested.empty()) chamber = a;
  }
  if (names.empty()) throw InvalidInput({spec.name}, "the scene has no pneumatic actuator");
  if (requested.empty() && names.size() > 1)
    throw InvalidInput({spec.name},
                       "the scene has several pneumatic actuators: say which one was tested" + suggest_name("", names));
  if (!requested.empty() && std::find(names.begin(), names.end(), requested) == names.end())
    throw InvalidInput("there is no pneumatic actuator " + excerpt(requested) + suggest_name(requested, names));
  return chamber;
}

bool PressureComparison::is_complete() const {
  return std::all_of(predicted.begin(), predicted.end(), [](const auto& pressure) { return pressure.has_value(); });
}

PressureComparison compare_with_physics(RobotSpec spec, std::size_t chamber, const ActuatorCurve& curve, int threads,
                                        const ProgressCallback& progress) {
  constexpr int compared = 8;  // ratios
  const double low = std::max(1.0, curve.loading.ratio.y().front()), high = curve.loading.ratio.y().back();
  if (!(high > 1)) throw InvalidInput("ratios above 1 are compared, and the loading branch has none");
  prepare(spec, chamber, high);
  PressureComparison result{spec.actuators[chamber].name, {}, {}, {}};
  for (int i = 1; i <= compared; ++i) result.ratios.push_back(i == compared ? high : low + (high - low) * i / compared);
  result.predicted = predicted_pressures(compile(spec), chamber, result.ratios, threads, progress);
  add_check(Branch::loading, curve.loading.ratio, result);
  if (curve.unloading) add_check(Branch::unloading, curve.unloading->ratio, result);
  return result;
}

}  // namespace softkin::calibration
