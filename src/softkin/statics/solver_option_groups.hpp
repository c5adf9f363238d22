#pragma once

namespace softkin {

// The tuned constants of the solvers, by group. solver_option_fields.hpp has their units, admissible values, kinds and
// sentences, and docs/path_tracking.md their table. The defaults are what was measured to be fast and reliable.

/// Step-size control along the path.
struct StepSizeOptions {
  double min_length = 1e-4;
  double min_smooth_length = 5e-4;
  double min_of_completed = 0.005;
  double shortening = 0.4;
  double failed_gap = 0.35;
  double max_turn = 30;
  double min_remainder = 0.1;
  int few_iterations = 7;
  int some_iterations = 12;
  double few_growth = 2.0;
  double some_growth = 1.5;
  int few_contact_iterations = 15;
  int some_contact_iterations = 30;
  double few_contact_growth = 3.0;
  double some_contact_growth = 2.0;
  double measure_probe = 0.01;
  double max_measure_change = 0.4;

  friend bool operator==(const StepSizeOptions&, const StepSizeOptions&) = default;
};

/// Which equilibria are accepted as the end of a step.
struct AcceptanceOptions {
  double follow_below = 0.05;
  double max_correction = 0.5;
  double min_snap = 0.01;
  double min_snap_fraction = 0.9;
  double snap_length = 0.02;
  double max_inverting = 0.01;
  double max_residual = 0.01;
  double long_fall = 0.2;

  friend bool operator==(const AcceptanceOptions&, const AcceptanceOptions&) = default;
};

/// Where a path ends before its requested load state.
struct TerminationOptions {
  double min_move = 8e-5;
  double min_contact_move = 1e-4;
  int patience = 100;
  int contact_patience = 250;
  double min_progress = 0.02;
  double contact_min_progress = 0.01;
  double progress_factor = 2.0;
  double min_slipping = 0.5;
  int curve_failures = 2;

  friend bool operator==(const TerminationOptions&, const TerminationOptions&) = default;
};

/// Checks for limit points between the ends of a step.
struct SegmentCheckOptions {
  double max_error_ahead = 0.1;
  double max_error_at_an_end = 0.4;
  double max_error_together = 0.2;
  double max_middle_step = 0.05;
  double min_move = 1e-3;
  int max_halvings = 7;
  int max_corrections = 60;
  double rate_difference = 1e-3;
  double middle_accuracy = 1e-3;

  friend bool operator==(const SegmentCheckOptions&, const SegmentCheckOptions&) = default;
};

/// Arc-length continuation.
struct ArcLengthOptions {
  double first_step = 0.5;
  double wanted_error = 0.1;
  double max_error = 1.0;
  double max_growth = 2.0;
  double min_shortening = 0.1;
  double max_shortening = 0.4;
  double max_bend = 0.5;
  double max_middle_step = 0.05;
  double middle_accuracy = 1e-3;
  double max_slope_error = 0.3;
  double min_contraction = 0.5;
  int max_corrections = 8;
  int max_failures = 3;
  int max_iterations = 60;
  double min_step = 0.02;
  double factor_difference = 1e-3;
  double before_turn = 0.02;

  friend bool operator==(const ArcLengthOptions&, const ArcLengthOptions&) = default;
};

/// Arc-length continuation past a turning point, with the option stable.
struct BeyondTurnOptions {
  int max_iterations = 300;
  int max_failures = 8;
  double min_step = 1e-4;
  double min_load_factor = -1.0;

  friend bool operator==(const BeyondTurnOptions&, const BeyondTurnOptions&) = default;
};

/// Continuation with the volume of a chamber or the length of a cable as the parameter.
struct MeasureControlOptions {
  double first_step = 0.02;
  double growth = 1.6;
  double max_first_step = 0.5;
  double max_step = 0.6;
  double min_step = 1e-5;
  int max_steps = 200;
  int max_failures = 6;
  double maximum_slope = 0.01;
  double bracket_margin = 0.05;
  double slope_allowance = 1.5;
  double before_maximum = 0.01;
  double coarse_tolerance = 6000.0;
  double whole_step = 0.9;
  double max_extrapolation = 3.0;
  double max_second_order = 0.5;

  friend bool operator==(const MeasureControlOptions&, const MeasureControlOptions&) = default;
};

/// The branch beyond a limit point, along a measure.
struct PostLimitOptions {
  double first_step = 0.1;
  double growth = 1.6;
  double max_step = 0.5;
  double min_step = 1e-4;
  int max_steps = 200;
  int max_failures = 6;
  int min_points = 8;
  double search_range = 10.0;
  double load_tolerance = 1e-3;
  int max_bisections = 20;

  friend bool operator==(const PostLimitOptions&, const PostLimitOptions&) = default;
};

/// How unstable equilibria are left with the option stable.
struct BucklingOptions {
  int max_buckles = 20;
  int max_descent_steps = 60;
  double energy_tie = 1e-9;
  double small_push = 0.003;
  double medium_push = 0.02;
  double large_push = 0.1;
  double min_departure = 0.1;

  friend bool operator==(const BucklingOptions&, const BucklingOptions&) = default;
};

/// The predictor.
struct PredictionOptions {
  double tangent_accuracy = 1e-3;
  int tangent_rounds = 6;
  double clear_fraction = 0.9;
  double max_cut = 0.5;
  double long_move = 0.05;
  double min_fraction = 1e-3;
  double second_order_move = 5e-3;
  double max_remainder = 0.03;
  int max_stored = 8;
  double min_spacing = 0.2;
  int max_compared = 1000;
  double max_error = 0.3;
  double max_error_tolerances = 100.0;

  friend bool operator==(const PredictionOptions&, const PredictionOptions&) = default;
};

/// Iterations and tolerances of Newton's method.
struct ConvergenceOptions {
  int max_iterations = 30;
  int max_contact_iterations = 100;
  int max_brief_iterations = 10;
  double min_balance_gain = 0.7;
  double constraint_tolerance = 1e-8;
  double coarse_tolerance = 1e5;
  double max_last_error = 0.02;
  double slow_contraction = 0.5;
  int few_modes = 2;
  double poor_damping = 0.2;
  int max_poor_steps = 8;
  double no_contraction = 0.9;
  int max_equal_steps = 12;
  int max_descent_steps = 5;

  friend bool operator==(const ConvergenceOptions&, const ConvergenceOptions&) = default;
};

/// Damping of Newton steps.
struct LineSearchOptions {
  double min_damping = 1e-3;
  double halving = 0.5;
  double runaway = 10.0;
  double armijo = 1e-4;
  double min_slope = 1e-4;
  double max_rise = 1e-8;
  double change_weight = 2.0;
  double multiplier_weight = 0.01;
  double max_extension = 64.0;

  friend bool operator==(const LineSearchOptions&, const LineSearchOptions&) = default;
};

/// How the stiffness is made positive; shifts are over its mean diagonal.
struct RegularisationOptions {
  double slight_shift = 1e-7;
  double clear_shift = 1.0;
  double shift_growth = 30.0;
  double shift_decay = 10.0;
  double min_shift = 1e-5;
  double min_wrinkled_shift = 1e-4;
  double max_shift = 100.0;
  double projected_growth = 10.0;

  friend bool operator==(const RegularisationOptions&, const RegularisationOptions&) = default;
};

/// How long a factor serves, and when it is computed in double precision.
struct RefactorisationOptions {
  double max_distance = 1e-3;
  double max_count_distance = 2e-4;
  double max_contraction = 0.6;
  int max_updates = 8;
  double max_along = 0.5;
  double cost = 6.0;
  double much_rounded = 5e-3;
  double rounded_steps = 100.0;
  double suspect_contraction = 0.25;
  double rounded_change = 0.15;
  double refined_accuracy = 0.03;
  double max_refined_error = 0.3;
  int refinement_rounds = 6;

  friend bool operator==(const RefactorisationOptions&, const RefactorisationOptions&) = default;
};

/// The lowest mode, and the stiffness along it.
struct StabilityOptions {
  double min_shift = 1e-9;
  double max_shift = 1e3;
  double close_shift = 1.1;
  int max_inverse_iterations = 60;
  double curvature_accuracy = 1e-6;
  int softest_iterations = 3;
  double difference = 1e-6;
  double max_change = 0.25;

  friend bool operator==(const StabilityOptions&, const StabilityOptions&) = default;
};

/// Derivatives of an equilibrium.
struct DerivativeOptions {
  int nearby_rounds = 8;
  int exact_rounds = 3;
  int friction_rounds = 40;
  double accuracy_fraction = 0.3;
  double max_rounding = 1e-6;
  double slack_margin = 1e-9;

  friend bool operator==(const DerivativeOptions&, const DerivativeOptions&) = default;
};

/// Contact continuation and friction updates.
struct ContactOptions {
  double soft_modulus = 1e-4;
  double soft_reach = 6.0;
  double soft_reduction = 8.0;
  double fall_reach = 0.1;
  int max_soft_iterations = 20;
  double linear_reach = 2.0;
  int max_force_steps = 20;
  double force_agreement = 0.2;
  double faint_force = 0.01;
  int fixed_friction_rounds = 40;
  int following_friction_rounds = 5;
  double friction_tolerance = 1e-4;
  double piece_turn = 0.7;
  double max_turn = 2.5;
  double min_advance = 1e-3;
  double clear_fraction = 0.95;

  friend bool operator==(const ContactOptions&, const ContactOptions&) = default;
};

/// Sheets that wrinkle or begin flat.
struct WrinklingOptions {
  double mean_slope = 0.3;
  double smoothing = 50.0;
  double max_smoothing = 1e-4;
  double min_strain = 1e-3;
  double start_accuracy = 1e-3;
  int start_iterations = 2000;
  int motion_rounds = 40;
  double clear_fraction = 0.9;
  double min_smoothing = 1e-11;
  double smoothing_reduction = 0.1;
  double max_smoothing_reduction = 0.4;
  double pressure_reduction = 0.2;
  double max_pressure_reduction = 0.9;

  friend bool operator==(const WrinklingOptions&, const WrinklingOptions&) = default;
};

/// The solvers of the target-shape formulation.
struct TargetShapeOptions {
  int max_halvings = 12;
  int few_halvings = 2;
  double loosest_tolerance = 1e-2;
  double tightest_tolerance = 1e-10;
  int max_steps = 80;
  int max_intermediate_steps = 40;
  int max_idle_steps = 4;
  int rescue_iterations = 50;
  int rescue_window = 6;
  int first_patience = 50;
  int patience = 300;
  int last_window = 100;
  double max_last_iterations = 1000.0;
  double first_fraction = 0.25;
  double min_fraction = 0.00390625;
  double safe_step = 0.1;
  double armijo = 1e-4;
  double energy_drop = 0.9;
  double kept_factor = 0.1;
  double max_turn = 10.0;

  friend bool operator==(const TargetShapeOptions&, const TargetShapeOptions&) = default;
};

/// The tuned constants of path tracking.
struct PathOptions {
  StepSizeOptions step{};
  AcceptanceOptions acceptance{};
  TerminationOptions termination{};
  SegmentCheckOptions segment_check{};
  ArcLengthOptions arc_length{};
  BeyondTurnOptions beyond_turn{};
  MeasureControlOptions measure{};
  PostLimitOptions post_limit{};
  BucklingOptions buckling{};
  PredictionOptions prediction{};

  friend bool operator==(const PathOptions&, const PathOptions&) = default;
};

/// The tuned constants of Newton's method and of its factors.
struct NewtonOptions {
  ConvergenceOptions convergence{};
  LineSearchOptions line_search{};
  RegularisationOptions regularisation{};
  RefactorisationOptions factor{};
  StabilityOptions stability{};
  DerivativeOptions derivative{};

  friend bool operator==(const NewtonOptions&, const NewtonOptions&) = default;
};

}  // namespace softkin
