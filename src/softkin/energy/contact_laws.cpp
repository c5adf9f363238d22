#include <cmath>
#include <softkin/energy/contact_laws.hpp>

namespace softkin::energy {

LengthLaw barrier(double gap, double reach) {
  if (!(gap < reach)) return {};
  const double z = gap / reach, less = (gap - reach) / reach, fraction = less / z;
  const double logarithm = z < 0.5 ? std::log(z) : std::log1p(less);  // each to rounding
  return {-reach * less * less * logarithm, -less * (2 * logarithm + fraction),
          (fraction * (fraction - 4) - 2 * logarithm) / reach};
}

LengthLaw friction(double slip, double creep) {
  if (!(slip < creep)) return {slip - creep / 3, 1, 0};
  const double y = slip / creep;
  return {creep * y * y * (1 - y / 3), y * (2 - y), 2 * (1 - y) / creep};
}

}  // namespace softkin::energy
