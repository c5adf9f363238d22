#pragma once

#include <Eigen/SparseCore>
#include <softkin/model/model.hpp>
#include <softkin/statics/deformation.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <softkin/statics/supports/freedoms.hpp>

namespace softkin::physical {

/// What tendons that rub add to a Newton step: how the tension of every segment follows moves of the shape, of all
/// tendons that pull, q segments together. No factor holds it, as it is not symmetric and couples all of a tendon; it
/// is of few columns.
struct TendonColumns {
  struct Tendon {
    Index begin = 0, count = 0;      // of its segments
    Index actuator = 0, memory = 0;  // of its first eyelet among slips
    double creep = 1;                // [mm]
    double tension = 0;              // at the motor [N]
  };
  std::vector<Tendon> tendons{};
  Eigen::SparseMatrix<double> along{};  // unknowns by q: slopes of the segments' lengths
  Eigen::SparseMatrix<double>
      turns{};                 // the same: of the tensions' logarithms by the turns where segments begin, times -1
  Eigen::VectorXd tensions{};  // of segments [N]
  Eigen::VectorXd limits{};    // mu theta of the eyelet where each begins [-]

  [[nodiscard]] Index count() const { return tensions.size(); }

  /// How tensions follow moves, a column each, by the turns that change [N].
  [[nodiscard]] Eigen::MatrixXd turned(const Eigen::Ref<const Eigen::MatrixXd>& moves) const;

  /// How tensions follow the segments' lengths beside that [N/mm]: friction is taken by its secants from these slips to
  /// those after the segments have become longer by so much; by its slopes where that is nothing.
  ///
  /// growth  per actuator, of tensions at the motor meanwhile, over what they are [-]; empty: 1
  [[nodiscard]] Eigen::MatrixXd rates(const Eigen::VectorXd& slips, const Eigen::VectorXd& lengthening,
                                      const Eigen::VectorXd& growth) const;
};

/// Coulomb friction of cables, pulled at their first point, at every turn of their way: the tension behind eyelet i is
/// that before it times exp(-mu theta_i) where the cable slips there towards the motor, times exp(+mu theta_i) where it
/// slips away, and between where it sticks. Each eyelet remembers the length beyond it at which it does not rub;
/// friction grows with the difference and is whole at the creep; where it slips farther what is remembered follows.
///
/// source     Euler, Eytelwein: the capstan; design: DESIGN.md, section 10
/// deviation  turns count theta^2 / sqrt(theta^2 + 2e-3^2), which is smooth where the way is straight
class Tendons {
 public:
  /// model must outlive the object.
  explicit Tendons(const Model& model);

  [[nodiscard]] bool any() const { return remembered_ > 0; }
  [[nodiscard]] bool rubs(Index actuator) const { return cables_[actuator].memory >= 0; }
  /// Numbers that are remembered: per eyelet of every cable that rubs.
  [[nodiscard]] std::size_t remembered() const { return remembered_; }

  /// What is remembered where nothing rubs: the lengths beyond each eyelet [mm].
  [[nodiscard]] std::vector<double> lengths(const Points& positions) const;
  /// The same where it rubs as far from that as slips say; those of another robot, in which nothing rubs: as far as it
  /// does where it was pulled.
  [[nodiscard]] std::vector<double> lengths(const Points& positions, const Eigen::VectorXd& slips) const;
  /// Lets what is remembered follow to within the creep.
  void slide(const Points& positions, std::vector<double>& eyelets) const;
  /// Of every eyelet, towards the motor, over its creep [-]; 0 where nothing is remembered.
  [[nodiscard]] Eigen::VectorXd slips(const Iterate& at) const;

  // Of a cable that rubs, of one segment after the other.
  /// Tensions over that at the motor [-].
  [[nodiscard]] Eigen::VectorXd shares(Index actuator, const Iterate& at) const;
  /// What it pulls with per tension at the motor, #V by 3 [-].
  void pull(Index actuator, const Iterate& at, Points& force) const;
  /// Adds what moves of the vertices change of what it pulls with, as its tensions change [N].
  void add_response(Index actuator, double tension, const Iterate& at, const Points& moves, Points& force) const;
  [[nodiscard]] TendonForces forces(Index actuator, double tension, const Iterate& at) const;

  /// Of all that rub and pull at an iterate.
  [[nodiscard]] TendonColumns columns(const Iterate& at, const supports::Freedoms& freedoms) const;

 private:
  struct Cable {
    Index memory = -1;  // of its first eyelet; negative: it does not rub
    Index count = 0;    // of its eyelets, and segments
    double friction = 0, sheath = 0, creep = 1;
  };
  struct Way;
  [[nodiscard]] const std::vector<EmbeddedPoint>& points_of(Index actuator) const;
  [[nodiscard]] Way way(Index actuator, const Points& positions) const;
  [[nodiscard]] Way way(Index actuator, const Iterate& at) const;
  void spread(Index actuator, const std::vector<Vec3>& vectors, Points& force) const;

  const Model& model_;
  std::vector<Cable> cables_;  // per actuator
  Index remembered_ = 0;
};

}  // namespace softkin::physical
