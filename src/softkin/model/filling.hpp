#pragma once

namespace softkin {

/// What is sealed in a chamber, and what is commanded of it: its whole amount, or what a syringe has pushed of it. All
/// of it is one amount N, which has the volume N under atmospheric pressure, and fills the chamber, dead volumes and
/// what is left in the syringe.
///
/// Here commands are in mL under atmospheric pressure or pushed, volumes in mm^3 and of the chamber alone, pressures in
/// MPa above that of the atmosphere.
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
  [[nodiscard]] bool gives_way() const { return !liquid || compressibility > 0; }
  /// Is there anything under so much pressure: no gas is below a vacuum.
  [[nodiscard]] bool exists(double pressure) const { return liquid || atmosphere_MPa + pressure > 0; }

  /// Of the chamber: N f(p) less what is elsewhere, f(p) = (p_atm / (p_atm + p))^(1/n) of a gas, exp(-beta p) of a
  /// liquid. pressure: one that exists()
  [[nodiscard]] double volume(double command, double pressure) const;
  /// Its derivative by the pressure, with the other sign [mm^3/MPa]: 0 where nothing gives way, else above 0.
  [[nodiscard]] double compliance(double command, double pressure) const;
  /// Its derivative by the command [mm^3/mL].
  [[nodiscard]] double by_command(double pressure) const;
  /// The command under which a chamber has a volume and a pressure.
  [[nodiscard]] double command(double volume, double pressure) const;
  /// The amount by the same [mL under atmospheric pressure].
  [[nodiscard]] double amount_mL(double volume, double pressure) const;
  /// The pressure in a volume, of what gives way. Infinite where the volume is nothing or less.
  [[nodiscard]] double pressure(double command, double volume) const;
  /// Work done on it and on the atmosphere to bring it from atmospheric pressure to where the chamber has a volume
  /// [mJ]; minus its derivative by that is the pressure. Infinite where the volume is nothing or less.
  [[nodiscard]] double energy(double command, double volume) const;
  /// The command at rest [mL].
  [[nodiscard]] double rest() const;

 private:
  [[nodiscard]] double amount_mm3(double command) const;
  [[nodiscard]] double elsewhere_mm3(double command) const;
  [[nodiscard]] double share(double pressure) const;
};

}  // namespace softkin
