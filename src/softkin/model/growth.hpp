#pragma once

#include <array>
#include <optional>
#include <softkin/model/model.hpp>

namespace softkin {

/// Stretch by temperature.
class GrowthCurve {
 public:
  /// throws  InvalidInput: neither a coefficient nor a table, or both; less than two points; numbers that are not
  ///         finite, do not ascend or are not above 0; a reference outside the table
  explicit GrowthCurve(const TemperatureSpec& spec);

  /// Linear beyond the table.
  [[nodiscard]] double stretch(double celsius) const { return at(celsius)[0]; }
  [[nodiscard]] double slope(double celsius) const { return at(celsius)[1]; }  // [1/K]
  [[nodiscard]] double reference_C() const { return reference_C_; }
  /// All that it depends on beside the reference: the coefficient [1/K], or temperatures [degC], then stretches.
  [[nodiscard]] std::vector<double> values() const;
  /// First and last temperature that are known; infinite where there is a coefficient.
  [[nodiscard]] std::array<double, 2> range_C() const;

 private:
  [[nodiscard]] std::array<double, 2> at(double celsius) const;

  double reference_C_, expansion_per_K_ = 0;
  std::vector<double> celsius_, stretches_, slopes_;
};

/// The stress-free stretches of grown material: lengths along its direction, and across it, over those at rest.
struct GrowthStretch {
  /// Stretches [-].
  double along = 1, across = 1;
  /// Over that at rest [-].
  [[nodiscard]] double volume() const { return along * across * across; }
};

/// A compiled growth, F = F_e G: per volume at rest its elements have the energy det(G) W(F G^-1), with
/// G = along d d^T + across (I - d d^T).
///
/// source  Rodriguez, Hoger, McCulloch, J. Biomech. 27(4), 1994
struct Growth {
  Index actuator = -1;                     // that commands it; several may have the same
  std::vector<Index> tetrahedra, prisms;   // of the model
  std::vector<Vec3> directions;            // of these, one after another, of unit length; none: isotropic
  bool keeps_volume = false;               // with a direction: as much narrower as it is longer
  std::optional<GrowthCurve> temperature;  // the command is one [degC]; none: it is the stretch

  /// Of a command: itself, or by the temperature that it is [-].
  [[nodiscard]] double stretch(double command) const { return temperature ? temperature->stretch(command) : command; }
  /// Of the stretch by the command.
  [[nodiscard]] double slope(double command) const { return temperature ? temperature->slope(command) : 1; }
  [[nodiscard]] GrowthStretch at(double stretch) const;
};

/// By which of Model::growths each tetrahedron and prism grows; -1: by none. Empty: nothing grows.
struct Growers {
  std::vector<Index> tetrahedra, prisms;  // a place in Model::growths for each element
};
[[nodiscard]] Growers growers_of(const Model& model);  // by its growths

}  // namespace softkin
