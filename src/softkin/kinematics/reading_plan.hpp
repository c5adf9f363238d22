#pragma once

#include <softkin/kinematics/estimator.hpp>

namespace softkin {

/// The part of an estimate that a plan needs: the derivatives of the shape by the estimated unknowns, and their
/// covariance.
struct PlanBasis {
  Points positions;                              // #V by 3 [mm]
  std::vector<Points> moves;                     // by each column of the covariance [mm per unit]
  Eigen::MatrixXd covariance;                    // to first order: of the numbers, then two tangents of each place
  std::size_t numbers = 0;                       // that were estimated
  explicit PlanBasis(const Estimate& estimate);  // of this estimate
};

/// A reading that is proposed.
struct PlannedReading {
  std::string name;           // column of it; of a further marker: marker_x_mm and so on at a vertex
  Index vertex = -1;          // where the further marker is; -1: a marker, a sensor or a measure of the scene
  Vec3 at_rest{0, 0, 0};      // of a marker [mm]
  double bits = 0;            // of information about all unknowns, mean of the estimates
  Eigen::VectorXd numbers{};  // standard deviations afterwards, in the units of the numbers, root mean square
  Eigen::VectorXd places{};   // root of the trace of each place's covariance afterwards [mm], the same
};

/// The further readings that are possible, and their accuracy.
struct PlanOptions {
  std::vector<Index> vertices{};              // where further markers may be
  std::array<double, readings> deviations{};  // of each kind of reading, in its unit; 0: none of the kind is looked at
  std::vector<PoseColumn> read{};             // existing columns
  int count = 3;                              // >= 1
};

/// Proposes the most informative readings, one after the other: markers at vertices, the scene's markers and sensors
/// that are not read, lengths of cables and volumes of chambers. Each is the one that minimises the determinant of the
/// covariance after those before it, in the mean over all estimates. There are fewer where no further reading gives
/// information.
///
/// bits    1/2 log2 det(I + S P S^T / deviation^2), S the slopes of the reading's coordinates, P the covariance
/// throws  InvalidInput: no estimate, a count below 1, no deviation above 0, a vertex that is not there
/// source  Fedorov 1972, D-optimal design, sequential
[[nodiscard]] std::vector<PlannedReading> plan_readings(const Model& model, const std::vector<PlanBasis>& estimates,
                                                        const PlanOptions& options);

}  // namespace softkin
