#pragma once

#include <Eigen/SparseCore>
#include <softkin/model/model.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <softkin/statics/supports/freedoms.hpp>

namespace softkin::physical {

/// The contribution of tendons with friction to a Newton step: how the tension of every segment changes with the shape,
/// for all q segments of the active tendons. It is not symmetric and couples all vertices of a tendon. It is therefore
/// not part of the factorisation, but a product of matrices with few columns.
struct TendonColumns {
  struct Tendon {
    Index begin = 0, count = 0;      // of its segments
    Index actuator = 0, memory = 0;  // its actuator; index of its first eyelet among the slips
    double creep = 1;                // [mm]
    double tension = 0;              // at the motor [N]
  };
  std::vector<Tendon> tendons{};
  Eigen::SparseMatrix<double> along{};  // unknowns by q: gradients of the segments' lengths
  Eigen::SparseMatrix<double>
      turns{};                 // unknowns by q: gradients of -log(tension), by the turn at the begin of each segment
  Eigen::VectorXd tensions{};  // of segments [N]
  Eigen::VectorXd limits{};    // mu theta at the eyelet where each segment begins [-]

  [[nodiscard]] Index count() const { return tensions.size(); }

  /// Returns the changes of the tensions under moves, a column each, that are due to changed turns [N].
  [[nodiscard]] Eigen::MatrixXd turned(const Eigen::Ref<const Eigen::MatrixXd>& moves) const;

  /// Returns the derivatives of the tensions by the segments' lengths, apart from the turns [N/mm]. Friction is
  /// linearised by its secants from `slips` to the slips after `lengthening`, or by its derivatives if that is zero.
  ///
  /// growth  ratio of the new to the current tension at the motor, per actuator [-]; empty: 1
  [[nodiscard]] Eigen::MatrixXd rates(const Eigen::VectorXd& slips, const Eigen::VectorXd& lengthening,
                                      const Eigen::VectorXd& growth) const;
};

/// Coulomb friction of cables, pulled at their first point, at every turn of their path. The tension behind eyelet i is
/// the tension before it times exp(-mu theta_i) if the cable slips there towards the motor, times exp(+mu theta_i) if
/// it slips away, and lies in between if it sticks. For each eyelet the cable length behind it at which friction is
/// zero is stored. Friction grows with the difference from that length and is fully mobilised at the creep. If the
/// cable slips farther, the stored length follows.
///
/// source     Euler, Eytelwein: the capstan; design: DESIGN.md, section 10
/// deviation  turns count as theta^2 / sqrt(theta^2 + 2e-3^2), which is smooth where the path is straight
class Tendons {
 public:
  /// model must outlive the object.
  explicit Tendons(const Model& model);

  [[nodiscard]] bool any() const { return remembered_ > 0; }
  [[nodiscard]] bool has_friction(Index actuator) const { return cables_[actuator].memory >= 0; }
  /// Returns the number of stored lengths, one per eyelet of every cable with friction.
  [[nodiscard]] std::size_t remembered() const { return remembered_; }

  /// Returns the stored lengths at which friction is zero: the cable lengths behind each eyelet [mm].
  [[nodiscard]] std::vector<double> lengths(const Points& positions) const;
  /// Returns the stored lengths that give these slips. If `slips` are of another robot, without friction, every cable
  /// has slipped towards the motor by the creep, as after being pulled.
  [[nodiscard]] std::vector<double> lengths(const Points& positions, const Eigen::VectorXd& slips) const;
  /// Moves the stored lengths to within the creep of the current ones.
  void slide(const Points& positions, std::vector<double>& eyelets) const;
  /// Returns the slip of every eyelet, towards the motor, over its creep [-]; 0 if no lengths are stored.
  [[nodiscard]] Eigen::VectorXd slips(const Iterate& at) const;

  // The functions below are for one cable with friction.
  /// Returns the tensions of its segments over the tension at the motor [-].
  [[nodiscard]] Eigen::VectorXd fractions(Index actuator, const Iterate& at) const;
  /// Computes its nodal forces per tension at the motor, #V by 3 [-].
  void pull(Index actuator, const Iterate& at, Points& force) const;
  /// Adds the change of its nodal forces under moves of the vertices that is due to changed tensions [N].
  void add_response(Index actuator, double tension, const Iterate& at, const Points& moves, Points& force) const;
  [[nodiscard]] TendonForces forces(Index actuator, double tension, const Iterate& at) const;

  /// Returns the columns of all active tendons with friction at an iterate.
  [[nodiscard]] TendonColumns columns(const Iterate& at, const supports::Freedoms& freedoms) const;

 private:
  struct Cable {
    Index memory = -1;  // index of its first eyelet; negative: no friction
    Index count = 0;    // number of its eyelets and of its segments
    double friction = 0, sheath = 0, creep = 1;
  };
  struct TendonPath;
  [[nodiscard]] const std::vector<EmbeddedPoint>& points_of(Index actuator) const;
  [[nodiscard]] TendonPath path(Index actuator, const Points& positions) const;
  [[nodiscard]] TendonPath path(Index actuator, const Iterate& at) const;
  void spread(Index actuator, const std::vector<Vec3>& vectors, Points& force) const;

  const Model& model_;
  std::vector<Cable> cables_;  // per actuator
  Index remembered_ = 0;
};

}  // namespace softkin::physical
