#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/calibration/ratio_fit.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

constexpr double max_log_ratio = 9.210340371976184;  // ln 1e4
constexpr double tolerance = 1e-6;                   // of the logarithm of Eq. (16)
constexpr int max_simulations = 60;

/// The logarithm of a test's ratio, by the logarithm of what Eq. (16) makes of it: nearly a line of slope 1.
class Search {
 public:
  Search(const StretchedSpecimen& specimen, SpecimenTest& test) : specimen_(specimen), test_(test) {}

  void run(double guess, SpecimenFit& fit) {
    const double wanted = std::log(elasticity_ratio(specimen_));
    double x = std::clamp(guess, -max_log_ratio, max_log_ratio);
    while (fit.simulations < max_simulations) {
      const SpecimenResponse found = test_.at(x);
      ++fit.simulations;
      if (found.status != Status::converged) return end(fit, found.status, found.remark);
      const double off = seen(found) - wanted;
      learn_slope(x, off);
      if (std::abs(off) < tolerance || high_ - low_ < tolerance) {
        fit.own_log_ratio = x;
        fit.sensitivity_mm = rod_sensitivity_mm(specimen_) * slope_;
        return end(fit, Status::converged, "");
      }
      (off < 0 ? low_ : high_) = x;
      if (std::abs(x) >= max_log_ratio && (x > 0) == (off < 0))
        return end(fit, Status::limit, "no ratio from 1e-4 to 1e4 moves the interface so far");
      x = next(x, off);
    }
    end(fit, Status::not_converged, "the bisection did not end");
  }

 private:
  static void end(SpecimenFit& fit, Status status, const std::string& remark) {
    fit.status = status;
    fit.remark = remark;
  }

  /// The logarithm of Eq. (16) in the simulated test.
  [[nodiscard]] double seen(const SpecimenResponse& response) const {
    StretchedSpecimen simulated = specimen_;
    simulated.interface_moved_mm =
        std::clamp(response.moved_mm, 1e-9 * specimen_.stretch_mm, (1 - 1e-9) * specimen_.stretch_mm);
    return std::log(elasticity_ratio(simulated));
  }

  void learn_slope(double x, double off) {
    const double rise = (off - last_off_) / (x - last_x_);
    if (std::isfinite(rise) && rise > 0.05 && rise < 20) slope_ = rise;
    last_x_ = x;
    last_off_ = off;
  }

  /// The secant's step, where it stays inside what is known and halves the interval every other time; else the middle.
  double next(double x, double off) {
    const bool bracketed = low_ > -2 * max_log_ratio && high_ < 2 * max_log_ratio;
    const double secant = x - std::clamp(off / slope_, -1.0, 1.0);
    if (!bracketed) return std::clamp(secant, -max_log_ratio, max_log_ratio);
    const double width = high_ - low_;
    const bool slow = width > 0.5 * width_before_last_;
    width_before_last_ = last_width_;
    last_width_ = width;
    if (slow || secant <= low_ || secant >= high_) return 0.5 * (low_ + high_);
    return secant;
  }

  const StretchedSpecimen& specimen_;
  SpecimenTest& test_;
  double low_ = -3 * max_log_ratio, high_ = 3 * max_log_ratio;
  double last_width_ = std::numeric_limits<double>::infinity();
  double width_before_last_ = std::numeric_limits<double>::infinity();
  double slope_ = 1, last_x_ = std::numeric_limits<double>::quiet_NaN(), last_off_ = 0;
};

double guess_of(const StretchedSpecimen& specimen, const SpecimenOptions& options, Formulation formulation) {
  const double ratio = elasticity_ratio(specimen);
  return formulation == Formulation::physical ? std::log(ratio)
                                              : closed_form_log_ratio(ratio, options.stiffer_shape_ratio);
}

/// Least squares of force = modulus x what the force is for 1 MPa.
Moduli moduli_from(const std::vector<double>& forces, const std::vector<double>& unit_forces, double ratio) {
  double products = 0, squares = 0, rest = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    products += forces[i] * unit_forces[i];
    squares += unit_forces[i] * unit_forces[i];
  }
  Moduli moduli;
  moduli.b_mpa = products / squares;
  moduli.a_mpa = ratio * moduli.b_mpa;
  for (std::size_t i = 0; i < forces.size(); ++i) rest += std::pow(forces[i] - moduli.b_mpa * unit_forces[i], 2);
  if (forces.size() > 1)
    moduli.spread =
        std::sqrt(rest / static_cast<double>(forces.size() - 1) / squares * static_cast<double>(forces.size())) /
        moduli.b_mpa;
  moduli.specimens = forces.size();
  return moduli;
}

std::optional<Moduli> simulated_moduli(const std::vector<StretchedSpecimen>& specimens, const SpecimenOptions& options,
                                       const RatioFit& fit) {
  std::vector<double> forces, unit_forces;
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    if (!specimens[i].force_n || fit.specimens[i].status != Status::converged) continue;
    const double simulated_area = options.width_mm * options.height_mm;
    forces.push_back(*specimens[i].force_n);
    unit_forces.push_back(fit.specimens[i].response.force_n * specimens[i].area_mm2.value_or(simulated_area) /
                          simulated_area);
  }
  if (forces.empty()) return std::nullopt;
  return moduli_from(forces, unit_forces, fit.estimate.ratio);
}

/// "physical tensile 3".
std::string test_name(Formulation formulation, const std::string& kind, std::size_t number) {
  return std::string(formulation_name(formulation)) + " " + kind + " " + std::to_string(number);
}

SpecimenFit once(const SpecimenOptions& options, const std::string& test, const std::function<SpecimenFit()>& make) {
  return options.log != nullptr ? options.log->once(test, make) : make();
}

/// Of one test at a ratio, from rest, so that it is the same whatever was simulated before.
template <class Specimen>
SpecimenResponse response_of(const Specimen& specimen, const SpecimenOptions& options, Formulation formulation,
                             double log_ratio, const std::string& kind, std::size_t number) {
  const std::string test = test_name(formulation, kind, number) + " at " + exact(log_ratio);
  return once(options, test,
              [&] {
                SpecimenFit fit;
                fit.response = SpecimenTest(options, formulation, specimen).at(log_ratio);
                fit.status = fit.response.status;
                return fit;
              })
      .response;
}

template <class Specimen>
std::vector<SpecimenResponse> responses_of(const std::vector<Specimen>& specimens, const SpecimenOptions& options,
                                           Formulation formulation, double log_ratio, const std::string& kind,
                                           const FractionDone& progress) {
  std::vector<SpecimenResponse> responses;
  for (const Specimen& specimen : specimens) {
    const std::size_t number = responses.size();
    if (progress) progress(static_cast<double>(number) / static_cast<double>(specimens.size()));
    responses.push_back(response_of(specimen, options, formulation, log_ratio, kind, number));
    if (responses.back().status == Status::interrupted) break;
  }
  return responses;
}

}  // namespace

double elasticity_ratio(const StretchedSpecimen& s) {
  const bool inside = s.interface_mm > 0 && s.interface_mm < s.length_mm && std::isfinite(s.length_mm);
  const bool moved = s.interface_moved_mm > 0 && s.interface_moved_mm < s.stretch_mm && std::isfinite(s.stretch_mm);
  if (!inside || !moved) throw InvalidInput("a specimen needs 0 < L1 < L and 0 < dL1 < dL");
  return s.interface_mm * (s.stretch_mm - s.interface_moved_mm) /
         ((s.length_mm - s.interface_mm) * s.interface_moved_mm);
}

double rod_fraction(double ratio, double length_mm, double interface_mm) {
  return interface_mm / (interface_mm + ratio * (length_mm - interface_mm));
}

double rod_sensitivity_mm(const StretchedSpecimen& s) {
  return s.interface_moved_mm * (s.stretch_mm - s.interface_moved_mm) / s.stretch_mm;
}

RatioEstimate combined_ratio(const std::vector<double>& log_ratios, const std::vector<double>& sensitivities) {
  if (log_ratios.empty() || log_ratios.size() != sensitivities.size())
    throw InvalidInput("a ratio needs at least one specimen");
  double weights = 0, mean = 0;
  for (std::size_t i = 0; i < log_ratios.size(); ++i) {
    const double weight = sensitivities[i] * sensitivities[i];
    weights += weight;
    mean += weight * log_ratios[i];
  }
  mean /= weights;
  if (!std::isfinite(mean)) throw InvalidInput("a specimen's ratio is not finite");
  double squares = 0;
  for (std::size_t i = 0; i < log_ratios.size(); ++i)
    squares += sensitivities[i] * sensitivities[i] * (log_ratios[i] - mean) * (log_ratios[i] - mean);
  const auto count = static_cast<double>(log_ratios.size());
  const auto [least, greatest] = std::minmax_element(log_ratios.begin(), log_ratios.end());
  RatioEstimate estimate;
  estimate.ratio = std::exp(mean);
  if (log_ratios.size() > 1) estimate.spread = std::sqrt(squares / weights * count / (count - 1));
  estimate.least = std::exp(*least);
  estimate.greatest = std::exp(*greatest);
  estimate.specimens = log_ratios.size();
  return estimate;
}

RatioEstimate rod_ratio(const std::vector<StretchedSpecimen>& specimens) {
  std::vector<double> log_ratios, sensitivities;
  for (const StretchedSpecimen& s : specimens) {
    log_ratios.push_back(std::log(elasticity_ratio(s)));
    sensitivities.push_back(rod_sensitivity_mm(s));
  }
  return combined_ratio(log_ratios, sensitivities);
}

double stiffness_of_shape_ratio(double shape_ratio) {
  return 6 * shape_ratio / (2 + shape_ratio);
}

double poisson_ratio_of_shape_ratio(double shape_ratio) {
  return (1 - shape_ratio) / (2 + shape_ratio);
}

double shape_ratio_of_poisson_ratio(double poisson_ratio) {
  return (1 - 2 * poisson_ratio) / (1 + poisson_ratio);
}

double closed_form_log_ratio(double elasticity_ratio, double stiffer) {
  const double softer_stiffness = stiffness_of_shape_ratio(stiffer) * std::exp(-std::abs(std::log(elasticity_ratio)));
  const double softer = 2 * softer_stiffness / (6 - softer_stiffness);
  const double log_ratio = std::log(stiffer / softer);
  return elasticity_ratio >= 1 ? log_ratio : -log_ratio;
}

RatioFit fit_ratio(const std::vector<StretchedSpecimen>& specimens, const SpecimenOptions& options,
                   Formulation formulation, const FractionDone& progress) {
  if (specimens.empty()) throw InvalidInput("a ratio needs at least one specimen");
  RatioFit result;
  result.formulation = formulation;
  std::vector<double> log_ratios, sensitivities;
  for (const StretchedSpecimen& specimen : specimens) {
    const std::size_t number = result.specimens.size();
    if (progress) progress(static_cast<double>(number) / static_cast<double>(specimens.size()));
    result.specimens.push_back(once(options, test_name(formulation, "tensile", number), [&] {
      SpecimenFit fit;
      SpecimenTest test(options, formulation, specimen);
      Search(specimen, test).run(guess_of(specimen, options, formulation), fit);
      return fit;
    }));
    const SpecimenFit& fit = result.specimens.back();
    if (fit.status == Status::interrupted) {
      result.status = fit.status;
      return result;
    }
    if (fit.status != Status::converged) continue;
    log_ratios.push_back(fit.own_log_ratio);
    sensitivities.push_back(fit.sensitivity_mm);
  }
  if (log_ratios.empty()) return result;
  result.estimate = combined_ratio(log_ratios, sensitivities);
  result.status = Status::converged;
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    SpecimenFit& fit = result.specimens[i];
    if (fit.status == Status::converged) {
      fit.response = response_of(specimens[i], options, formulation, std::log(result.estimate.ratio), "tensile", i);
      fit.status = fit.response.status;
      fit.remark = fit.response.remark;
    }
    if (fit.status != Status::converged) result.status = fit.status;
    if (fit.status == Status::interrupted) return result;
  }
  if (formulation == Formulation::physical) result.moduli = simulated_moduli(specimens, options, result);
  return result;
}

std::vector<SpecimenResponse> predict(const std::vector<StretchedSpecimen>& specimens, const SpecimenOptions& options,
                                      Formulation formulation, double log_ratio, const FractionDone& progress) {
  return responses_of(specimens, options, formulation, log_ratio, "tensile", progress);
}

std::vector<SpecimenResponse> predict(const std::vector<TwistedSpecimen>& specimens, const SpecimenOptions& options,
                                      Formulation formulation, double log_ratio, const FractionDone& progress) {
  return responses_of(specimens, options, formulation, log_ratio, "twist", progress);
}

std::optional<Moduli> rod_moduli(const std::vector<StretchedSpecimen>& specimens, double area_mm2) {
  std::vector<double> forces, unit_forces;
  for (const StretchedSpecimen& s : specimens) {
    if (!s.force_n) continue;
    const double strain_b = (s.stretch_mm - s.interface_moved_mm) / (s.length_mm - s.interface_mm);
    forces.push_back(*s.force_n);
    unit_forces.push_back(s.area_mm2.value_or(area_mm2) * strain_b);
  }
  if (forces.empty()) return std::nullopt;
  return moduli_from(forces, unit_forces, rod_ratio(specimens).ratio);
}

}  // namespace softkin::calibration
