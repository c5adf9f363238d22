#include <cmath>
#include <softkin/calibration/actuator_tasks.hpp>
#include <softkin/calibration/voltage.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/table/measurements.hpp>

namespace softkin::calibration {

namespace {

constexpr int curve_points = 65;
constexpr double rest_remark = 1e-3;      // from 1, beyond which the table's area ratio without voltage is told
constexpr double rest_tolerance = 0.005;  // of the atmosphere, beyond which a sensor's rest is remarked on

/// The runs of all files. head: a line for each file; more: what else is told of a file's first run
template <class Read, class More>
auto read_all(const std::vector<std::string>& files, const Read& read, std::string& head, const More& more) {
  decltype(read(files.front())) all;
  for (const std::string& file : files) {
    const auto runs = read(file);
    std::size_t rows = 0;
    for (const auto& run : runs) rows += run.rows.size();
    head += file + ": " + counted(runs.size(), "run") + ", " + counted(rows, "row") + more(runs.front()) + "\n";
    all.insert(all.end(), runs.begin(), runs.end());
  }
  return all;
}

DeaResults measured(const DeaTask& task, const std::string& name) {
  std::string head;
  const std::vector<VoltageRun> runs = read_all(task.tests, read_voltage_runs, head, [](const auto&) { return ""; });
  VoltageSamples samples = voltage_samples(runs);
  for (std::size_t r = 0; r < runs.size(); ++r)
    if (std::abs(samples.rest_ratios[r] - 1) > rest_remark)
      head += runs[r].file + ", " + runs[r].name + ": area ratio without voltage " + number(samples.rest_ratios[r], 5) +
              "; the others are taken over it\n";
  return {fitted_curve(name, CurveInput::voltage, 100, std::move(samples.samples)), head};
}

Dielectric elastomer_of(const DeaTask& task) {
  Dielectric d;
  d.law = task.law == "gent" ? DielectricLaw::gent : DielectricLaw::neo_hookean;
  const auto need = [&](const std::optional<double>& value, const char* option) {
    if (!value) throw InvalidInput("--law " + task.law + " needs " + option);
    return *value;
  };
  d.shear_modulus_MPa = need(task.shear_modulus_MPa, "--shear-modulus");
  d.relative_permittivity = need(task.permittivity, "--permittivity");
  d.thickness_mm = need(task.thickness_mm, "--thickness");
  d.prestretch = task.prestretch.value_or(1);
  if (d.law == DielectricLaw::gent) d.stretch_limit = need(task.stretch_limit, "--stretch-limit");
  return d;
}

std::string elastomer_text(const DeaTask& task, const Dielectric& d) {
  std::string text = task.law + " elastomer in equal-biaxial tension: shear modulus " + number(d.shear_modulus_MPa) +
                     " MPa, relative permittivity " + number(d.relative_permittivity) + ", " + number(d.thickness_mm) +
                     " mm thick before any stretch, prestretch " + number(d.prestretch) +
                     (task.prestretch ? "" : " (default)");
  if (d.law == DielectricLaw::gent) text += ", J_lim " + number(d.stretch_limit);
  return text + "; constant forces at its edge\n";
}

std::string pull_in_text(const Dielectric& d, const PullIn& pull_in) {
  return "pull-in at " + number(pull_in.voltage_kV, 5) + " kV: stretch " + number(pull_in.stretch, 5) +
         " (area ratio " + number(std::pow(pull_in.stretch / d.prestretch, 2), 5) +
         " to that without voltage), field " + number(pull_in.field_kV_mm, 4) +
         " kV/mm; beyond it no equilibrium follows\n";
}

DeaResults computed(const DeaTask& task, const std::string& name) {
  const Dielectric d = elastomer_of(task);
  const DielectricCurve curve = dielectric_curve(d, curve_points, task.breakdown_kV_mm.value_or(0));
  std::string head = elastomer_text(task, d);
  head += curve.pull_in ? pull_in_text(d, *curve.pull_in)
                        : "no pull-in: the voltage rises up to 95 % of the limit of the chains\n";
  if (curve.broken_down)
    head += "breakdown field of " + number(*task.breakdown_kV_mm) + " kV/mm reached at " +
            number(curve.voltages.back(), 5) + " kV, " + (curve.pull_in ? "before pull-in" : "and") +
            ": the curve ends there\n";
  else
    head += "true field at the end of the curve: " + number(curve.end_field_kV_mm, 4) + " kV/mm" +
            (task.breakdown_kV_mm ? "" : " (no --breakdown-field given: not checked)") + "\n";
  const std::string end = curve.broken_down ? "breakdown" : curve.pull_in ? "pull-in" : "the limit of the chains";
  const CurveBranch branch{MonotoneCurve(curve.voltages, curve.area_ratios), {}};
  return {{{name, CurveInput::voltage, 100, end, branch, std::nullopt}}, head, curve};
}

/// By Eq. (19) the ratio is 1 at rest only where the sensor then reads the atmosphere.
std::string remark_on_rest(const SyringeSetup& setup, const SyringeRun& run) {
  const std::optional<double> rest = rest_pressure(setup, run);
  if (!rest || std::abs(*rest - setup.atmosphere_kPa) <= rest_tolerance * setup.atmosphere_kPa) return "";
  return "note: " + run.file + ", " + run.name + ": the sensor reads " + number(*rest, 5) +
         " kPa absolute with the syringe at rest, and the atmosphere counts as " + number(setup.atmosphere_kPa, 5) +
         " kPa: if the sensor is right, give --atmosphere " + number(*rest, 5) + "\n";
}

}  // namespace

SyringeResults evaluate(const SyringeTask& task, const std::string& name) {
  std::string head;
  const std::vector<SyringeRun> runs = read_all(
      task.tests, [&](const std::string& file) { return read_syringe_runs(file, task.scale); }, head,
      [](const SyringeRun& run) {
        return run.scale == PressureScale::absolute ? ", absolute pressures" : ", gauge pressures";
      });
  std::vector<SyringeSample> samples = chamber_ratios(task.setup, runs);
  std::vector<CurveSample> points;
  for (const SyringeSample& each : samples) points.push_back(each.sample);
  FittedCurve fitted = fitted_curve(name, CurveInput::pressure, task.setup.atmosphere_kPa, std::move(points));
  for (const SyringeRun& run : runs) head += remark_on_rest(task.setup, run);
  return {std::move(fitted), head, std::move(samples)};
}

DeaResults evaluate(const DeaTask& task, const std::string& name) {
  return task.tests.empty() ? computed(task, name) : measured(task, name);
}

}  // namespace softkin::calibration
