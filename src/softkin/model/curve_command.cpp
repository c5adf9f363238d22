#include <algorithm>
#include <softkin/model/curve_command.hpp>

namespace softkin {

namespace {

const CurveBranch* branch_of(const Actuator& actuator, Branch which) {
  if (!actuator.curve || (which == Branch::unloading && !actuator.curve->unloading)) return nullptr;
  return &actuator.curve->branch(which);
}

bool holds(const std::vector<double>& ascending, double value) {
  return value >= ascending.front() && value <= ascending.back();
}

}  // namespace

double ratio_by_curve(const Actuator& actuator, double input, Branch branch) {
  if (!actuator.curve) throw InvalidInput("actuator '" + actuator.name + "' has no curve");
  return actuator.rest * actuator.curve->ratio(input, branch);
}

std::optional<double> input_by_curve(const Actuator& actuator, double ratio, Branch branch) {
  const CurveBranch* curve = branch_of(actuator, branch);
  const double relative = ratio / actuator.rest;
  if (curve == nullptr || !holds(curve->ratio.y(), relative)) return std::nullopt;
  return curve->ratio.inverse(relative);
}

std::optional<double> spread_by_curve(const Actuator& actuator, double input, Branch branch) {
  const CurveBranch* curve = branch_of(actuator, branch);
  if (curve == nullptr || curve->spread.empty() || !holds(curve->ratio.x(), input)) return std::nullopt;
  const std::vector<double>& x = curve->ratio.x();
  const auto above = std::max<std::ptrdiff_t>(1, std::lower_bound(x.begin(), x.end(), input) - x.begin());
  const auto i = static_cast<std::size_t>(above);
  const double share = (input - x[i - 1]) / (x[i] - x[i - 1]);
  return actuator.rest * ((1 - share) * curve->spread[i - 1] + share * curve->spread[i]);
}

}  // namespace softkin
