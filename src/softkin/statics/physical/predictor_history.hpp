#pragma once

#include <softkin/statics/physical/iterate.hpp>
#include <softkin/statics/solver_options.hpp>
#include <vector>

namespace softkin::physical {

/// Predictor history: the last equilibria on a path, from which the next one is extrapolated.
class PredictorHistory {
 public:
  /// Adds an equilibrium at a load state, reached from the last one. An equilibrium that does not continue the history
  /// starts a new one.
  ///
  /// active  which constraints are active
  void add(const LoadState& load_state, const std::vector<bool>& active, const Iterate& at,
           const PredictionOptions& options);
  void clear() { passed_.clear(); }

  /// Records the error of a first-order prediction from one load state to another [mm].
  void note_tangent(const LoadState& from, const LoadState& to, double missed_mm);

  /// Moves `at`, the last equilibrium, at load state `here`, to its extrapolation by polynomials through the last
  /// equilibria. Their degree is the one that would have predicted the last of them best.
  ///
  /// returns  false if they are less accurate than a first-order prediction; `at` is unchanged then
  /// source   Allgower, Georg 1990, Numerical continuation methods, 6.3: predictors by interpolation; steps of any
  ///          length, with the projection on the step as parameter
  [[nodiscard]] bool extrapolate(const LoadState& here, const LoadState& to, const std::vector<bool>& active,
                                 double tolerance_mm, const PredictionOptions& options, Iterate& at) const;

 private:
  struct Passed {
    LoadState load_state;
    std::vector<bool> active;
    Iterate at;
  };
  [[nodiscard]] std::vector<double> parameters(const LoadState& to, double min_spacing) const;

  std::vector<Passed> passed_;  // the last one first
  double curvature_ = -1;       // error of first-order predictions over the squared step [mm]; negative: unknown
};

}  // namespace softkin::physical
