#pragma once

#include <optional>
#include <softkin/model/model.hpp>
#include <softkin/statics/chamber_caps.hpp>
#include <softkin/statics/contact_forces.hpp>

namespace softkin {

/// Returns the measure of an actuator in a shape, over its value at rest [-], whatever its control: polyline length,
/// sum of the prisms' mean areas, or volume of the chamber, Eq. (17): of its elements (target-shape), enclosed by its
/// boundary (physical) or by its surface.
[[nodiscard]] double achieved_ratio(const Model& model, const Actuator& actuator, const Points& positions);

/// Cauchy stress of every element, in their order [MPa]: at that of its integration points where von Mises' is largest.
struct ElementStress {
  std::vector<double> von_mises;                 // of each element
  std::vector<std::array<double, 3>> principal;  // descending; tension is positive
};

/// Force and moment of magnetic fields on the robot.
struct MagneticLoad {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 moment = Vec3::Zero();  // about the centre [N mm]
  Vec3 center = Vec3::Zero();  // of the magnetic volume in the shape [mm]
};

/// State of a cable with friction in a shape.
struct TendonForces {
  double end_N = 0;   // tension at its far end [N]
  double sticks = 0;  // fraction of the largest possible friction at places that stick [-]
};

/// State of a fibre in a shape.
struct FibreForces {
  double largest_N = 0, min_N = 0, mean_N = 0;  // tension along it; below 0: compression
  Vec3 where = Vec3::Zero();                    // the largest [mm]
  double stretch = 1;                           // length over that at rest [-]
  double slack = 0;                             // fraction of its length without force [-]
};

/// State of a sheet in a shape.
struct LayerForces {
  double largest_N_mm = 0, min_N_mm = 0;  // principal tension per present width; below 0: compression
  Vec3 where = Vec3::Zero();              // the largest [mm]
  double strain = 0;                      // largest principal stretch minus 1 [-]
  double wrinkled = 0, slack = 0;         // fractions of its area with tension in one direction, and without
};

/// Deformation of every element, tetrahedra first, then prisms (their strain at the centre). Of order 2: the least
/// volume ratio, det F, at the corners and at the four points with which the energy is integrated, and the strain at
/// that of the four where its magnitude is largest.
struct ElementDeformation {
  std::vector<double> volume_ratio;           // [-]; <= 0: inverted, of order 2 somewhere
  std::vector<std::array<double, 3>> strain;  // principal stretches minus 1, descending [-]; the least is negated
                                              // with the sign of det F in an inverted element
  std::vector<std::array<double, 2>> range;   // least and greatest principal strain in the element [-]; of order 2: of
                                              // the four points
  // Physical, and of Statics::measured() alone; else empty.
  ElementStress stress;
  Eigen::VectorXd multipliers;  // m: tension [N], gauge pressure [kPa], voltage of a dea [kV]
  Points reactions;  // #V by 3: forces of the supports on the robot at the vertices that they hold [N]; 0 along free
                     // axes; without pressures of chambers on the supports themselves, see ChamberForce
  std::optional<ContactForces> contacts;               // where the robot may touch anything
  std::optional<MagneticLoad> magnetic;                // where there is a magnetic field
  std::vector<std::optional<TendonForces>> tendons{};  // per actuator where any cable has friction; of those
  std::vector<FibreForces> fibres{};                   // of each
  std::vector<LayerForces> layers{};                   // the same
};
[[nodiscard]] ElementDeformation deformation_of(const Model& model, const Points& positions);  // of #V by 3 [mm]

/// The reaction of an entry of the scene's `fixed`: the force and moment that the support exerts on the robot. The
/// reactions, the loads on the robot and the pressures on the walls of its chambers are in equilibrium. Where a support
/// closes a chamber, the pressure also acts on the support itself; that force is no part of the reaction.
struct Reaction {
  Vec3 force = Vec3::Zero();             // that the support exerts on the robot [N]
  Vec3 moment = Vec3::Zero();            // the same, about the centre [N mm]
  Vec3 center = Vec3::Zero();            // mean of the vertices that it holds, where they are [mm]
  std::vector<ChamberForce> chambers{};  // of each chamber that the support closes, on the support
};
/// Of every support, in their order; deformation: of positions, with its reactions; the forces of chambers follow where
/// it has multipliers.
[[nodiscard]] std::vector<Reaction> reactions(const Model& model, const Points& positions,
                                              const ElementDeformation& deformation);

/// The largest stresses of the body (not of the membrane of a dea) and where they are.
struct StressExtremes {
  /// One value and its place.
  struct Extreme {
    double value = 0;        // [MPa]
    Vec3 at = Vec3::Zero();  // the element's centroid [mm]
    std::string region;      // its first; empty: none
  };
  Extreme von_mises, greatest, least;  // the two: of the principal stresses
};
/// None without stresses.
[[nodiscard]] std::optional<StressExtremes> stress_extremes(const Model& model, const Points& positions,
                                                            const ElementDeformation& deformation);

/// Distribution of strain over the body's volume, as in the paper's Fig. 6. In fractions, percentile_95 and beyond,
/// each body element counts with its principal strain of largest magnitude; fractions are of the body's rest volume.
/// The prisms of a dea are no part of the body.
struct StrainHistogram {
  std::vector<double> edges;       // of the bins, one more than fractions [-]
  std::vector<double> fractions;   // sum to 1
  double least = 0, greatest = 0;  // of the principal strains, whatever their magnitude
  double percentile_95 = 0;        // of the magnitude
  /// The part of a material that is strained beyond its linear range.
  struct Beyond {
    std::string region;       // of the material
    double linear_range = 0;  // largest |principal strain| of it [-]
    double fraction = 0;      // of the material's volume whose magnitude is beyond
  };
  std::vector<Beyond> beyond;  // materials that state a linear range
};
/// Of one shape.
[[nodiscard]] StrainHistogram strain_histogram(const Model& model, const ElementDeformation& deformation);

}  // namespace softkin
