#pragma once

#include <softkin/core/team.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/model.hpp>

namespace softkin::supports {

/// What the cables and chambers of a robot measure: polyline lengths [mm] and enclosed volumes [mm^3], with their first
/// and second derivatives in the vertices.
class ActuatorMeasures {
 public:
  explicit ActuatorMeasures(const Model& model);

  /// Is actuator a a cable or a chamber?
  [[nodiscard]] bool measures(Index actuator) const { return !terms_[actuator].empty(); }
  /// At rest.
  [[nodiscard]] double rest(Index actuator) const { return rest_[actuator]; }

  /// Value of an actuator's measure; gradient (#V by 3) where it is asked for.
  [[nodiscard]] double value(Index actuator, const Points& positions, Points* gradient = nullptr) const;

  /// Adds the cliques of all second derivatives.
  void add_cliques(linear::Cliques& cliques);

  /// Writes scale[a] times the second derivative of each actuator's measure into its slots, 9 values each.
  void second_derivatives(const Points& positions, const Eigen::VectorXd& scale, LargeVector<double>& slots,
                          Team& team) const;

 private:
  /// A vertex by its place in a clique, and the share of a node that it has.
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

  [[nodiscard]] Vec3 at(Index node, const Points& positions) const;
  void spread(Index node, const Vec3& vector, Points& gradient) const;
  [[nodiscard]] std::vector<std::vector<Part>> parts_of(const Term& term) const;
  void second_derivative(const Clique& clique, const Points& positions, double scale, LargeVector<double>& slots) const;

  Index vertices_;
  std::vector<const EmbeddedPoint*> points_;
  std::vector<std::vector<Term>> terms_;  // per actuator
  std::vector<Clique> cliques_;
  std::vector<double> rest_;
};

}  // namespace softkin::supports
