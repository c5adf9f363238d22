#include <cmath>
#include <softkin/calibration/specimen_report.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

/// How a simulated tensile test of a specimen ended, and why.
std::pair<Status, std::string> end_of(const SimulatedTests& tests, std::size_t specimen) {
  if (tests.fit) return {tests.fit->specimens[specimen].status, tests.fit->specimens[specimen].remark};
  return {tests.stretched[specimen].status, tests.stretched[specimen].remark};
}

}  // namespace

const RatioFit* SpecimenResults::fit(Formulation formulation) const {
  for (const SimulatedTests& tests : simulated)
    if (tests.is(formulation)) return &*tests.fit;
  return nullptr;
}

SpecimenResults evaluate(const SpecimenTask& task, std::vector<StretchedSpecimen> specimens,
                         std::vector<TwistedSpecimen> twists,
                         const std::function<void(const std::string&, double)>& progress) {
  const auto told = [&](const std::string& what) -> ShareDone {
    if (!progress) return {};
    return [&progress, what](double share) { progress(what, share); };
  };
  SpecimenResults results{std::move(specimens), std::move(twists), {}, {}, {}};
  std::vector<double> logs, weights;
  for (const StretchedSpecimen& s : results.specimens) {
    logs.push_back(std::log(elasticity_ratio(s)));
    weights.push_back(rod_sensitivity_mm(s));
  }
  results.rod = combined_ratio(logs, weights);
  results.rod_moduli = rod_moduli(results.specimens, task.options.width_mm * task.options.height_mm);
  const auto fit = [&](Formulation formulation) {
    SimulatedTests tests{formulation_name(formulation), {}, 1, {}, {}};
    tests.fit = fit_ratio(results.specimens, task.options, formulation, told(tests.name + " tensile tests"));
    tests.ratio = tests.fit->estimate.ratio;
    for (const SpecimenFit& each : tests.fit->specimens) tests.stretched.push_back(each.response);
    if (tests.fit->estimate.specimens > 0)
      tests.twisted =
          predict(results.twists, task.options, formulation, std::log(tests.ratio), told(tests.name + " twist tests"));
    results.simulated.push_back(std::move(tests));
  };
  if (task.physical) fit(Formulation::physical);
  if (!task.target_shape) return results;
  fit(Formulation::target_shape);
  for (const double ratio : task.tried) {
    const auto predicted = [&](const auto& tests) {
      return predict(tests, task.options, Formulation::target_shape, std::log(ratio), told("ratios to try"));
    };
    results.simulated.push_back(
        {"R_A / R_B " + number(ratio), std::nullopt, ratio, predicted(results.specimens), predicted(results.twists)});
  }
  return results;
}

std::string failure(const SpecimenTask& task, const SpecimenResults& results) {
  const auto words = [](const std::string& file, std::size_t line, const std::string& what, Status status,
                        const std::string& remark) {
    return file + ":" + std::to_string(line) + ": the simulated " + what + " test has status " + name_of(status) +
           (remark.empty() ? "" : ": " + remark);
  };
  for (const SimulatedTests& tests : results.simulated) {
    const std::string name = tests.fit ? tests.name : "--try";
    for (std::size_t i = 0; i < results.specimens.size(); ++i)
      if (const auto [status, remark] = end_of(tests, i); status != Status::converged)
        return words(task.file, results.specimens[i].line, name + " tensile", status, remark);
    for (std::size_t i = 0; i < tests.twisted.size(); ++i)
      if (tests.twisted[i].status != Status::converged)
        return words(task.twist_file, results.twists[i].line, name + " twist", tests.twisted[i].status,
                     tests.twisted[i].remark);
  }
  return "";
}

std::string specimens_fragment(const SpecimenTask& task, const SpecimenResults& results) {
  std::string a = "  - {region: " + task.regions[0], b = "  - {region: " + task.regions[1];
  std::string remark;
  const RatioFit *physical = results.fit(Formulation::physical), *target = results.fit(Formulation::target_shape);
  if (target != nullptr) {
    const ShapeRatios shape = shape_ratios(std::log(target->estimate.ratio), task.options.stiffer_shape_ratio);
    a += ", shape_ratio: " + number(shape.a, 5);
    b += ", shape_ratio: " + number(shape.b, 5);
  }
  if (physical != nullptr) {
    const double ratio = physical->estimate.ratio;
    std::optional<Moduli> moduli = physical->moduli;
    if (!moduli && task.modulus_b) moduli = Moduli{ratio * *task.modulus_b, *task.modulus_b};
    if (moduli) {
      const Law law = task.options.law;
      const std::string rest = ", poisson_ratio: " + number(task.options.poisson_ratio) +
                               (law == Law::neo_hookean ? "" : std::string(", law: ") + law_name(law));
      a += ", youngs_modulus: " + number(moduli->a_mpa, 5) + rest;
      b += ", youngs_modulus: " + number(moduli->b_mpa, 5) + rest;
    } else {
      remark = "  # physical: youngs_modulus of " + task.regions[0] + " = " + number(ratio, 5) + " x that of " +
               task.regions[1] + "; a column force_n or --modulus-b gives both\n";
    }
  }
  if (target == nullptr && !remark.empty()) return "# no materials without a modulus\n" + remark;
  return "materials:   # softkin calibrate material " + printable(task.file) + "\n" + a + "}\n" + b + "}\n" + remark;
}

}  // namespace softkin::calibration
