#include <cmath>
#include <softkin/calibration/pressure_check.hpp>
#include <softkin/core/error.hpp>
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

}  // namespace

std::vector<std::optional<double>> predicted_pressures(const Model& model, Index actuator,
                                                       const std::vector<double>& ratios, int threads,
                                                       const ProgressCallback& progress) {
  const Actuator& chamber = model.actuators.at(static_cast<std::size_t>(actuator));
  if (model.formulation != Formulation::physical || chamber.kind != ActuatorKind::pneumatic ||
      chamber.control != Control::ratio)
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
    if (found.report.status == Status::interrupted) break;
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

}  // namespace softkin::calibration
