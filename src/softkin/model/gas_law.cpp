#include <softkin/model/gas_law.hpp>

namespace softkin {

double chamber_ratio(const SyringeSetup& setup, double absolute_kPa, double syringe_mm3) {
  const double atmosphere = setup.atmosphere_kPa;
  return (atmosphere * setup.chamber_mm3 + absolute_kPa * syringe_mm3 -
          (absolute_kPa - atmosphere) * (setup.syringe_mm3 + setup.tube_mm3)) /
         (absolute_kPa * setup.chamber_mm3);
}

double syringe_volume(const SyringeSetup& setup, double absolute_kPa, double ratio) {
  const double rest = setup.syringe_mm3 + setup.tube_mm3;
  return ratio * setup.chamber_mm3 + rest - setup.atmosphere_kPa * (setup.chamber_mm3 + rest) / absolute_kPa;
}

}  // namespace softkin
