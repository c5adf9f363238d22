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

  /// The sources under a load state. The moment of a dipole grows with the load factor, since at its initial place the
  /// dipole already attracts the robot.
  struct Setting {
    struct Source {
      double current = 0;                                   // [A]
      Vec3 position = Vec3::Zero(), moment = Vec3::Zero();  // [mm], [A m^2]
    };
    Vec3 uniform = Vec3::Zero();  // sum of the uniform fields [mT]
    std::vector<Source> sources;
    int moved_along = -1;  // axis: not the fields, but their derivative by a move of the sources along it

    [[nodiscard]] bool in_space() const;
  };
  [[nodiscard]] Setting setting(const LoadState& load_state) const;
  /// Derivative of the fields by the command of an actuator: [mT] becomes [mT per unit of the command].
  [[nodiscard]] Setting derivative(Index actuator, const LoadState& load_state) const;

  /// Is there a dipole, whose field grows with the load factor?
  [[nodiscard]] bool any_dipole() const { return any_dipole_; }

  /// Computes the flux density that varies in space, all except Setting::uniform, at a point per lane [mm].
  ///
  /// source   loops: energy/loop_field.hpp; dipole: mu_0 / (4 pi) (3 (m . r) r / r^5 - m / r^3); grid: SplineGrid
  /// count    number of lanes in use
  /// second   are second derivatives requested: they double the cost, and are zero otherwise; not for a setting that is
  ///          a derivative by a move
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
