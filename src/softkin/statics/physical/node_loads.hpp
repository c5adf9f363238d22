#pragma once

#include <softkin/statics/physical/term.hpp>

namespace softkin::physical {

/// Loads of parts, each on a few nodes, such as a face, whose forces depend on where these are. They grow with the
/// share of what is done at once or as a command says. The derivative of their forces is not symmetric by itself: the
/// stiffness is its symmetric part, the rest is a response.
class NodeLoads : public Term {
 public:
  struct Scratch : Term::Scratch {
    Demand demand;  // of the last evaluation
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

  [[nodiscard]] virtual std::size_t parts() const = 0;
  /// At most six.
  [[nodiscard]] virtual const std::vector<Index>& nodes_of_part(std::size_t part) const = 0;
  /// By what a part's load is multiplied.
  [[nodiscard]] virtual double scale(std::size_t /*part*/, const Demand& demand) const { return demand.share; }
  /// Derivatives of the gradient of a part's nodes by its nodes, at a scale of 1.
  [[nodiscard]] virtual Blocks slopes(std::size_t part, const Points& positions) const = 0;

 private:
  std::vector<std::int64_t> slots_;  // first one of each part
};

}  // namespace softkin::physical
