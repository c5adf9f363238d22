#pragma once

#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/system.hpp>

namespace softkin::bench {

/// The physical formulation's equations at one shape, and how long each part of a Newton step takes there.
class PhysicalParts {
 public:
  /// model: physical; shape: near an equilibrium under the actuation. Both must outlive the object.
  PhysicalParts(const Model& model, const Actuation& actuation, const State& shape, int threads);

  /// Seconds of one call, each the median of several.
  struct Times {
    double force = 0;      // energy, gradient and what the actuators measure
    double stiffness = 0;  // elements' second derivatives
    double assembly = 0;   // of them, into the matrix over the unknowns
    double factor = 0;
    double solve = 0;  // one right-hand side
    double turn = 0;   // a step taken so that elements turn with it
  };
  [[nodiscard]] Times measure(int repeat);

  /// Of the factorisation.
  [[nodiscard]] double flops() const { return work_.saddle.factor().flops(); }
  [[nodiscard]] double nonzeros() const { return static_cast<double>(work_.saddle.factor().nonzeros()); }
  [[nodiscard]] Index unknowns() const { return pattern().size(); }

  /// The last stiffness, lower triangle in elimination order, as softkin's factorisation takes it.
  [[nodiscard]] const linear::BlockColumns& pattern() const { return work_.stiffness.layout->reduced.columns(); }
  [[nodiscard]] const LargeVector<double>& values() const { return work_.stiffness.values; }
  [[nodiscard]] Eigen::SparseMatrix<double> matrix() const;
  /// Was it made positive definite element by element?
  [[nodiscard]] bool projected() const { return projected_; }
  [[nodiscard]] Team& team() { return team_; }

 private:
  int factorise();

  const Model& model_;
  Team team_;
  physical::System system_;
  physical::Workspace work_;
  physical::Balance balance_;
  physical::LoadState demand_;
  std::vector<bool> active_;
  physical::Iterate at_;
  bool projected_ = false;
};

}  // namespace softkin::bench
