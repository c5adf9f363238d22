#pragma once

#include <concepts>
#include <softkin/statics/solver_options.hpp>
#include <type_traits>

namespace softkin {

/// Options of a group, constant or not.
template <class T, class Group>
concept OptionsOf = std::same_as<std::remove_const_t<T>, Group>;

// visit_fields(options, visit) calls visit(OptionField, value) for each option of a group; here of path tracking.

template <OptionsOf<StepSizeOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"min_length", "path", reduction, order_of_magnitude,
                    "No step is shorter; a smaller value finds limits more precisely and takes longer."},
        options.min_length);
  visit(OptionField{"min_smooth_length", "path", reduction, measured,
                    "Without contact no step after a completed part of the path is shorter."},
        options.min_smooth_length);
  visit(OptionField{"min_of_completed", "-", reduction, measured,
                    "Without contact steps may be as short as this fraction of the completed part, so that a limit far "
                    "below the requested load is found as precisely."},
        options.min_of_completed);
  visit(
      OptionField{
          "shortening", "-", reduction, measured,
          "A failed step is repeated with this fraction of its length, along the load factor and along a measure."},
      options.shortening);
  visit(OptionField{"failed_gap", "-", reduction, measured,
                    "After a failed step each step covers at most half the distance to the failed load factor, until "
                    "the distance has shrunk to this fraction."},
        options.failed_gap);
  visit(OptionField{"max_turn", "degrees", positive, order_of_magnitude,
                    "No support turns farther in one step, because the predictor continues the rotation linearly."},
        options.max_turn);
  visit(OptionField{"min_remainder", "step", fraction, order_of_magnitude,
                    "The last step includes a remainder of the path that is shorter than this fraction of it."},
        options.min_remainder);
  visit(OptionField{"few_iterations", "iterations", count, measured,
                    "A step with at most so many iterations is followed by one that is few_growth times as long."},
        options.few_iterations);
  visit(OptionField{"some_iterations", "iterations", count, measured,
                    "A step with at most so many iterations is followed by one that is some_growth times as long."},
        options.some_iterations);
  visit(OptionField{"few_growth", "-", growth, measured, "This is the growth of steps after few iterations."},
        options.few_growth);
  visit(OptionField{"some_growth", "-", growth, measured, "This is the growth of steps after some iterations."},
        options.some_growth);
  visit(OptionField{"few_contact_iterations", "iterations", count, measured,
                    "With contact a step with at most so many iterations is followed by one that is few_contact_growth "
                    "times as long."},
        options.few_contact_iterations);
  visit(OptionField{"some_contact_iterations", "iterations", count, measured,
                    "With contact a step with at most so many iterations is followed by one that is "
                    "some_contact_growth times as long."},
        options.some_contact_iterations);
  visit(OptionField{"few_contact_growth", "-", growth, measured,
                    "This is the growth of steps after few iterations with contact."},
        options.few_contact_growth);
  visit(OptionField{"some_contact_growth", "-", growth, measured,
                    "This is the growth of steps after some iterations with contact."},
        options.some_contact_growth);
  visit(OptionField{"measure_probe", "path", reduction, order_of_magnitude,
                    "The effect of a load on its measure is estimated over this part of the path."},
        options.measure_probe);
  visit(
      OptionField{"max_measure_change", "-", fraction, measured,
                  "A first step that would change the measure of its load by more is made along the measure instead."},
      options.max_measure_change);
}

template <OptionsOf<AcceptanceOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"follow_below", "path", fraction, order_of_magnitude,
                    "Shorter steps may follow unstable equilibria; longer ones descend to stable ones."},
        options.follow_below);
  visit(OptionField{"max_correction", "-", positive, measured,
                    "A correction that is longer than this multiple of the predicted move may be a snap-through and is "
                    "examined."},
        options.max_correction);
  visit(OptionField{"min_snap", "diagonal", positive, order_of_magnitude, "Smaller snap-throughs are not reported."},
        options.min_snap);
  visit(
      OptionField{
          "min_snap_fraction", "-", positive, measured,
          "A step has snapped through if more than this fraction of its correction is not the curvature of the path."},
      options.min_snap_fraction);
  visit(OptionField{"snap_length", "path", fraction, order_of_magnitude,
                    "A step that snaps through is accepted if it is at most this long."},
        options.snap_length);
  visit(OptionField{"max_inverting", "path", fraction, order_of_magnitude,
                    "Longer steps may not invert an element, because laws with an energy for inverted elements have "
                    "mirrored equilibria."},
        options.max_inverting);
  visit(OptionField{"max_residual", "-", positive, order_of_magnitude,
                    "The residual of an accepted step is at most this multiple of the internal forces."},
        options.max_residual);
  visit(OptionField{"long_fall", "diagonal", positive, measured,
                    "If dead loads are predicted to move a vertex farther and a collision shortens the motion, contact "
                    "forces are predicted first."},
        options.long_fall);
}

template <OptionsOf<TerminationOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"min_move", "diagonal", positive, order_of_magnitude,
                    "A failed step that moves no vertex farther ends the path."},
        options.min_move);
  visit(OptionField{"min_contact_move", "contact distance", positive, order_of_magnitude,
                    "With contact a failed step that moves no vertex farther ends the path; sticking contacts move by "
                    "a hundredth of the distance."},
        options.min_contact_move);
  visit(OptionField{"patience", "iterations", count, measured,
                    "A path ends if so many iterations advance it by less than min_progress."},
        options.patience);
  visit(OptionField{"contact_patience", "iterations", count, measured,
                    "With contact a path ends if so many iterations advance it by less than contact_min_progress; the "
                    "next part may take hundreds and those after it few."},
        options.contact_patience);
  visit(OptionField{"min_progress", "path", fraction, order_of_magnitude, "This advance counts as progress."},
        options.min_progress);
  visit(OptionField{"contact_min_progress", "path", fraction, order_of_magnitude,
                    "This advance counts as progress with contact, where bodies slide or tip within 1 % of a load."},
        options.contact_min_progress);
  visit(OptionField{"progress_factor", "-", growth, measured,
                    "An advance to this multiple of the completed fraction counts as progress, too, so that a path "
                    "that begins slowly is not given up."},
        options.progress_factor);
  visit(OptionField{"min_slipping", "-", fraction, order_of_magnitude,
                    "The report of a limit names the fraction of friction that slips from this value on."},
        options.min_slipping);
  visit(OptionField{"curve_failures", "steps", count, measured,
                    "Arc-length continuation begins after so many failed steps."},
        options.curve_failures);
}

template <OptionsOf<SegmentCheckOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"max_error_ahead", "secant", positive, measured,
                    "A tangent at the start with a smaller error confirms the end alone; a smaller value costs "
                    "back-substitutions."},
        options.max_error_ahead);
  visit(OptionField{"max_error_at_an_end", "secant", positive, measured,
                    "The tangents at both ends may have this error; a smaller value costs factorisations."},
        options.max_error_at_an_end);
  visit(OptionField{"max_error_together", "secant", positive, measured,
                    "The sum of both errors may have this size; on an evenly bent path they have opposite directions."},
        options.max_error_together);
  visit(OptionField{"max_middle_step", "secant", positive, measured,
                    "The Newton step in the middle of the cubic through both ends may be this long; a larger value "
                    "accepts balance by chance."},
        options.max_middle_step);
  visit(OptionField{"min_move", "diagonal", positive, order_of_magnitude,
                    "Segments that move no vertex farther are not checked."},
        options.min_move);
  visit(OptionField{"max_halvings", "halvings", count, order_of_magnitude,
                    "A segment is halved at most so often before a shorter step is tried."},
        options.max_halvings);
  visit(OptionField{"max_corrections", "iterations", count, order_of_magnitude,
                    "All middles of a segment take at most so many corrections."},
        options.max_corrections);
  visit(OptionField{"rate_difference", "segment", reduction, derived,
                    "Supports move over this part of a segment for the tangent of its middle."},
        options.rate_difference);
  visit(OptionField{"middle_accuracy", "secant", positive, order_of_magnitude,
                    "The equilibrium in a middle is computed with this accuracy."},
        options.middle_accuracy);
}

template <OptionsOf<ArcLengthOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"first_step", "-", fraction, measured,
                    "The first step covers this fraction of the distance along the tangent to the failed load factor."},
        options.first_step);
  visit(
      OptionField{
          "wanted_error", "step", positive, measured,
          "The step size aims at this distance of the prediction from the curve; with 0.35 one step in two fails."},
      options.wanted_error);
  visit(OptionField{"max_error", "step", positive, measured,
                    "A step with a larger distance from the curve is not corrected."},
        options.max_error);
  visit(OptionField{"max_growth", "-", growth, measured, "A step is at most so many times as long as the one before."},
        options.max_growth);
  visit(OptionField{"min_shortening", "-", reduction, order_of_magnitude,
                    "A step after a failed one has at least this fraction of its length."},
        options.min_shortening);
  visit(OptionField{"max_shortening", "-", reduction, order_of_magnitude,
                    "A step after a failed one has at most this fraction of its length."},
        options.max_shortening);
  visit(OptionField{"max_bend", "step", positive, order_of_magnitude,
                    "The rotation of the tangent is added to the prediction if it bends it by less."},
        options.max_bend);
  visit(OptionField{"max_middle_step", "step", positive, measured,
                    "The Newton step in the middle of the cubic through both ends may be this long; on another branch "
                    "it is longer."},
        options.max_middle_step);
  visit(OptionField{"middle_accuracy", "step", positive, order_of_magnitude,
                    "A point in the middle of a step is computed with this accuracy."},
        options.middle_accuracy);
  visit(OptionField{"max_slope_error", "-", positive, measured,
                    "The slopes of the load factor at both ends may differ from those of a parabola by this fraction "
                    "of their sum."},
        options.max_slope_error);
  visit(OptionField{"min_contraction", "-", fraction, derived,
                    "Each correction from the third one on is shorter than this fraction of the one before."},
        options.min_contraction);
  visit(OptionField{"max_corrections", "iterations", count, order_of_magnitude,
                    "A step takes at most so many corrections."},
        options.max_corrections);
  visit(OptionField{"max_failures", "steps", count, order_of_magnitude, "So many steps may fail in succession."},
        options.max_failures);
  visit(OptionField{"max_iterations", "iterations", count, measured,
                    "All steps from one shape take at most so many iterations."},
        options.max_iterations);
  visit(OptionField{"min_step", "first step", reduction, order_of_magnitude,
                    "No step is shorter; at a corner of the curve steps become ever shorter."},
        options.min_step);
  visit(OptionField{"factor_difference", "path", reduction, derived,
                    "The derivative of the residual by the load factor is a difference over this change."},
        options.factor_difference);
  visit(OptionField{"before_turn", "-", reduction, order_of_magnitude,
                    "The accepted shape lies this far before a turning point, over the distance to a point beyond it."},
        options.before_turn);
}

template <OptionsOf<BeyondTurnOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"max_iterations", "iterations", count, order_of_magnitude,
                    "All steps beyond a turning point take at most so many iterations."},
        options.max_iterations);
  visit(OptionField{"max_failures", "steps", count, measured,
                    "So many steps may fail in succession there, because the curve may bend sharply."},
        options.max_failures);
  visit(OptionField{"min_step", "first step", reduction, order_of_magnitude, "No step there is shorter."},
        options.min_step);
  visit(OptionField{"min_load_factor", "-", any, order_of_magnitude, "The curve is followed down to this load factor."},
        options.min_load_factor);
}

template <OptionsOf<MeasureControlOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(
      OptionField{"first_step", "measure", reduction, measured, "The first step changes the measure by this fraction."},
      options.first_step);
  visit(OptionField{"growth", "-", growth, measured, "A step is at most so many times as long as the one before."},
        options.growth);
  visit(OptionField{"max_first_step", "measure", positive, measured,
                    "The first step is at most this long where the slope allows a longer one."},
        options.max_first_step);
  visit(OptionField{"max_step", "measure", positive, measured, "No step is longer."}, options.max_step);
  visit(OptionField{"min_step", "measure", reduction, order_of_magnitude, "No step is shorter."}, options.min_step);
  visit(OptionField{"max_steps", "steps", count, order_of_magnitude,
                    "A path along the measure has at most so many steps."},
        options.max_steps);
  visit(OptionField{"max_failures", "steps", count, order_of_magnitude, "So many of its steps may fail."},
        options.max_failures);
  visit(
      OptionField{
          "maximum_slope", "-", positive, derived,
          "A relative slope below this value counts as the maximum; the error of its load is the square of it."},
      options.maximum_slope);
  visit(OptionField{"bracket_margin", "-", reduction, derived,
                    "A trial point keeps this fraction of an interval around the maximum from its ends."},
        options.bracket_margin);
  visit(OptionField{"slope_allowance", "-", positive, measured,
                    "The next step covers this multiple of the distance to the maximum by the last two slopes, which "
                    "decrease ever more slowly."},
        options.slope_allowance);
  visit(OptionField{"before_maximum", "path", reduction, order_of_magnitude,
                    "The final shape lies this far before the maximum, where the stiffness is singular."},
        options.before_maximum);
  visit(OptionField{"coarse_tolerance", "tolerance", positive, order_of_magnitude,
                    "Intermediate equilibria are solved with this multiple of the tolerances."},
        options.coarse_tolerance);
  visit(OptionField{"whole_step", "step", fraction, order_of_magnitude,
                    "If the load is reached only after this fraction of a step, its end is the initial guess."},
        options.whole_step);
  visit(
      OptionField{"max_extrapolation", "-", positive, derived,
                  "A prediction of second order is used if the step ahead is at most this multiple of the step back."},
      options.max_extrapolation);
  visit(OptionField{"max_second_order", "-", positive, measured,
                    "The term of second order is at most this fraction of the prediction."},
        options.max_second_order);
}

template <OptionsOf<PostLimitOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"first_step", "measure", positive, order_of_magnitude,
                    "The first step changes the measure by this fraction."},
        options.first_step);
  visit(OptionField{"growth", "-", growth, order_of_magnitude,
                    "A step is at most so many times as long as the one before."},
        options.growth);
  visit(OptionField{"max_step", "measure", positive, order_of_magnitude, "No step is longer."}, options.max_step);
  visit(OptionField{"min_step", "measure", reduction, order_of_magnitude, "No step is shorter."}, options.min_step);
  visit(OptionField{"max_steps", "steps", count, order_of_magnitude, "The branch has at most so many steps."},
        options.max_steps);
  visit(OptionField{"max_failures", "steps", count, order_of_magnitude, "So many of its steps may fail."},
        options.max_failures);
  visit(OptionField{"min_points", "points", count, order_of_magnitude,
                    "The branch has at least so many points up to the requested measure."},
        options.min_points);
  visit(OptionField{"search_range", "measure", growth, order_of_magnitude,
                    "The next stable shape is searched for up to this multiple of the measure at the limit point."},
        options.search_range);
  visit(OptionField{"load_tolerance", "-", positive, order_of_magnitude,
                    "Newton's method under the load itself starts from this relative distance."},
        options.load_tolerance);
  visit(OptionField{"max_bisections", "halvings", count, derived,
                    "The interval that contains the load is divided at most so often."},
        options.max_bisections);
}

template <OptionsOf<BucklingOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"max_buckles", "equilibria", count, order_of_magnitude,
                    "So many unstable equilibria are left in succession."},
        options.max_buckles);
  visit(OptionField{"max_descent_steps", "steps", count, order_of_magnitude,
                    "A descent from a perturbation has at most so many steps."},
        options.max_descent_steps);
  visit(
      OptionField{
          "energy_tie", "-", positive, derived,
          "If the energies of both descents differ by less, the first one is used, so that rounding decides nothing."},
      options.energy_tie);
  visit(OptionField{"small_push", "diagonal", positive, order_of_magnitude, "This is the first perturbation."},
        options.small_push);
  visit(OptionField{"medium_push", "diagonal", positive, order_of_magnitude,
                    "This is the second perturbation, after descents from the first one returned."},
        options.medium_push);
  visit(OptionField{"large_push", "diagonal", positive, order_of_magnitude, "This is the last perturbation."},
        options.large_push);
  visit(OptionField{"min_departure", "push", fraction, order_of_magnitude, "A descent that ends nearer has returned."},
        options.min_departure);
}

template <OptionsOf<PredictionOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"tangent_accuracy", "-", positive, order_of_magnitude,
                    "A tangent by a factor from nearby is refined to this accuracy."},
        options.tangent_accuracy);
  visit(OptionField{"tangent_rounds", "iterations", count, measured,
                    "Its refinement takes at most so many conjugate residuals."},
        options.tangent_rounds);
  visit(OptionField{"clear_fraction", "-", reduction, order_of_magnitude,
                    "A prediction covers this fraction of the motion without collision."},
        options.clear_fraction);
  visit(OptionField{"max_cut", "-", reduction, measured,
                    "A long motion of which less remains is made as a shorter step."},
        options.max_cut);
  visit(OptionField{"long_move", "diagonal", positive, measured, "This displacement counts as long."},
        options.long_move);
  visit(OptionField{"min_fraction", "-", reduction, order_of_magnitude,
                    "If less of a prediction remains, only supports move."},
        options.min_fraction);
  visit(OptionField{"second_order_move", "diagonal", positive, derived,
                    "The finite difference for the second order moves no vertex farther."},
        options.second_order_move);
  visit(OptionField{"max_remainder", "-", fraction, order_of_magnitude,
                    "Tangents may cover this fraction of an extrapolated change of commands."},
        options.max_remainder);
  visit(OptionField{"max_stored", "equilibria", count, measured,
                    "The predictor history contains at most so many equilibria."},
        options.max_stored);
  visit(OptionField{"min_spacing", "step", reduction, order_of_magnitude,
                    "Equilibria that are closer to each other are not interpolated."},
        options.min_spacing);
  visit(OptionField{"max_compared", "vertices", count, order_of_magnitude,
                    "Predictions are compared at no more vertices."},
        options.max_compared);
  visit(OptionField{"max_error", "-", positive, measured,
                    "A polynomial is used if its error is below this multiple of that of the tangent."},
        options.max_error);
  visit(OptionField{"max_error_tolerances", "tolerance", positive, measured,
                    "Its error must also be below this multiple of the tolerance, because a larger one may lead to an "
                    "unstable shape."},
        options.max_error_tolerances);
}

}  // namespace softkin
