#pragma once

#include <softkin/core/team.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/model.hpp>

namespace softkin::supports {

/// The measures of the cables and chambers of a robot: polyline lengths [mm] and enclosed volumes [mm^3], with their
/// first and second derivatives by the vertices.
class ActuatorMeasures {
 public:
  /// model must outlive the object.
  explicit ActuatorMeasures(const Model& model);

  /// Of actuators, of all kinds.
  [[nodiscard]] Index count() const { return rest_.size(); }
  /// Is actuator a a cable or a chamber?
  [[nodiscard]] bool measures(Index actuator) const { return !terms_[actuator].empty(); }
  /// At rest.
  [[nodiscard]] double rest(Index actuator) const { return rest_[actuator]; }

  // In the equations of equilibrium an actuator's measure is constrained to the commanded value, or its multiplier, a
  // tension [N] or gauge pressure [MPa], is given. The volume of a sealed chamber is constrained to that of its filling
  // at its pressure.

  /// Is its measure or its filling commanded (else its load, or it is a dea, or it acts on the robot without a
  /// measure)?
  [[nodiscard]] bool constrains(Index actuator) const { return roles_[actuator].constrains; }
  /// Is a load of the robot itself commanded: tension, pressure or voltage?
  [[nodiscard]] bool given_load(Index actuator) const { return roles_[actuator].given_load; }
  /// Sign of its multiplier times its measure in the potential: 1 for cables, -1 for chambers.
  [[nodiscard]] double sign(Index actuator) const { return roles_[actuator].sign; }
  /// Internal unit of a multiplier over that of the user: MPa per kPa, N per N.
  [[nodiscard]] double unit(Index actuator) const { return roles_[actuator].unit; }
  /// Returns the multiplier of a load by its command, with the scene's factor and offset; of a cable it is never
  /// negative.
  [[nodiscard]] double given(Index actuator, double command) const {
    const Role& role = roles_[actuator];
    return is_slack(actuator, command) ? 0 : role.unit * (role.factor * command + role.offset);
  }
  /// Does a negative offset leave a cable slack under this tension?
  [[nodiscard]] bool is_slack(Index actuator, double command) const {
    const Role& role = roles_[actuator];
    return role.only_pulls && command >= 0 && role.factor * command + role.offset < 0;
  }
  /// Returns the command by the multiplier of a load, the inverse of given().
  [[nodiscard]] double command(Index actuator, double multiplier) const {
    return (multiplier / roles_[actuator].unit - roles_[actuator].offset) / roles_[actuator].factor;
  }
  /// The derivative of given() by the command.
  [[nodiscard]] double rate(Index actuator, double command) const {
    return is_slack(actuator, command) ? 0 : roles_[actuator].unit * roles_[actuator].factor;
  }
  /// Is it a cable, which becomes slack instead of carrying compression?
  [[nodiscard]] bool only_pulls(Index actuator) const { return roles_[actuator].only_pulls; }
  /// Returns the target of the measure [mm, mm^3] by a command; that of a sealed chamber depends on its multiplier,
  /// too.
  [[nodiscard]] double target(Index actuator, const Eigen::VectorXd& actuation, double multiplier) const {
    const Filling* filling = roles_[actuator].filling;
    return filling ? filling->volume(actuation[actuator], multiplier) : actuation[actuator] * rest_[actuator];
  }
  /// Its derivative by the command.
  [[nodiscard]] double target_by_command(Index actuator, double multiplier) const {
    const Filling* filling = roles_[actuator].filling;
    return filling ? filling->by_command(multiplier) : rest_[actuator];
  }
  /// Returns the command whose target is a measure.
  [[nodiscard]] double command_for(Index actuator, double measure, double multiplier) const {
    const Filling* filling = roles_[actuator].filling;
    return filling ? filling->command(measure, multiplier) : measure / rest_[actuator];
  }
  /// Returns the filling of a sealed chamber whose amount is commanded; null: there is none.
  [[nodiscard]] const Filling* filling(Index actuator) const { return roles_[actuator].filling; }
  /// Is there such a chamber?
  [[nodiscard]] bool any_filling() const { return any_filling_; }

  /// Returns the value of an actuator's measure, and its gradient (#V by 3) if that is not null.
  [[nodiscard]] double value(Index actuator, const Points& positions, Points* gradient = nullptr) const;

  /// Adds the cliques of all second derivatives.
  void add_cliques(linear::Cliques& cliques);

  /// Writes scale[a] times the second derivative of each actuator's measure into its slots, 9 values each.
  ///
  /// fractions  per actuator, of each of its parts; empty: 1
  void second_derivatives(const Points& positions, const Eigen::VectorXd& scale,
                          const std::vector<Eigen::VectorXd>& fractions, LargeVector<double>& slots, Team& team) const;

 private:
  /// A vertex by its place in a clique, and its weight in a node.
  using Part = std::pair<Index, double>;
  /// A segment (2 nodes), a flat face (3) or a curved one (6: corners, then edges 01, 12, 20). Nodes beyond the
  /// vertices are embedded points.
  struct Term {
    int count = 0;
    std::array<Index, 6> nodes{};
    std::vector<std::vector<Part>> parts;  // of each node
  };
  /// The terms of an actuator with the same vertices, as the facets of a surface within one element are.
  struct Clique {
    Index actuator;
    std::int64_t slot;
    std::vector<Index> vertices, terms;
  };

  struct Role {
    bool constrains, given_load, only_pulls;
    double sign, unit, factor, offset;
    const Filling* filling;  // the model's
  };

  [[nodiscard]] Vec3 at(Index node, const Points& positions) const;
  void spread(Index node, const Vec3& vector, Points& gradient) const;
  [[nodiscard]] std::vector<std::vector<Part>> parts_of(const Term& term) const;
  void second_derivative(const Clique& clique, const Points& positions, double scale, const Eigen::VectorXd& fractions,
                         LargeVector<double>& slots) const;

  Index vertices_;
  std::vector<const EmbeddedPoint*> points_;
  std::vector<std::vector<Term>> terms_;  // per actuator
  std::vector<Clique> cliques_;
  std::vector<double> rest_;
  std::vector<Role> roles_;
  bool any_filling_ = false;
};

}  // namespace softkin::supports
