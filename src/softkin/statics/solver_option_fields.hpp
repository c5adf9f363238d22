#pragma once

#include <softkin/statics/path_option_fields.hpp>

namespace softkin {

// visit_fields() of all other groups; see path_option_fields.hpp.

template <OptionsOf<ConvergenceOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"max_iterations", "iterations", count, measured, "A correction takes at most so many iterations."},
        options.max_iterations);
  visit(OptionField{"max_contact_iterations", "iterations", count, measured,
                    "With contact or wrinkling sheets a correction takes at most so many iterations."},
        options.max_contact_iterations);
  visit(OptionField{"max_brief_iterations", "iterations", count, measured,
                    "A step where loads change or that is short, without contact, takes at most so many iterations; "
                    "not the first step of a path."},
        options.max_brief_iterations);
  visit(OptionField{"min_balance_gain", "-", reduction, order_of_magnitude,
                    "An iteration that only reduces the residual must reduce it to this fraction."},
        options.min_balance_gain);
  visit(OptionField{"constraint_tolerance", "-", positive, derived,
                    "Commanded lengths and volumes are met to this fraction of the measure at rest."},
        options.constraint_tolerance);
  visit(OptionField{"coarse_tolerance", "tolerance", positive, measured,
                    "Solves that only give an initial guess have this multiple of the tolerances."},
        options.coarse_tolerance);
  visit(OptionField{"max_last_error", "tolerance", positive, order_of_magnitude,
                    "A last step by an old factor may leave this remainder."},
        options.max_last_error);
  visit(OptionField{"slow_contraction", "-", fraction, measured,
                    "Steps of a projected stiffness that contract less count as slow."},
        options.slow_contraction);
  visit(OptionField{"few_modes", "modes", count, measured,
                    "Up to so many unstable modes a shift is better than a projection."},
        options.few_modes);
  visit(OptionField{"poor_damping", "-", fraction, measured, "A smaller damping counts as poor with contact."},
        options.poor_damping);
  visit(OptionField{"max_poor_steps", "steps", count, measured,
                    "After so many poor steps in succession a shorter step of the path is tried."},
        options.max_poor_steps);
  visit(OptionField{"no_contraction", "-", fraction, measured,
                    "With friction a larger ratio of successive steps counts as none."},
        options.no_contraction);
  visit(OptionField{"max_equal_steps", "steps", count, measured,
                    "After so many steps without contraction a shorter step of the path is tried."},
        options.max_equal_steps);
  visit(OptionField{"max_descent_steps", "steps", count, measured,
                    "After so many steps that descend and come no closer a shorter step of the path is tried."},
        options.max_descent_steps);
}

template <OptionsOf<LineSearchOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(
      OptionField{"min_damping", "-", reduction, order_of_magnitude, "No smaller fraction of a Newton step is tried."},
      options.min_damping);
  visit(OptionField{"halving", "-", reduction, measured,
                    "A step that does not come nearer is repeated with at most this fraction of its length."},
        options.halving);
  visit(OptionField{"runaway", "diagonal", positive, measured,
                    "A solve that moves a vertex farther in one step is given up; of 8,000 random robots none loses "
                    "its solution at 3, either."},
        options.runaway);
  visit(OptionField{"armijo", "-", positive, derived,
                    "A step must decrease the merit function by this fraction of its slope (Armijo's rule)."},
        options.armijo);
  visit(
      OptionField{
          "min_slope", "-", positive, measured,
          "For slopes that are flatter than this fraction of the steepest one, the monotonicity test alone decides."},
      options.min_slope);
  visit(OptionField{"max_rise", "-", positive, derived,
                    "A relative rise of the merit function below this value counts as rounding."},
        options.max_rise);
  visit(OptionField{"change_weight", "-", positive, derived,
                    "Constraint violations weigh this multiple of the change of their multipliers by a step."},
        options.change_weight);
  visit(
      OptionField{
          "multiplier_weight", "-", positive, measured,
          "They also weigh this multiple of the multipliers; a larger value rejects steps along curved constraints."},
      options.multiplier_weight);
  visit(OptionField{"max_extension", "step", growth, measured,
                    "A descent with contact or wrinkling sheets and a stiffness made positive is extended to at most "
                    "this multiple of the Newton step."},
        options.max_extension);
}

template <OptionsOf<RegularisationOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"slight_shift", "mean diagonal", positive, order_of_magnitude,
                    "This is the first shift of a slightly unstable stiffness."},
        options.slight_shift);
  visit(OptionField{"clear_shift", "mean diagonal", positive, order_of_magnitude,
                    "From this shift on the stiffness is projected element by element instead."},
        options.clear_shift);
  visit(OptionField{"shift_growth", "-", growth, measured,
                    "An insufficient shift grows by this factor; each costs a factorisation."},
        options.shift_growth);
  visit(OptionField{"shift_decay", "-", growth, measured,
                    "The first shift at the next shape is the last one over this number."},
        options.shift_decay);
  visit(OptionField{"min_shift", "mean diagonal", positive, measured,
                    "This is the first shift of a stiffness that is still unstable after projection: with ten times as "
                    "much steps are very short, with a tenth nearly incompressible robots diverge."},
        options.min_shift);
  visit(OptionField{"min_wrinkled_shift", "mean diagonal", positive, measured,
                    "This is the first shift for wrinkling sheets."},
        options.min_wrinkled_shift);
  visit(
      OptionField{"max_shift", "mean diagonal", positive, order_of_magnitude, "From this value on no shift is tried."},
      options.max_shift);
  visit(OptionField{"projected_growth", "-", growth, order_of_magnitude,
                    "The shift of a projected stiffness grows by this factor."},
        options.projected_growth);
}

template <OptionsOf<RefactorisationOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"max_distance", "diagonal", positive, measured,
                    "A factor is tried for shapes up to this distance before a new one is computed."},
        options.max_distance);
  visit(OptionField{"max_count_distance", "diagonal", positive, order_of_magnitude,
                    "If the last steps lead farther from the factor whose negative pivots are counted, the softest "
                    "mode is examined."},
        options.max_count_distance);
  visit(OptionField{"max_contraction", "-", reduction, measured,
                    "A quasi-Newton step is at most this fraction of the one before, because with slower contraction a "
                    "new factor is cheaper."},
        options.max_contraction);
  visit(OptionField{"max_updates", "steps", count, measured,
                    "So many quasi-Newton steps with one factor cost as much as a factorisation."},
        options.max_updates);
  visit(OptionField{"max_along", "step", reduction, derived,
                    "Broyden's update is used if at most this part of a step remains along it."},
        options.max_along);
  visit(OptionField{"cost", "steps", positive, measured,
                    "A factorisation costs as much as so many steps with an existing factor."},
        options.cost);
  visit(OptionField{"much_rounded", "-", positive, measured,
                    "If the rounding of a factor in single precision is larger, it may cause slow quasi-Newton steps, "
                    "and the next factors are in double precision."},
        options.much_rounded);
  visit(OptionField{"rounded_steps", "tolerance", positive, measured,
                    "A failed solve whose last step was shorter is repeated in double precision; of others 1 in 50 "
                    "succeeds then."},
        options.rounded_steps);
  visit(OptionField{"suspect_contraction", "-", fraction, measured,
                    "From this ratio of successive steps on rounding is suspected."},
        options.suspect_contraction);
  visit(OptionField{"rounded_change", "-", positive, measured,
                    "If a refinement changes a step by more, rounding was the cause."},
        options.rounded_change);
  visit(OptionField{"refined_accuracy", "-", positive, order_of_magnitude, "A refined step has this accuracy."},
        options.refined_accuracy);
  visit(OptionField{"max_refined_error", "-", positive, order_of_magnitude,
                    "A refinement with a larger remainder is discarded."},
        options.max_refined_error);
  visit(OptionField{"refinement_rounds", "iterations", count, measured,
                    "A refinement takes at most so many conjugate residuals."},
        options.refinement_rounds);
}

template <OptionsOf<StabilityOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"min_shift", "mean diagonal", positive, derived, "Smaller shifts are rounding."},
        options.min_shift);
  visit(OptionField{"max_shift", "mean diagonal", positive, order_of_magnitude,
                    "With a larger shift nothing is left of the stiffness."},
        options.max_shift);
  visit(OptionField{"close_shift", "-", growth, order_of_magnitude,
                    "The shift for inverse iteration is at most this multiple of one that is not enough."},
        options.close_shift);
  visit(OptionField{"max_inverse_iterations", "iterations", count, order_of_magnitude,
                    "The lowest mode takes at most so many inverse iterations."},
        options.max_inverse_iterations);
  visit(OptionField{"curvature_accuracy", "-", positive, order_of_magnitude,
                    "They end at this relative change of its curvature."},
        options.curvature_accuracy);
  visit(OptionField{"softest_iterations", "iterations", count, measured,
                    "The softest mode is approximated by so many inverse iterations."},
        options.softest_iterations);
  visit(OptionField{"difference", "diagonal", positive, derived, "Its curvature is measured by this displacement."},
        options.difference);
  visit(OptionField{"max_change", "-", positive, measured,
                    "If this curvature changes by more, a factor from nearby is not used."},
        options.max_change);
}

template <OptionsOf<DerivativeOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"nearby_rounds", "iterations", count, measured,
                    "So many iterations with a factor from nearby cost about as much as a new one."},
        options.nearby_rounds);
  visit(OptionField{"exact_rounds", "iterations", count, derived,
                    "The factor of the shape itself takes at most so many."},
        options.exact_rounds);
  visit(OptionField{"friction_rounds", "iterations", count, order_of_magnitude,
                    "Friction, which no factor contains completely, takes at most so many."},
        options.friction_rounds);
  visit(OptionField{"accuracy_fraction", "-", fraction, derived,
                    "The remainder is this fraction of the accuracy, because a wrong factor may measure it by a third "
                    "too small."},
        options.accuracy_fraction);
  visit(OptionField{"max_rounding", "-", positive, derived,
                    "If rounding contributes more with the factor of the shape itself, the stiffness is singular."},
        options.max_rounding);
  visit(OptionField{"slack_margin", "-", positive, derived,
                    "A slack cable that is this close to its largest length counts as active."},
        options.slack_margin);
}

template <OptionsOf<ContactOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"soft_modulus", "-", positive, measured,
                    "The soft contact that predicts first contact has this multiple of the modulus of the scene."},
        options.soft_modulus);
  visit(OptionField{"soft_reach", "contact distance", growth, measured, "This is the final range of the soft contact."},
        options.soft_reach);
  visit(OptionField{"soft_reduction", "-", growth, measured, "Its range shrinks by this factor from round to round."},
        options.soft_reduction);
  visit(OptionField{"fall_reach", "diagonal", positive, order_of_magnitude,
                    "This is its largest range for falling bodies, where a smaller one shortens steps to nothing."},
        options.fall_reach);
  visit(OptionField{"max_soft_iterations", "iterations", count, order_of_magnitude,
                    "After so many iterations of failed rounds no larger range is tried."},
        options.max_soft_iterations);
  visit(OptionField{"linear_reach", "contact distance", positive, measured,
                    "Linearised contact forces extend over this distance."},
        options.linear_reach);
  visit(OptionField{"max_force_steps", "steps", count, measured,
                    "With shape and contact forces as unknowns, so many steps are made."},
        options.max_force_steps);
  visit(
      OptionField{
          "force_agreement", "-", positive, measured,
          "If contact forces differ by less from those of their gaps, Newton's method on the shape alone converges."},
      options.force_agreement);
  visit(OptionField{"faint_force", "-", positive, order_of_magnitude,
                    "In this comparison a force counts as at least this fraction of the largest one."},
        options.faint_force);
  visit(OptionField{"fixed_friction_rounds", "rounds", count, order_of_magnitude,
                    "Friction with fixed normal forces is updated at most so often."},
        options.fixed_friction_rounds);
  visit(OptionField{"following_friction_rounds", "rounds", count, order_of_magnitude,
                    "Friction that follows its normal forces is updated at most so often."},
        options.following_friction_rounds);
  visit(OptionField{"friction_tolerance", "-", positive, order_of_magnitude,
                    "Friction and normal forces are consistent if an update changes friction by less."},
        options.friction_tolerance);
  visit(OptionField{"piece_turn", "rad", positive, order_of_magnitude,
                    "A motion that turns contact surfaces farther is checked in pieces."},
        options.piece_turn);
  visit(OptionField{"max_turn", "rad", positive, order_of_magnitude,
                    "A motion that turns contact surfaces farther is shortened."},
        options.max_turn);
  visit(OptionField{"min_advance", "-", reduction, order_of_magnitude,
                    "A step of which a collision leaves less is not made."},
        options.min_advance);
  visit(OptionField{"clear_fraction", "-", reduction, order_of_magnitude,
                    "A step covers this fraction of its free motion, because a shorter motion is not quite the same."},
        options.clear_fraction);
}

template <OptionsOf<WrinklingOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"mean_slope", "-", positive, measured,
                    "The initial shape of flat sheets has this slope: flatter ones are stiffer on the path to the end, "
                    "steeper ones are far from it."},
        options.mean_slope);
  visit(OptionField{"smoothing", "-", positive, measured,
                    "The initial smoothing of wrinkles is this multiple of the squared strain under the loads: more "
                    "contracts the sheet, less makes the path long."},
        options.smoothing);
  visit(OptionField{"max_smoothing", "-", positive, measured, "The initial smoothing is at most this large."},
        options.max_smoothing);
  visit(OptionField{"min_strain", "-", positive, measured,
                    "The pressures cause at least this strain at first; below it wrinkled film is too stiff in its "
                    "plane for its loads."},
        options.min_strain);
  visit(OptionField{"start_accuracy", "-", positive, order_of_magnitude,
                    "The equations of the initial shape are solved to this accuracy."},
        options.start_accuracy);
  visit(OptionField{"start_iterations", "iterations", count, order_of_magnitude,
                    "They take at most so many conjugate gradients."},
        options.start_iterations);
  visit(
      OptionField{
          "motion_rounds", "rounds", count, order_of_magnitude,
          "The free parts continue towards the initial shape in at most so many rounds, where collisions stop others."},
      options.motion_rounds);
  visit(OptionField{"clear_fraction", "-", reduction, order_of_magnitude,
                    "A round covers this fraction of the motion without collision."},
        options.clear_fraction);
  visit(OptionField{"min_smoothing", "-", positive, measured,
                    "This is the last smoothing before sheets wrinkle with kinks."},
        options.min_smoothing);
  visit(OptionField{"smoothing_reduction", "-", reduction, measured,
                    "The smoothing shrinks to this fraction from one solve to the next."},
        options.smoothing_reduction);
  visit(OptionField{"max_smoothing_reduction", "-", reduction, measured,
                    "After a failed solve no larger fraction is tried."},
        options.max_smoothing_reduction);
  visit(
      OptionField{
          "pressure_reduction", "-", reduction, measured,
          "Pressures that had to be larger to stretch the film shrink to this fraction from one solve to the next."},
      options.pressure_reduction);
  visit(OptionField{"max_pressure_reduction", "-", reduction, measured,
                    "After a failed solve no larger fraction is tried."},
        options.max_pressure_reduction);
}

template <OptionsOf<TargetShapeOptions> Options, class Visit>
void visit_fields(Options& options, const Visit& visit) {
  using enum OptionRange;
  using enum OptionKind;
  visit(OptionField{"max_halvings", "halvings", count, measured,
                    "A step is halved at most so often where the energy alone decides."},
        options.max_halvings);
  visit(OptionField{"few_halvings", "halvings", count, measured,
                    "A step is halved at most so often where there is an alternative."},
        options.few_halvings);
  visit(OptionField{"loosest_tolerance", "-", positive, measured,
                    "GMRES has at most this tolerance; less exact directions lead astray on slender robots."},
        options.loosest_tolerance);
  visit(OptionField{"tightest_tolerance", "-", positive, derived,
                    "GMRES has at least this tolerance; below it is rounding."},
        options.tightest_tolerance);
  visit(
      OptionField{"max_steps", "steps", count, measured, "Newton's method makes at most so many steps to the target."},
      options.max_steps);
  visit(OptionField{"max_intermediate_steps", "steps", count, measured,
                    "It makes at most so many to an intermediate equilibrium, which is near."},
        options.max_intermediate_steps);
  visit(OptionField{"max_idle_steps", "steps", count, order_of_magnitude, "So many steps that move nothing end a run."},
        options.max_idle_steps);
  visit(OptionField{"rescue_iterations", "iterations", count, measured,
                    "So many accelerated local-global iterations are made at a time."},
        options.rescue_iterations);
  visit(OptionField{"rescue_window", "iterations", count, measured, "Each of them combines so many earlier ones."},
        options.rescue_window);
  visit(OptionField{"first_patience", "iterations", count, measured,
                    "The first run takes at most so many local-global iterations."},
        options.first_patience);
  visit(OptionField{"patience", "iterations", count, measured,
                    "The run after failed intermediate equilibria takes at most so many."},
        options.patience);
  visit(OptionField{"last_window", "iterations", count, measured,
                    "As the last resort, progress of Algorithm 1 is measured over so many iterations."},
        options.last_window);
  visit(OptionField{"max_last_iterations", "iterations", positive, measured,
                    "It ends if more iterations are left at the rate of this progress."},
        options.max_last_iterations);
  visit(OptionField{"first_fraction", "path", fraction, measured,
                    "The first intermediate equilibrium lies at this fraction of the path."},
        options.first_fraction);
  visit(OptionField{"min_fraction", "path", reduction, order_of_magnitude,
                    "No fraction of the path between intermediate equilibria is smaller."},
        options.min_fraction);
  visit(OptionField{"safe_step", "tolerance", positive, order_of_magnitude,
                    "Another step with the last factor ends the search if it is shorter."},
        options.safe_step);
  visit(OptionField{"armijo", "-", positive, derived,
                    "A step must decrease the energy by this fraction of its slope (Armijo's rule)."},
        options.armijo);
  visit(OptionField{"energy_drop", "-", fraction, measured,
                    "An energy below this multiple of its minimum so far is a success, too."},
        options.energy_drop);
  visit(OptionField{"kept_factor", "-", fraction, measured,
                    "A factor is kept after a step that reduces the preconditioned residual to this fraction."},
        options.kept_factor);
  visit(OptionField{"max_turn", "degrees", positive, measured,
                    "Supports turn at most this far at once, because elements that are turned over stay so."},
        options.max_turn);
}

/// Calls visit(name, description, options) for each group.
template <OptionsOf<SolverOptions> Options, class Visit>
void visit_groups(Options& options, const Visit& visit) {
  visit("step", "Step-size control along the path.", options.path.step);
  visit("acceptance", "Which equilibria are accepted as the end of a step.", options.path.acceptance);
  visit("termination", "Where a path ends before its requested load state.", options.path.termination);
  visit("segment_check", "Checks for limit points between the ends of a step.", options.path.segment_check);
  visit("arc_length", "Arc-length continuation.", options.path.arc_length);
  visit("beyond_turn", "Arc-length continuation past a turning point, with the option stable.",
        options.path.beyond_turn);
  visit("measure", "Continuation with the volume of a chamber or the length of a cable as the parameter.",
        options.path.measure);
  visit("post_limit", "The branch beyond a limit point, along a measure.", options.path.post_limit);
  visit("buckling", "How unstable equilibria are left with the option stable.", options.path.buckling);
  visit("prediction", "The predictor.", options.path.prediction);
  visit("newton", "Iterations and tolerances of Newton's method.", options.newton.convergence);
  visit("line_search", "Damping of Newton steps.", options.newton.line_search);
  visit("regularisation", "How the stiffness is made positive; shifts are over its mean diagonal.",
        options.newton.regularisation);
  visit("factor", "How long a factor serves, and when it is computed in double precision.", options.newton.factor);
  visit("stability", "The lowest mode, and the stiffness along it.", options.newton.stability);
  visit("derivative", "Derivatives of an equilibrium.", options.newton.derivative);
  visit("contact", "Contact continuation and friction updates.", options.contact);
  visit("wrinkling", "Sheets that wrinkle or begin flat.", options.wrinkling);
  visit("target_shape", "The solvers of the target-shape formulation.", options.target_shape);
}

}  // namespace softkin
