#pragma once

#include <softkin/energy/target_shape_stiffness.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/linear/sparse_ldlt.hpp>
#include <softkin/statics/supports/reduced_matrix.hpp>
#include <softkin/statics/target_shape/system.hpp>

namespace softkin::target_shape {

/// The stiffness of the target-shape formulation over all vertices: minus the derivative of the residual where that is
/// symmetric, else a positive semidefinite matrix near it (see stiffness_of_body, stiffness_of_actuation). The pattern
/// is made once.
class NewtonMatrix {
 public:
  /// system must outlive the object.
  NewtonMatrix(const Model& model, const System& system);

  [[nodiscard]] const linear::BlockPattern& pattern() const { return pattern_; }

  /// Blocks of all elements [mm^3] at the shape of the last local_step: slots of pattern().
  ///
  /// local      the scratch of that local_step
  /// projected  with every element's matrix positive semidefinite
  void assemble(const System::Scratch& local, bool projected, LargeVector<double>& slots, Team& team) const;

 private:
  /// A cable's triangle moves with the vertices that its three points are sums of.
  struct Triangle {
    struct Part {
      Index place;  // of the vertex in the clique
      double weight;
    };
    std::array<std::vector<Part>, 3> parts;
  };

  linear::Cliques make_cliques(const Model& model);
  void add_triangle(const Triangle& triangle, const energy::TargetStiffness<3>& stiffness, int lane,
                    double* slots) const;

  const System& system_;
  std::vector<std::int64_t> slots_;  // first of each element, in the order of the sets
  std::vector<Triangle> triangles_;  // in the order of the sets
  linear::BlockPattern pattern_;
};

/// Common data of the linear systems of all solves of one robot: pattern, unknowns and symbolic factorisation.
struct Unknowns {
  Unknowns(const Model& robot, const System& target_shapes);

  const Model& model;
  const System& system;
  NewtonMatrix matrix;
  supports::Freedoms freedoms;
  supports::ReducedMatrix reduced;
  std::shared_ptr<const linear::FrontTree> symbolic;
  bool symmetric;  // is the residual's derivative symmetric
};

/// The derivative K of minus the residual over the unknowns at one shape, and its solutions: by its factor where it is
/// symmetric, else by GMRES with the factor of a near matrix, and the exact coupling of least-norm ratios
/// (Sherman-Morrison-Woodbury), as preconditioner.
class Tangent {
 public:
  explicit Tangent(const Unknowns& unknowns);

  /// Assembles and factorises at the shape of the last local_step: as it is; where that is not positive definite with
  /// the elements' matrices projected; where that is not either, shifted by ever larger fractions of its diagonal.
  ///
  /// local      the scratch of that local_step
  /// positions  of it
  /// projected  begins with the projected matrices
  /// report     factorisations, projections and shifts are counted up
  /// returns    false where no shift helps or a value is not finite
  [[nodiscard]] bool factorise(const System::Scratch& local, const Points& positions, bool projected, Team& team,
                               SolveReport& report);

  /// The residual over the unknowns.
  void reduce(const Points& residual, const Points& positions, Eigen::VectorXd& out) const;

  /// Applies the preconditioner: K^-1 where K is symmetric and was neither projected nor shifted.
  void precondition(Eigen::VectorXd& vector, Team& team);

  /// Solves K step = right for the exact K at a shape, which need not be that of the factor.
  ///
  /// right      already preconditioned
  /// tolerance  of the preconditioned residual, relative to |right|
  /// returns    did GMRES reach it; step is the best it found. Where K is symmetric step is `right`, which is K^-1 of
  ///            it if neither projected nor shifted
  bool solve(const System::Scratch& local, const Points& positions, const Eigen::VectorXd& right, double tolerance,
             Team& team, Eigen::VectorXd& step);

  /// Required accuracy of a solution.
  struct Accuracy {
    int rounds = 0;       // at most
    double residual = 0;  // preconditioned, relative
    double apart = 0;  // how far the preconditioned K may be from the identity, in the preconditioned right-hand sides
  };
  /// Solves K steps = rights, a column each, for the exact K at a shape near that of the factor, symmetric or not, by
  /// conjugate residuals.
  ///
  /// returns  false where K is farther from the identity, or these rounds do not suffice
  [[nodiscard]] bool solve_exactly(const System::Scratch& local, const Points& positions, const Eigen::MatrixXd& rights,
                                   const Accuracy& requested, Team& team, Eigen::MatrixXd& steps);

  [[nodiscard]] const supports::Freedoms& freedoms() const { return unknowns_.freedoms; }
  [[nodiscard]] bool symmetric() const { return unknowns_.symmetric; }
  /// Was the last factor's matrix shifted?
  [[nodiscard]] bool shifted() const { return shift_ > 0; }

 private:
  bool factorise_values(double shift, Team& team, SolveReport& report);
  void update_coupling(const System::Scratch& local, const Points& positions, Team& team);
  void multiply(const System::Scratch& local, const Points& positions, const Eigen::VectorXd& vector,
                Eigen::VectorXd& product, Team& team);

  const Unknowns& unknowns_;
  linear::SparseLdlt factor_;
  LargeVector<double> slots_, values_, shifted_;
  std::vector<System::Redistribution> redistributions_;
  Eigen::MatrixXd sources_, targets_;  // of the redistributions over the unknowns: factor^-1 source, target
  Eigen::MatrixXd capacitance_;        // inverse of I + targets^T sources
  Eigen::MatrixXd column_;
  System::Scratch work_;
  Points gradient_, moved_, origin_;
  Eigen::VectorXd turned_, unturned_;
  std::vector<Eigen::VectorXd> basis_;
  double shift_ = 0;  // fraction of the diagonal in the last factor
};

}  // namespace softkin::target_shape
