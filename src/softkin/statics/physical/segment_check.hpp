#pragma once

#include <softkin/statics/physical/arc_length.hpp>

namespace softkin::physical {

/// An equilibrium at the end of a segment of a load path, and the tangent of the path there.
struct SegmentEnd {
  const Iterate* at = nullptr;
  double factor = 0;  // of the path's loads, from 0 to 1
  Points rate{};      // of the positions by that factor [mm]
  int negative = 0;   // eigenvalues of the stiffness that the constraints leave
};

/// Checks whether two equilibria are the ends of one segment of a load path without a limit point in between: a step
/// whose corrector converged may have passed one, and then ends on another branch, which may be as stable.
///
/// A segment is confirmed if the tangent at one end predicts the other end, or the tangents at both ends agree with its
/// secant, and if in addition the middle of the curve by these tangents is nearly an equilibrium: under many times a
/// limit load tangents may agree by chance. Otherwise the equilibrium in the middle of the shapes, not of the loads, is
/// found across the secant (the load factor is an unknown, so it exists on an unstable branch, too). If it is unstable,
/// or its load factor is not between those of the ends, a limit point is passed; otherwise both halves are checked.
/// Half of the loads would not do, since a limit load may be any fraction of the requested one, while the shapes before
/// and after a limit point are spread over the whole secant.
///
/// source  Crisfield 1991, Non-linear finite element analysis of solids and structures 1, chapter 9
class SegmentCheck : ArcLength {
 public:
  enum class Verdict { confirmed, passes_limit_point, unclear, interrupted };

  /// All must outlive the object.
  SegmentCheck(Corrector& corrector, StepTracer& tracer, const Equilibria::Options& options, const LoadState& from,
               const LoadState& to);

  /// Is a segment with this largest move of a vertex too short to be checked?
  [[nodiscard]] static bool is_short(const System& system, const SegmentCheckOptions& options, double move_mm);

  /// Checks an accepted step, whose last factorisation is of a shape near its end.
  ///
  /// low        without a rate where the end was extrapolated from the equilibria before
  /// high       without a rate
  /// predicted  moves that the step began with [mm]
  /// changed    has the set of active cables changed: the current factorisation is of the other set
  [[nodiscard]] Verdict check(SegmentEnd low, SegmentEnd high, const Points& predicted, bool changed);

  /// Has the workspace no longer a factorisation near the end?
  [[nodiscard]] bool lost_factor() const { return lost_factor_; }

 private:
  [[nodiscard]] bool is_predicted(const SegmentEnd& low, const SegmentEnd& high, const Points& predicted);
  [[nodiscard]] bool is_retraced(const SegmentEnd& low, const SegmentEnd& high);
  [[nodiscard]] bool agree(const SegmentEnd& low, const SegmentEnd& high);
  [[nodiscard]] bool tangents_agree(const SegmentEnd& low, const SegmentEnd& high) const;
  [[nodiscard]] bool is_balanced_between(const SegmentEnd& low, const SegmentEnd& high, const Points& aside);
  [[nodiscard]] Verdict check_by_middles(const SegmentEnd& low, const SegmentEnd& high);
  Verdict check_halves(const SegmentEnd& low, const SegmentEnd& high, int depth);
  Verdict find_middle(const SegmentEnd& low, const SegmentEnd& high, Point& middle);
  [[nodiscard]] bool turns() const;
  void evaluate(const SegmentEnd& end);
  [[nodiscard]] bool factorise(const SegmentEnd& end);
  [[nodiscard]] Points rate_towards(const SegmentEnd& other, const SegmentEnd& at);
  [[nodiscard]] Points rate(const Point& point, double change) const;
  [[nodiscard]] double size(const Points& moves) const;

  int iterations_ = 0;
  double corrected_ = 0;  // distance of the last middle from the cubic [mm]
  bool lost_factor_ = false;
};

}  // namespace softkin::physical
