#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/calibration/maxwell_element.hpp>

namespace softkin::calibration {

namespace {

constexpr int max_halvings = 40;

/// How far a step of length x relaxation times goes.
struct Relaxing {
  explicit Relaxing(double length) : x(length), kept(std::exp(-length)) {
    constexpr double small = 1e-2;  // below it the series, whose next term is smaller than the rounding of the others
    if (x < small) {
      place = 0.5 - x / 12 + x * x * x / 720;
      place_by_x = -1.0 / 12 + x * x / 240;
    } else {
      place = 1 / x - kept / -std::expm1(-x);
      place_by_x = -1 / (x * x) + kept / (std::expm1(-x) * std::expm1(-x));
    }
  }

  double x, kept;            // kept: w = exp(-x)
  double place, place_by_x;  // of the stretch that counts, seen from the step's end: 0 there, 1 at its beginning
};

/// ln(a) after a step, and its derivatives.
struct Stepped {
  double log_a = 0;
  double by_log_a = 1, by_begin = 0, by_end = 0, by_log_time = 0;  // begin, end: the stretches there
};

Stepped stepped(const Relaxing& r, double log_a, double begin, double end) {
  const double l = end + (begin - end) * r.place, w = r.kept, moved = -std::expm1(-r.x);
  const double a2 = std::exp(2 * log_a), a_inverse = std::exp(-log_a);
  const double along = w * a2 + moved * l * l, across = w * a_inverse + moved / l;
  const double by_l = moved * (2 * l / along + 1 / (l * l * across)) / 3;
  const double by_w = ((a2 - l * l) / along - (a_inverse - 1 / l) / across) / 3;
  Stepped result;
  result.log_a = std::log(along / across) / 3;
  result.by_log_a = w * (2 * a2 / along + a_inverse / across) / 3;
  result.by_begin = by_l * r.place;
  result.by_end = by_l * (1 - r.place);
  result.by_log_time = by_w * r.x * w - by_l * (begin - end) * r.place_by_x * r.x;
  return result;
}

/// P of a branch of 1 MPa, and its derivatives.
struct BranchStress {
  BranchStress(double log_a, double l) {
    const double a = std::exp(log_a), pull = l / (a * a), push = a / (l * l);
    value = pull - push;
    by_log_a = -2 * pull - push;
    by_stretch = (pull + 2 * push) / l;
  }
  double value, by_log_a, by_stretch;
};

// A step of first order, whose error has all powers of its length, is done in 1, 2, 3 and 4 parts, and extrapolated:
// order four, and order three from all but the first. At small strains the step is exact by itself.
constexpr int max_parts = 4;

template <class Value>
Value fourth_order(const std::array<Value, max_parts>& parts) {
  return -1.0 / 6 * parts[0] + 4 * parts[1] - 13.5 * parts[2] + 32.0 / 3 * parts[3];
}

template <class Value>
Value third_order(const std::array<Value, max_parts>& parts) {
  return 2 * parts[1] - 9 * parts[2] + 8 * parts[3];
}

/// One branch under a stretch that is imposed.
struct Imposed {
  double time_s, tolerance;
  double log_a = 0, by_log_time = 0;

  void advance(double h, double begin, double end, int halvings = 0) {
    std::array<double, max_parts> ends{}, slopes{};
    for (int parts = 1; parts <= max_parts; ++parts) {
      const Relaxing r(h / parts / time_s);
      double value = log_a, slope = by_log_time;
      for (int i = 0; i < parts; ++i) {
        const auto at = [&](int part) { return begin + (end - begin) * part / parts; };
        const Stepped step = stepped(r, value, at(i), at(i + 1));
        slope = step.by_log_a * slope + step.by_log_time;
        value = step.log_a;
      }
      ends[parts - 1] = value;
      slopes[parts - 1] = slope;
    }
    if (std::abs(fourth_order(ends) - third_order(ends)) <= tolerance || halvings >= max_halvings) {
      log_a = fourth_order(ends);
      by_log_time = fourth_order(slopes);
      return;
    }
    const double middle = 0.5 * (begin + end);
    advance(h / 2, begin, middle, halvings + 1);
    advance(h / 2, middle, end, halvings + 1);
  }
};

/// Logarithms of the stretch, then of the branches' viscous stretches, and their derivatives by the requested numbers.
struct LoadedState {
  Eigen::VectorXd logs;
  Eigen::MatrixXd slopes;
};

/// All branches under an imposed stress. Derivatives are by the numbers of the law, and by modulus and ln(time) of each
/// branch; where derivatives by the law's numbers are not requested, there are none at all.
class Loaded {
 public:
  Loaded(const MaxwellElement& element, const LawSlopes& law_slopes, double tolerance)
      : element_(element), law_slopes_(law_slopes), tolerance_(tolerance) {
    const Eigen::Index branches = element.branches.size();
    law_columns_ = law_slopes ? law_slopes(1).size() : 0;
    now_.logs = Eigen::VectorXd::Zero(branches + 1);
    now_.slopes = Eigen::MatrixXd::Zero(branches + 1, law_slopes ? law_columns_ + 2 * branches : 0);
  }

  [[nodiscard]] double stretch() const { return std::exp(now_.logs[0]); }
  [[nodiscard]] Eigen::RowVectorXd slopes() const { return stretch() * now_.slopes.row(0); }

  /// At once, with no time for the branches to move.
  [[nodiscard]] bool load(double stress) {
    const LoadedState before = now_;
    return balance(before, now_, 0, stress);
  }

  [[nodiscard]] bool advance(double h, double begin, double end, int halvings = 0) {
    std::array<Eigen::VectorXd, max_parts> logs;
    std::array<Eigen::MatrixXd, max_parts> slopes;
    bool found = true;
    for (int parts = 1; parts <= max_parts && found; ++parts) {
      LoadedState state = now_;
      for (int i = 1; i <= parts && found; ++i) {
        const LoadedState before = state;
        found = balance(before, state, h / parts, begin + (end - begin) * i / parts);
      }
      logs[parts - 1] = std::move(state.logs);
      slopes[parts - 1] = std::move(state.slopes);
    }
    if (found) {
      const Eigen::VectorXd better = fourth_order(logs);
      if ((better - third_order(logs)).cwiseAbs().maxCoeff() <= tolerance_) {
        now_ = {better, fourth_order(slopes)};
        return load(end);
      }
    }
    if (halvings >= max_halvings) return false;
    const double middle = 0.5 * (begin + end);
    return advance(h / 2, begin, middle, halvings + 1) && advance(h / 2, middle, end, halvings + 1);
  }

 private:
  /// At a stretch: the stress, its slope by the stretch, and how each branch got there.
  struct Pull {
    double stress = 0, slope = 0;
    std::vector<Stepped> steps;
  };

  /// Newton's method for the stretch at the end of a step of h that carries the stress; h 0: the branches stay.
  [[nodiscard]] bool balance(const LoadedState& before, LoadedState& after, double h, double stress) const {
    constexpr int max_iterations = 100;
    constexpr double longest = 0.3, enough = 1e-12;
    for (int i = 0; i < max_iterations; ++i) {
      const Pull pull = pull_at(before, after.logs[0], h);
      const double l = std::exp(after.logs[0]), step = (stress - pull.stress) / (pull.slope * l);
      if (!std::isfinite(step) || !(pull.slope > 0)) return false;
      after.logs[0] += within_limit(l, std::clamp(step, -longest, longest));
      if (std::abs(step) > enough) continue;
      for (std::size_t b = 0; b < pull.steps.size(); ++b) after.logs[b + 1] = pull.steps[b].log_a;
      if (after.slopes.cols() > 0) derive(before, after, pull);
      return true;
    }
    return false;
  }

  [[nodiscard]] Pull pull_at(const LoadedState& before, double log_stretch, double h) const {
    constexpr double nudge = 1e-6;
    const double begin = std::exp(before.logs[0]), l = std::exp(log_stretch);
    const auto of_law = [&](double stretch) { return uniaxial_stress(element_.law, stretch - 1); };
    Pull pull{of_law(l), (of_law(l + nudge) - of_law(l - nudge)) / (2 * nudge), {}};
    for (std::size_t b = 0; b < element_.branches.size(); ++b) {
      const ViscousBranch& branch = element_.branches[b];
      Stepped step{before.logs[b + 1]};
      if (h > 0) step = stepped(Relaxing(h / branch.time_s), step.log_a, begin, l);
      const BranchStress stress(step.log_a, l);
      pull.stress += branch.modulus_MPa * stress.value;
      pull.slope += branch.modulus_MPa * (stress.by_stretch + stress.by_log_a * step.by_end);
      pull.steps.push_back(step);
    }
    return pull;
  }

  /// What the balance of stresses makes of derivatives.
  void derive(const LoadedState& before, LoadedState& after, const Pull& pull) const {
    const double begin = std::exp(before.logs[0]), l = std::exp(after.logs[0]);
    Eigen::RowVectorXd by_all = Eigen::RowVectorXd::Zero(after.slopes.cols());  // of the stress, the stretch held
    by_all.head(law_columns_) = law_slopes_(l).transpose();
    for (std::size_t b = 0; b < pull.steps.size(); ++b) {
      const Eigen::Index row = static_cast<Eigen::Index>(b) + 1, column = law_columns_ + 2 * (row - 1);
      const Stepped& step = pull.steps[b];
      const BranchStress stress(step.log_a, l);
      after.slopes.row(row) = step.by_log_a * before.slopes.row(row) + step.by_begin * begin * before.slopes.row(0);
      after.slopes(row, column + 1) += step.by_log_time;
      by_all += element_.branches[b].modulus_MPa * stress.by_log_a * after.slopes.row(row);
      by_all[column] += stress.value;
    }
    after.slopes.row(0) = -by_all / (pull.slope * l);
    for (std::size_t b = 0; b < pull.steps.size(); ++b)
      after.slopes.row(static_cast<Eigen::Index>(b) + 1) += pull.steps[b].by_end * l * after.slopes.row(0);
  }

  /// A step of ln(l) that stays where the law has a stress.
  [[nodiscard]] double within_limit(double l, double step) const {
    if (element_.law.jm <= 0) return step;
    const auto excess = [&](double s) { return s * s + 2 / s - 3; };
    while (excess(l * std::exp(step)) >= element_.law.jm) step /= 2;
    return step;
  }

  const MaxwellElement& element_;
  const LawSlopes& law_slopes_;
  double tolerance_;
  Eigen::Index law_columns_ = 0;
  LoadedState now_;
};

}  // namespace

UnitBranch unit_branch(const History& stretches, double time_s, double tolerance) {
  const Eigen::Index size = stretches.time_s.size();
  UnitBranch result{Eigen::VectorXd(size), Eigen::VectorXd(size)};
  Imposed branch{time_s, tolerance};
  for (Index i = 0; i < size; ++i) {
    const double l = stretches.value[i];
    if (i > 0) branch.advance(stretches.time_s[i] - stretches.time_s[i - 1], stretches.value[i - 1], l);
    const BranchStress stress(branch.log_a, l);
    result.stress[i] = stress.value;
    result.by_log_time[i] = stress.by_log_a * branch.by_log_time;
  }
  return result;
}

Eigen::VectorXd stress_under(const MaxwellElement& element, const History& stretches) {
  Eigen::VectorXd stress(stretches.value.size());
  for (Index i = 0; i < stress.size(); ++i) stress[i] = uniaxial_stress(element.law, stretches.value[i] - 1);
  for (const ViscousBranch& branch : element.branches)
    stress += branch.modulus_MPa * unit_branch(stretches, branch.time_s).stress;
  return stress;
}

std::optional<LoadedStretch> stretch_under(const MaxwellElement& element, const History& stresses,
                                           const LawSlopes& law_slopes, double tolerance) {
  Loaded loaded(element, law_slopes, tolerance);
  const Eigen::Index size = stresses.value.size();
  LoadedStretch result{Eigen::VectorXd(size), Eigen::MatrixXd(size, loaded.slopes().size())};
  for (Eigen::Index i = 0; i < size; ++i) {
    const bool found =
        i == 0 ? loaded.load(stresses.value[0])
               : loaded.advance(stresses.time_s[i] - stresses.time_s[i - 1], stresses.value[i - 1], stresses.value[i]);
    if (!found) return std::nullopt;
    result.stretch[i] = loaded.stretch();
    result.slopes.row(i) = loaded.slopes();
  }
  return result;
}

}  // namespace softkin::calibration
