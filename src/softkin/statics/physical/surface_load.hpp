#pragma once

#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Loads on faces of the surface that follow it, and grow with the share of what is done at once. The derivative of
/// their forces is not symmetric by itself: the stiffness is its symmetric part, the rest is a response.
class SurfaceLoad : public Term {
 public:
  struct Scratch : Term::Scratch {
    double share = 0;  // of the last evaluation
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  void add_cliques(linear::Cliques& cliques) override;
  void stiffness(const Iterate& at, const Demand& demand, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool symmetric() const override { return conservative(); }
  void add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch, Points& force) const override;
  [[nodiscard]] bool grows() const override { return true; }

 protected:
  using Blocks = std::array<std::array<Mat3, 6>, 6>;

  [[nodiscard]] virtual std::size_t faces() const = 0;
  [[nodiscard]] virtual const std::vector<Index>& nodes_of_face(std::size_t face) const = 0;
  /// Derivatives of the gradient of a face's nodes by its nodes, at a share of 1.
  [[nodiscard]] virtual Blocks slopes(std::size_t face, const Points& positions) const = 0;

 private:
  std::vector<std::int64_t> slots_;  // first one of each face
};

}  // namespace softkin::physical
