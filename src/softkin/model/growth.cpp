#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/core/text.hpp>
#include <softkin/model/growth.hpp>
#include <softkin/model/pchip.hpp>

namespace softkin {

namespace {

void check_table(const TemperatureSpec& spec) {
  if (spec.table.size() < 2) throw InvalidInput("a table of temperatures needs at least two points");
  for (std::size_t i = 0; i < spec.table.size(); ++i) {
    const auto& [celsius, length] = spec.table[i];
    if (!std::isfinite(celsius) || !(length > 0 && std::isfinite(length)))
      throw InvalidInput("a table of temperatures needs finite ones, each with a length above 0, not " +
                         number(celsius) + " and " + number(length));
    if (i > 0 && !(celsius > spec.table[i - 1][0]))
      throw InvalidInput("the temperatures of a table must ascend, but " + number(celsius) + " degC follows " +
                         number(spec.table[i - 1][0]) + " degC");
  }
  if (!(spec.reference_C >= spec.table.front()[0] && spec.reference_C <= spec.table.back()[0]))
    throw InvalidInput("the reference of " + number(spec.reference_C) + " degC is outside the table, " +
                       number(spec.table.front()[0]) + " to " + number(spec.table.back()[0]) + " degC");
}

}  // namespace

GrowthCurve::GrowthCurve(const TemperatureSpec& spec) : reference_C_(spec.reference_C) {
  if (!std::isfinite(reference_C_)) throw InvalidInput("the reference of a temperature is not finite");
  if (spec.expansion_per_K.has_value() != spec.table.empty())
    throw InvalidInput("a growth by temperature needs an expansion per K or a table, one of the two");
  if (spec.expansion_per_K) {
    if (!std::isfinite(*spec.expansion_per_K)) throw InvalidInput("an expansion per K is not finite");
    expansion_per_K_ = *spec.expansion_per_K;
    return;
  }
  check_table(spec);
  for (const auto& [celsius, length] : spec.table) {
    celsius_.push_back(celsius);
    stretches_.push_back(length);
  }
  slopes_ = pchip_slopes(celsius_, stretches_);
  const double whole = at(reference_C_)[0];
  for (std::vector<double>* values : {&stretches_, &slopes_})
    for (double& value : *values) value /= whole;
}

std::array<double, 2> GrowthCurve::range_C() const {
  constexpr double any = std::numeric_limits<double>::infinity();
  if (celsius_.empty()) return {-any, any};
  return {celsius_.front(), celsius_.back()};
}

std::vector<double> GrowthCurve::values() const {
  if (celsius_.empty()) return {expansion_per_K_};
  std::vector<double> all = celsius_;
  all.insert(all.end(), stretches_.begin(), stretches_.end());
  return all;
}

/// Value and slope.
std::array<double, 2> GrowthCurve::at(double celsius) const {
  if (celsius_.empty()) return {1 + expansion_per_K_ * (celsius - reference_C_), expansion_per_K_};
  if (celsius <= celsius_.front())
    return {stretches_.front() + slopes_.front() * (celsius - celsius_.front()), slopes_.front()};
  if (celsius >= celsius_.back())
    return {stretches_.back() + slopes_.back() * (celsius - celsius_.back()), slopes_.back()};
  const auto above = std::upper_bound(celsius_.begin(), celsius_.end(), celsius);
  const auto i = static_cast<std::size_t>(above - celsius_.begin()) - 1;
  const double h = celsius_[i + 1] - celsius_[i], t = (celsius - celsius_[i]) / h;
  const double rise = stretches_[i + 1] - stretches_[i], a = h * slopes_[i], b = h * slopes_[i + 1];
  const double second = 3 * rise - 2 * a - b, third = a + b - 2 * rise;
  return {stretches_[i] + t * (a + t * (second + t * third)), (a + t * (2 * second + 3 * t * third)) / h};
}

GrowthStretch Growth::at(double stretch) const {
  if (directions.empty()) return {stretch, stretch};
  return {stretch, keeps_volume ? 1 / std::sqrt(stretch) : 1};
}

Growers growers_of(const Model& model) {
  Growers growers;
  if (model.growths.empty()) return growers;
  growers.tetrahedra.assign(model.elements.tetrahedra.size(), -1);
  growers.prisms.assign(model.elements.prisms.size(), -1);
  for (std::size_t g = 0; g < model.growths.size(); ++g) {
    for (const Index e : model.growths[g]->tetrahedra) growers.tetrahedra[e] = g;
    for (const Index e : model.growths[g]->prisms) growers.prisms[e] = g;
  }
  return growers;
}

}  // namespace softkin
