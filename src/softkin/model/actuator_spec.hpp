#pragma once

#include <array>
#include <memory>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/model/actuator_curve.hpp>
#include <softkin/model/direction.hpp>
#include <softkin/model/selectors.hpp>
#include <variant>

namespace softkin {

struct FieldSource;       // magnetic_field.hpp
enum class FieldCommand;  // the same

/// The quantity that the user commands. ratio: length, area or volume over that at rest [-]; load: tension [N], gauge
/// pressure [kPa], voltage of a dea [kV], or the quantity of a magnetic field; filling: the content of a sealed chamber
/// [mL].
enum class Control { ratio, load, filling };

/// The content of a sealed chamber as the user describes it.
struct FillingSpec {
  bool liquid = false;               // else a gas
  double exponent = 1;               // gas: n of p V^n = const, > 0
  double compressibility = 0;        // liquid [1/MPa], >= 0
  double dead_mL = 0;                // tubes and fittings, >= 0
  std::optional<double> syringe_mL;  // before it pushes, > 0; the pushed volume is commanded; none: the amount
  double atmosphere_kPa = 101.325;   // absolute, > 0
};

/// How the command of a target-shape actuator is distributed over its elements, with a_i the ratio of element i, u_i
/// its measure at rest, and sum a_i u_i = a U, Eqs. (6)-(8). minimum_norm: the change of the current ratios with the
/// smallest norm; uniform: the same ratio for all; proportional: a_i in proportion to the current ratios.
enum class Distribution { minimum_norm, uniform, proportional };

/// A number for some prisms of the mesh.
struct PrismValues {
  std::vector<Index> prisms;    // from 0
  std::vector<double> values;   // of each of them
  std::vector<Origin> origins;  // of each
};

/// A cable, pulled at its first point.
struct CableSpec {
  std::vector<PointRef> points{};  // at least two, in order
  std::vector<PointRef> apexes{};  // third corner of each gap's triangle; none: found by compile()
  double spacing = 0;              // how often it is guided inside the body [mm]; 0: at its points
  double friction = 0;             // Coulomb's, where it turns, >= 0; pulled at its first point; physical
  double sheath_friction = 0, sheath_turns_degrees = 0;  // the same of a sheath before that
};

/// A chamber: by its elements, by a surface or a wall around it, or several of them that are connected; none of these,
/// physical: the only empty space in the body.
struct PneumaticSpec {
  std::optional<std::string> region{};       // of volume: its elements
  std::optional<TriangleSurface> surface{};  // around it [mm]
  std::optional<std::string> wall{};         // region of faces around it
  std::optional<Vec3> void_at{};             // physical: a point in the empty space of the body that it is [mm]
  std::vector<std::string> connected{};      // physical: two regions or more, of elements or of faces: chambers that
                                             // have one common filling
  std::optional<FillingSpec> filling{};      // of control filling
};

/// A layer of a dielectric elastomer.
struct DeaSpec {
  std::string region{};                    // of volume: its prisms
  double prestretch = 1;                   // under voltage: area without force, over that in the mesh [-], > 0
  std::optional<PrismValues> fractions{};  // under voltage: fraction of it at each prism [-]; none: all of it
};

/// A command of a magnetic field. Actuators with the same source command the same field. Physical.
struct FieldSpec {
  std::shared_ptr<const FieldSource> source{};  // which may be that of several actuators
  FieldCommand command{};                       // which quantity of it is commanded
};

/// How a growth follows a temperature: by a coefficient, or by a table of stretches.
struct TemperatureSpec {
  double reference_C = 20;                     // where nothing has grown
  std::optional<double> expansion_per_K;       // linear: stretch = 1 + this times the difference
  std::vector<std::array<double, 2>> table{};  // instead: temperature [degC], ascending, and length [any unit], > 0
};

/// Elements that grow by one law.
struct GrowthPart {
  std::string region;                            // of volume: its elements
  std::optional<DirectionSpec> direction{};      // along which it stretches; none: the same in all directions
  bool keeps_volume = false;                     // with a direction: as much narrower as it is longer
  std::optional<TemperatureSpec> temperature{};  // commanded; none: the stretch is
};

/// Residual strain that is commanded: swelling, thermal expansion, growth, shape memory.
struct GrowthSpec {
  std::vector<GrowthPart> parts{};  // at least one; one command for all, a stretch or a temperature
};

/// What an actuator is.
using DriveSpec = std::variant<PneumaticSpec, CableSpec, DeaSpec, FieldSpec, GrowthSpec>;

/// An actuator as the user describes it.
struct ActuatorSpec {
  std::string name;                  // for commands, messages and columns of tables
  DriveSpec drive;                   // what it is
  std::string robot;                 // of several: whose elements, gaps and empty spaces count; empty: all
  Control control = Control::ratio;  // which quantity is commanded; load and filling: physical
  double low = 0, high = 0;          // range [-]: 0 < low <= high; tension [N], voltage [kV]: 0 <= low;
                                     // pressure [kPa]: any; filling [mL]: 0 < low, pushed: any
  double rest = 1;                   // value without a command: a dea's prestretch; load control: 0;
                                     // filling: found by compile(); else 1
  double factor = 1, offset = 0;     // tension and pressure: the acting value is factor times the command plus offset
                                     // [N, kPa]; factor > 0
  double backlash = 0;               // the same: fall of a command before the acting value falls [N, kPa], >= 0
  double weight = 5;                 // w of Eq. (9), > 0
  Distribution distribution = Distribution::minimum_norm;  // of the command over its elements; target-shape
  std::optional<ActuatorCurve> curve;  // of a chamber or a dea under ratio control: ratio by pressure or voltage
  Branch branch = Branch::loading;     // of the curve, where a command names none
  Origin origin;                       // of its entry, for messages

  /// Is it of a kind.
  template <class Kind>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<Kind>(drive);
  }
  /// What it is as one of a kind; null: it is of another.
  template <class Kind>
  [[nodiscard]] const Kind* as() const {
    return std::get_if<Kind>(&drive);
  }
  /// The same, to be changed.
  template <class Kind>
  [[nodiscard]] Kind* as() {
    return std::get_if<Kind>(&drive);
  }
};

}  // namespace softkin
