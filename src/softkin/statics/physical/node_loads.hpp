#pragma once

#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Loads of parts, each on a few nodes, such as a face, whose forces depend on the positions of these. They grow with
/// the load factor or with a command. The derivative of their forces is not symmetric by itself: the stiffness is its
/// symmetric part, the rest is a response.
class NodeLoads : public Term {
 public:
  struct Scratch : Term::Scratch {
    LoadState load_state;  // of the last evaluation
  };
  [[nodiscard]] std::unique_ptr<Term::Scratch> new_scratch() const override { return std::make_unique<Scratch>(); }

  void add_cliques(linear::Cliques& cliques) override;
  void stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& scratch,
                 LargeVector<double>& slots, Team& team) const override;
  [[nodiscard]] bool symmetric() const override { return conservative(); }
  void add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch, Points& force) const override;
  [[nodiscard]] bool grows() const override { return true; }

 protected:
  using Blocks = std::array<std::array<Mat3, 6>, 6>;

  [[nodiscard]] virtual std::size_t parts() const = 0;
  /// At most six.
  [[nodiscard]] virtual const std::vector<Index>& nodes_of_part(std::size_t part) const = 0;
  /// Returns the factor of a part's load.
  [[nodiscard]] virtual double scale(std::size_t /*part*/, const LoadState& load_state) const {
    return load_state.load_factor;
  }
  /// Derivatives of the gradient of a part's nodes by its nodes, at a scale of 1.
  [[nodiscard]] virtual Blocks slopes(std::size_t part, const Points& positions) const = 0;

 private:
  std::vector<std::int64_t> slots_;  // first one of each part
};

}  // namespace softkin::physical
