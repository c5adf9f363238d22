#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

Index marker_of(const Model& model, const FootSpec& spec) {
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    if (model.markers[m].name == spec.marker) return static_cast<Index>(m);
  throw InvalidInput(spec.origin, "a foot stands at marker '" + spec.marker + "', which the robot does not have");
}

void check_friction(const FootSpec& spec, double friction, const char* direction) {
  if (!(friction >= 0) || !std::isfinite(friction))
    throw InvalidInput(spec.origin, "foot '" + spec.marker + "': the friction " + direction +
                                        " must be 0 N or more, not " + number_text(friction));
}

}  // namespace

void compile_feet(Compilation& c) {
  const std::vector<FootSpec>& feet = c.spec.feet;
  if (feet.empty()) return;
  if (feet.size() != 2)
    throw InvalidInput(feet.back().origin, "a robot walks on two feet, the rear one and the front one, not on " +
                                               std::to_string(feet.size()));
  for (const FootSpec& spec : feet) {
    check_friction(spec, spec.forward, "forward");
    check_friction(spec, spec.backward, "backward");
    c.model.feet.push_back({marker_of(c.model, spec), spec.forward, spec.backward});
  }
  if (c.model.feet[0].marker == c.model.feet[1].marker)
    throw InvalidInput(feet[1].origin, "both feet stand at marker '" + feet[1].marker + "'");
}

}  // namespace softkin
