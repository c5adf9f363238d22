#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/compile/samples.hpp>
#include <softkin/model/growth.hpp>

namespace softkin {

namespace {

constexpr double absolute_zero = -273.15;  // [degC]

GrowthCurve checked_curve(const ActuatorSpec& spec, const TemperatureSpec& temperature) {
  try {
    return GrowthCurve(temperature);
  } catch (const InvalidInput& error) {
    refuse(spec, std::string("grows by its temperature: ") + error.what());
  }
}

void check_temperature(const ActuatorSpec& spec, const GrowthCurve& curve) {
  if (spec.rest != curve.reference_C())
    refuse(spec, "is at rest at " + number(spec.rest) + " degC, and all that grows with it must be, not at " +
                     number(curve.reference_C()) + " degC");
  if (const auto [low, high] = curve.range_C(); spec.low < low || spec.high > high)
    refuse(spec, "has the range " + interval_text(spec.low, spec.high) + " degC, but its table ends at " +
                     number(spec.low < low ? low : high) + " degC");
  for (const double celsius : {spec.low, spec.high})
    if (!(curve.stretch(celsius) > 0))
      refuse(spec, "would shrink to a stretch of " + number(curve.stretch(celsius)) + " at " + number(celsius) +
                       " degC: is its expansion per K?");
}

void check_range(const ActuatorSpec& spec) {
  const bool heated = spec.control == Control::load;
  const double least = heated ? absolute_zero : 0;
  const bool above = heated ? spec.low >= least : spec.low > least;
  if (!(above && spec.low <= spec.high && std::isfinite(spec.high)))
    refuse(spec, "needs a range with " + std::string(heated ? "-273.15 <= low <= high [degC]" : "0 < low <= high") +
                     ", not " + interval_text(spec.low, spec.high));
  if (!heated && spec.rest != 1) refuse(spec, "cannot have a stretch at rest other than 1");
}

/// Takes the elements of the body among a part's.
void take_growing(const Compilation& c, const ActuatorSpec& spec, const std::string& name, Growers& growers,
                  Growth& growth) {
  const Region& region = c.regions.find(name, spec.origin);
  const Index number_of = c.model.growths.size();
  const auto take = [&](const std::vector<Index>& found, const std::vector<Index>& at, std::vector<Index>& grower,
                        std::vector<Index>& elements, const char* kind) {
    for (const Index i : found) {
      const Index e = at[i];
      if (e < 0) continue;
      Index& own = grower[e];
      if (own >= 0) {
        const Index other = c.model.growths[own]->actuator;
        const std::string whose =
            other == growth.actuator ? "lets " : "and actuator '" + c.spec.actuators[other].name + "' both let ";
        refuse(spec,
               whose + kind + " " + std::to_string(i) + " (from 0) grow" + (other == growth.actuator ? " twice" : ""));
      }
      own = number_of;
      elements.push_back(e);
    }
  };
  take(region.tetrahedra, c.tetrahedron_at, growers.tetrahedra, growth.tetrahedra, "tetrahedron");
  take(region.prisms, c.prism_at, growers.prisms, growth.prisms, "prism");
  if (growth.tetrahedra.empty() && growth.prisms.empty())
    refuse(spec, "has nothing that grows: region '" + name + "' holds no element of the body");
  for (const Index e : growth.prisms)
    if (const Index dea = c.model.elements.prism_roles[e].actuator; dea >= 0)
      refuse(spec, "lets the layer of dea '" + c.model.actuators[dea].name +
                       "' grow, which has an active stretch of its own");
}

void add_growth(Compilation& c, Index actuator, const GrowthPart& part, Growers& growers) {
  const ActuatorSpec& spec = c.spec.actuators[actuator];
  auto growth = std::make_shared<Growth>();
  growth->actuator = actuator;
  take_growing(c, spec, part.region, growers, *growth);
  growth->keeps_volume = part.keeps_volume;
  if (part.temperature) growth->temperature = checked_curve(spec, *part.temperature);
  if (part.direction) {
    const std::string owner = "actuator '" + spec.name + "': its direction";
    const Directions directions(*part.direction, owner, spec.origin);
    for (const Index e : growth->tetrahedra) growth->directions.push_back(directions.of(c.model, e));
    for (const Index e : growth->prisms)
      growth->directions.push_back(
          directions.of(c.model, c.model.elements.tetrahedra.size() + static_cast<std::size_t>(e)));
  }
  c.model.growths.push_back(std::move(growth));
}

}  // namespace

void check_growth(const ActuatorSpec& spec, const GrowthSpec& growth, Formulation formulation) {
  if (growth.parts.empty()) refuse(spec, "is a growth: it needs to say what grows");
  if (formulation != Formulation::physical) refuse(spec, "is a growth: that needs the physical formulation");
  const bool heated = growth.parts.front().temperature.has_value();
  if (spec.control != (heated ? Control::load : Control::ratio))
    refuse(spec, heated ? "is commanded by its temperature" : "is a growth: it is commanded by its stretch");
  check_range(spec);
  for (const GrowthPart& part : growth.parts) {
    if (part.keeps_volume && !part.direction) refuse(spec, "keeps its volume as it grows, and so needs a direction");
    if (part.temperature.has_value() != heated)
      refuse(spec, "lets one region grow by a temperature and another by a stretch: one command does one of the two");
    if (heated) check_temperature(spec, checked_curve(spec, *part.temperature));
  }
}

void compile_growth(Compilation& c) {
  Growers growers{std::vector<Index>(c.model.elements.tetrahedra.size(), -1),
                  std::vector<Index>(c.model.elements.prisms.size(), -1)};
  for (std::size_t a = 0; a < c.spec.actuators.size(); ++a) {
    const auto* growth = c.spec.actuators[a].as<GrowthSpec>();
    if (growth == nullptr) continue;
    c.model.actuators[a].drive = GrowthDrive{static_cast<Index>(c.model.growths.size())};
    for (const GrowthPart& part : growth->parts) add_growth(c, a, part, growers);
  }
}

}  // namespace softkin
