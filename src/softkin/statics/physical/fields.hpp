#pragma once

#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <softkin/statics/physical/spline_grid.hpp>

namespace softkin::physical {

/// The applied magnetic fields of a robot: their flux density and how it changes in space.
class Fields {
 public:
  /// model must outlive the object, and have magnetism.
  explicit Fields(const Model& model);

  /// What the commands make of the sources. A dipole grows with the share of the dead loads, since where it is at rest
  /// it would pull already.
  struct Setting {
    struct Source {
      double current = 0;                                   // [A]
      Vec3 position = Vec3::Zero(), moment = Vec3::Zero();  // [mm], [A m^2]
    };
    Vec3 uniform = Vec3::Zero();  // sum of what is the same everywhere [mT]
    std::vector<Source> sources;
    int moved_along = -1;  // axis: not the fields, but their derivative by a move of the sources along it

    [[nodiscard]] bool in_space() const;
  };
  [[nodiscard]] Setting setting(const Demand& demand) const;
  /// Derivative of the fields by the command of an actuator: [mT] becomes [mT per unit of the command].
  [[nodiscard]] Setting derivative(Index actuator, const Demand& demand) const;

  /// Is a field there that grows with the share of the dead loads?
  [[nodiscard]] bool any_dipole() const { return any_dipole_; }

  /// What changes in space, all but Setting::uniform, at a place [mm].
  ///
  /// source   loops: complete elliptic integrals, as in Simpson et al. 2001, "Simple analytic expressions for the
  ///          magnetic field of a circular current loop", of 4 a^2 rho^2 / (a^2 + r^2)^2, which is smooth on the axis;
  ///          dipole: mu_0 / (4 pi) (3 (m . r) r / r^5 - m / r^3); grid: SplineGrid
  /// second   are second derivatives asked for: they cost as much again; not of a setting that is moved
  /// returns  false outside a grid, on a wire and on a dipole
  bool flux(const Setting& setting, const Vec3& place, bool second, Flux& out) const;

 private:
  template <bool Second>
  bool sum(const Setting& setting, const Vec3& place, Flux& out) const;

  const Model& model_;
  const Magnetism& magnetism_;
  std::vector<std::unique_ptr<const SplineGrid>> grids_;  // per source; none: no grid
  bool any_dipole_ = false;
};

}  // namespace softkin::physical
