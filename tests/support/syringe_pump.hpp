#pragma once

#include <functional>
#include <stdexcept>

namespace softkin::testing {

/// A chamber, tube and syringe of closed air, in any one unit of volume; pressures absolute.
struct ClosedAir {
  double chamber = 0, tube = 0, syringe = 0, atmosphere = 100;

  /// Returns the pressure by p V = constant, for a volume delivered by the syringe and a ratio of the chamber.
  [[nodiscard]] double pressure(double given, double ratio) const {
    return atmosphere * (chamber + tube + syringe) / (ratio * chamber + tube + syringe - given);
  }
};

/// Where a chamber comes to rest: its own pressure at a ratio, which rises, is that of the air. By bisection.
inline double equilibrium_ratio(const ClosedAir& air, double given,
                                const std::function<double(double)>& chamber_pressure, double low, double high) {
  const auto excess = [&](double ratio) { return chamber_pressure(ratio) - air.pressure(given, ratio); };
  if (excess(low) > 0 || excess(high) < 0) throw std::runtime_error("the chamber comes to rest elsewhere");
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? high : low) = middle;
  }
  return (low + high) / 2;
}

}  // namespace softkin::testing
