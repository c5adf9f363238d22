#pragma once

#include <softkin/statics/physical/iterate.hpp>
#include <vector>

namespace softkin::physical {

/// The equilibria that a path came through last, and where they lead.
class Trail {
 public:
  /// An equilibrium under a demand, reached from the last one; one that does not continue the trail begins another.
  ///
  /// active  constraints that are held
  void add(const Demand& demand, const std::vector<bool>& active, const Iterate& at);
  void clear() { passed_.clear(); }

  /// What a first-order prediction missed, on a way of so much actuation [mm].
  void note_tangent(const Demand& from, const Demand& to, double missed_mm);

  /// Moves `at`, the last equilibrium and that of `here`, to where the polynomials through the last equilibria lead.
  /// Their degree is the one that would have foretold the last of them best.
  ///
  /// returns  false where they tell less than a first-order prediction does; `at` is unchanged then
  /// source   Allgower, Georg 1990, Numerical continuation methods, 6.3: predictors by interpolation; steps of any
  ///          length, with the projection on the step as parameter
  [[nodiscard]] bool lead(const Demand& here, const Demand& to, const std::vector<bool>& active, double tolerance_mm,
                          Iterate& at) const;

 private:
  struct Passed {
    Demand demand;
    std::vector<bool> active;
    Iterate at;
  };
  [[nodiscard]] std::vector<double> parameters(const Demand& to) const;

  std::vector<Passed> passed_;  // the last first
  double curvature_ = -1;       // what tangents miss, over the square of the way [mm]; negative: not known
};

}  // namespace softkin::physical
