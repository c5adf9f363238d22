#pragma once

namespace softkin {

/// The content of a sealed chamber, and its command: the whole amount, or the volume that a syringe has pushed. The
/// amount N has the volume N under atmospheric pressure; it fills the chamber, dead volumes and the rest of the
/// syringe.
///
/// Commands are in mL, under atmospheric pressure or pushed; volumes are in mm^3 and of the chamber alone; pressures
/// are in MPa relative to the atmosphere.
struct Filling {
  bool liquid = false;         // else a gas
  bool pushed = false;         // by a syringe; else the amount is commanded
  double exponent = 1;         // gas: n of p V^n = const; > 0
  double compressibility = 0;  // liquid [1/MPa]; >= 0
  double atmosphere_MPa = 0;   // absolute, > 0
  double dead_mm3 = 0;         // tubes and fittings
  double syringe_mm3 = 0;      // in the syringe before it pushes
  double chamber_mm3 = 0;      // at rest

  /// Does its volume change with its pressure?
  [[nodiscard]] bool yields() const { return !liquid || compressibility > 0; }
  /// Can its content have this pressure? A gas cannot be below a vacuum.
  [[nodiscard]] bool exists(double pressure) const { return liquid || atmosphere_MPa + pressure > 0; }

  /// Returns the volume of the chamber: N f(p) less the volume elsewhere, f(p) = (p_atm / (p_atm + p))^(1/n) of a gas,
  /// exp(-beta p) of a liquid. pressure: one that exists()
  [[nodiscard]] double volume(double command, double pressure) const;
  /// Returns minus its derivative by the pressure [mm^3/MPa]: 0 for an incompressible content, else above 0.
  [[nodiscard]] double compliance(double command, double pressure) const;
  /// Returns its derivative by the command [mm^3/mL].
  [[nodiscard]] double by_command(double pressure) const;
  /// The command under which a chamber has a volume and a pressure.
  [[nodiscard]] double command(double volume, double pressure) const;
  /// The amount by the same [mL under atmospheric pressure].
  [[nodiscard]] double amount_mL(double volume, double pressure) const;
  /// Returns the pressure of a compressible content in a volume; infinite where the volume is zero or less.
  [[nodiscard]] double pressure(double command, double volume) const;
  /// Returns the work on the content and on the atmosphere from atmospheric pressure to a volume of the chamber [mJ];
  /// minus its derivative by the volume is the pressure. It is infinite where the volume is zero or less.
  [[nodiscard]] double energy(double command, double volume) const;
  /// The command at rest [mL].
  [[nodiscard]] double rest() const;

 private:
  [[nodiscard]] double amount_mm3(double command) const;
  [[nodiscard]] double elsewhere_mm3(double command) const;
  [[nodiscard]] double fraction(double pressure) const;
};

}  // namespace softkin
