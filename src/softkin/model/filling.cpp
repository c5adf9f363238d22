#include <cmath>
#include <limits>
#include <softkin/model/filling.hpp>

namespace softkin {

namespace {

constexpr double mm3_per_mL = 1000;
constexpr double nowhere = std::numeric_limits<double>::infinity();

}  // namespace

double Filling::amount_mm3(double command) const {
  return pushed ? chamber_mm3 + dead_mm3 + syringe_mm3 : mm3_per_mL * command;
}

/// What is not in the chamber.
double Filling::elsewhere_mm3(double command) const {
  return pushed ? dead_mm3 + syringe_mm3 - mm3_per_mL * command : dead_mm3;
}

/// Of its volume under atmospheric pressure.
double Filling::fraction(double pressure) const {
  if (liquid) return std::exp(-compressibility * pressure);
  return std::pow(atmosphere_MPa / (atmosphere_MPa + pressure), 1 / exponent);
}

double Filling::volume(double command, double pressure) const {
  return amount_mm3(command) * fraction(pressure) - elsewhere_mm3(command);
}

double Filling::compliance(double command, double pressure) const {
  const double whole = amount_mm3(command) * fraction(pressure);
  return liquid ? compressibility * whole : whole / (exponent * (atmosphere_MPa + pressure));
}

double Filling::by_command(double pressure) const {
  return mm3_per_mL * (pushed ? 1 : fraction(pressure));
}

double Filling::command(double volume, double pressure) const {
  if (!pushed) return amount_mL(volume, pressure);
  return (volume + dead_mm3 + syringe_mm3 - amount_mm3(0) * fraction(pressure)) / mm3_per_mL;
}

double Filling::amount_mL(double volume, double pressure) const {
  return (pushed ? amount_mm3(0) : (volume + dead_mm3) / fraction(pressure)) / mm3_per_mL;
}

double Filling::pressure(double command, double volume) const {
  const double whole = volume + elsewhere_mm3(command);
  if (!(whole > 0)) return nowhere;
  const double log = std::log(amount_mm3(command) / whole);
  return liquid ? log / compressibility : atmosphere_MPa * std::expm1(exponent * log);
}

double Filling::energy(double command, double volume) const {
  const double amount = amount_mm3(command), whole = volume + elsewhere_mm3(command);
  if (!(whole > 0)) return nowhere;
  const double log = std::log(whole / amount);
  if (liquid) return compressibility > 0 ? (whole * log - whole + amount) / compressibility : 0;
  const double inner = exponent == 1 ? -log : std::expm1((1 - exponent) * log) / (exponent - 1);
  return atmosphere_MPa * (whole - amount + amount * inner);
}

double Filling::rest() const {
  return pushed ? 0 : (chamber_mm3 + dead_mm3) / mm3_per_mL;
}

}  // namespace softkin
