#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// The force with which the pressure in a chamber acts on a support that closes the chamber, see ChamberCap.
struct ChamberForce {
  Index actuator = -1;         // index into Model::actuators
  Vec3 force = Vec3::Zero();   // on the support [N]
  Vec3 moment = Vec3::Zero();  // the same, about the centre of the support's reaction [N mm]
};

/// Does a support close a chamber of the actuator?
[[nodiscard]] bool has_caps(const Actuator& actuator);

/// Adds the nodal forces of a pressure on the caps of a chamber, along the axes that supports hold.
///
/// The integral of N_i n p over the faces as they are, n out of the chamber: what the forces of equilibrium at the
/// vertices contain of the pressure that acts on supports in place of the robot.
///
/// positions  #V by 3 [mm]
/// pressure   gauge [MPa]
/// force      #V by 3 [N]
void add_cap_force(const Model& model, const Actuator& actuator, const Points& positions, double pressure,
                   Points& force);

/// Adds the derivative of these forces along moves of the vertices at constant pressure, #V by 3 [mm per unit].
void add_cap_force_change(const Model& model, const Actuator& actuator, const Points& positions, const Points& moves,
                          double pressure, Points& force);

/// Returns, for every support, the force and moment of each chamber that it closes.
///
/// centers    about which the moments are, for every support [mm]
/// pressures  gauge, by actuators [kPa]
[[nodiscard]] std::vector<std::vector<ChamberForce>> chamber_forces(const Model& model, const Points& positions,
                                                                    const std::vector<Vec3>& centers,
                                                                    const Eigen::VectorXd& pressures);

}  // namespace softkin
