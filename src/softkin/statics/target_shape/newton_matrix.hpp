#pragma once

#include <softkin/energy/target_shape_stiffness.hpp>
#include <softkin/linear/block_matrix.hpp>
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

}  // namespace softkin::target_shape
