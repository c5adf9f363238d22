#pragma once

#include <softkin/energy/magnet_blocks.hpp>
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

  /// What changes in space, all but Setting::uniform, at a place of every lane [mm].
  ///
  /// source   loops: energy/loop_field.hpp; dipole: mu_0 / (4 pi) (3 (m . r) r / r^5 - m / r^3); grid: SplineGrid
  /// count    lanes that matter
  /// second   are second derivatives asked for: they cost as much again, and are zero otherwise; not of a setting that
  ///          is moved
  /// returns  false where one of those lanes is outside a grid, on a wire or on a dipole
  bool flux(const Setting& setting, const energy::Pack3& places, Index count, bool second,
            energy::FluxPoint& out) const;

 private:
  /// Has it grids or dipoles, which are summed lane by lane?
  [[nodiscard]] bool lane_by_lane(const Setting& setting) const;
  template <bool Second>
  bool sum(const Setting& setting, const Vec3& place, Flux& out) const;
  bool flux_of_lane(const Setting& setting, const Vec3& place, bool second, Flux& out) const;

  const Model& model_;
  const Magnetism& magnetism_;
  std::vector<std::unique_ptr<const SplineGrid>> grids_;  // per source; none: no grid
  bool any_dipole_ = false;
};

}  // namespace softkin::physical
