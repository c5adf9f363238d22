#include <algorithm>
#include <cmath>
#include <softkin/calibration/report_parts.hpp>
#include <softkin/calibration/tensile_report.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

std::string name_of(const FittedLaw& law) {
  return law_name(law.fit.law.law);
}

/// The law with the fewest constants whose rms is small beside the stresses fitted, else the best.
std::string choose(const TensileResults& results) {
  constexpr double enough = 0.01;
  const std::vector<double>& stress = results.curve.stress;
  const std::ptrdiff_t points = results.laws.front().fit.points;
  const double largest = *std::max_element(stress.begin(), stress.begin() + points);
  const FittedLaw* best = &results.laws.front();
  for (const FittedLaw& each : results.laws) {
    if (each.fit.quality.rms_mpa <= enough * largest) return name_of(each);
    if (each.fit.quality.rms_mpa < best->fit.quality.rms_mpa) best = &each;
  }
  return name_of(*best);
}

std::string law_yaml(const FittedLaw& law) {
  const auto key = [](const char* name, const std::optional<double>& value) {
    return value ? std::string(", ") + name + ": " + number(*value, 5) : "";
  };
  const ElasticSpec& scene = law.scene;
  return "law: " + name_of(law) + key("youngs_modulus", scene.youngs_modulus) + key("c10", scene.c10) +
         key("c01", scene.c01) + key("c20", scene.c20) + key("c30", scene.c30) +
         key("poisson_ratio", scene.poisson_ratio);
}

/// A law by its name, or the line where it is linear.
std::string entry(const TensileTask& task, const TensileResults& results, const std::string& name) {
  const LinearRange& linear = results.linear;
  std::string what = "law: neo-hookean, youngs_modulus: " + number(linear.modulus_mpa, 5) +
                     ", poisson_ratio: " + number(task.poisson_ratio);
  for (const FittedLaw& each : results.laws)
    if (name_of(each) == name) what = law_yaml(each);
  return "- {region: " + task.region + ", " + what + ", linear_range: " + number(linear.end_strain, 4) + "}";
}

std::string constants_text(const IncompressibleLaw& law) {
  std::string text = "c10 " + number(law.c10, 5);
  if (law.law == Law::mooney_rivlin) text += ", c01 " + number(law.c01, 5);
  if (law.law == Law::yeoh) text += ", c20 " + number(law.c20, 5) + ", c30 " + number(law.c30, 5);
  return text;
}

std::string notes(const TensileResults& results) {
  std::string text;
  constexpr double most_offset = 0.02;
  const LinearRange& linear = results.linear;
  if (std::abs(linear.offset_mpa) > most_offset * linear.modulus_mpa * linear.end_strain)
    text += "note: the straight line that fits the linear range best passes " + number(linear.offset_mpa, 3) +
            " MPa at strain 0: was the test zeroed?\n";
  for (const FittedLaw& each : results.laws) {
    if (each.fit.at_bound)
      text += "note: " + name_of(each) +
              " without a bound has an initial modulus near 0 or below; it is held at 1 % of the mean secant modulus\n";
    if (each.fit.falls_at)
      text += "note: " + name_of(each) + ": the stress falls beyond a strain of " + decimal(*each.fit.falls_at, 2) +
              ": the material would be unstable there\n";
  }
  return text;
}

Json quality_json(const FitQuality& quality) {
  return {{"r_squared", quality.r_squared}, {"rms_MPa", quality.rms_mpa}, {"largest_MPa", quality.largest_mpa}};
}

Json law_json(const FittedLaw& each) {
  const IncompressibleLaw& law = each.fit.law;
  return {{"c10_MPa", law.c10},
          {"c01_MPa", law.c01},
          {"c20_MPa", law.c20},
          {"c30_MPa", law.c30},
          {"youngs_modulus_MPa", law.youngs_modulus()},
          {"at_bound", each.fit.at_bound},
          {"points", each.fit.points},
          {"quality", quality_json(each.fit.quality)},
          {"quality_in_scene", quality_json(each.scene_quality)},
          {"falls_at_strain", or_null(each.fit.falls_at)}};
}

std::vector<double> stresses(const FittedLaw& law, const std::vector<double>& strains) {
  std::vector<double> all;
  for (const double strain : strains) all.push_back(uniaxial_stress(law.fit.law, strain));
  return all;
}

Table law_table(const TensileTask& task, const TensileResults& results) {
  Table table{{{.key = "law", .left = true},
               {.key = "constants, incompressible", .unit = "MPa", .left = true},
               significant("E at rest", "MPa", 5),
               decimals("R^2", "", 5),
               significant("rms", "MPa", 3),
               significant("largest", "MPa", 3),
               significant("in a scene at nu " + number(task.poisson_ratio) + ": rms", "MPa", 3)}};
  for (const FittedLaw& each : results.laws) {
    const FitQuality& quality = each.fit.quality;
    table.rows.push_back({name_of(each), constants_text(each.fit.law), each.fit.law.youngs_modulus(), quality.r_squared,
                          quality.rms_mpa, quality.largest_mpa, each.scene_quality.rms_mpa});
  }
  return table;
}

}  // namespace

TensileResults evaluate(const TensileTask& task, TensileCurve curve) {
  TensileResults results{std::move(curve), {}, {}, {}};
  try {
    results.linear = linear_range(results.curve, task.tolerance_percent / 100);
    for (const Law law : {Law::neo_hookean, Law::mooney_rivlin, Law::yeoh}) {
      const LawFit fit = fit_law(results.curve, law, task.most_strain);
      const ElasticSpec scene = scene_constants(fit.law, task.poisson_ratio);
      results.laws.push_back({fit, scene, scene_quality(results.curve, scene, task.most_strain)});
    }
  } catch (const InvalidInput& error) {
    throw InvalidInput({task.file}, error.what());
  }
  results.chosen = task.law.empty() ? choose(results) : task.law;
  return results;
}

std::string tensile_text(const TensileTask& task, const TensileResults& results) {
  const LinearRange& linear = results.linear;
  return "E " + number(linear.modulus_mpa, 5) + " MPa, linear up to a strain of " + number(linear.end_strain, 4) +
         (linear.whole ? ", the end of the data" : "") + " (" + counted(linear.points, "point") +
         "): no stress there is off the line by more than\n" + number(task.tolerance_percent) +
         " % of the line's stress at the end; R^2 " + decimal(linear.quality.r_squared, 5) + ", rms " +
         number(linear.quality.rms_mpa, 3) + " MPa\n\n" + text_of(law_table(task, results)) + notes(results) + "\n" +
         tensile_fragment(task, results);
}

std::string tensile_json(const TensileTask& task, const TensileResults& results) {
  const LinearRange& linear = results.linear;
  Json json{{"softkin", SOFTKIN_VERSION},
            {"tensile_file", task.file},
            {"points", results.curve.strain.size()},
            {"poisson_ratio", task.poisson_ratio}};
  json["linear"] = {
      {"youngs_modulus_MPa", linear.modulus_mpa},  {"end_strain", linear.end_strain}, {"points", linear.points},
      {"tolerance", task.tolerance_percent / 100}, {"ends_with_data", linear.whole},  {"offset_MPa", linear.offset_mpa},
      {"quality", quality_json(linear.quality)}};
  for (const FittedLaw& each : results.laws) json["laws"][name_of(each)] = law_json(each);
  json["chosen"] = results.chosen;
  json["materials_yaml"] = tensile_fragment(task, results);
  return text_of(json);
}

Plot tensile_plot(const TensileTask& task, const TensileResults& results) {
  const TensileCurve& curve = results.curve;
  const LinearRange& linear = results.linear;
  PlotPanel curves = panel_of("Tensile test", "nominal strain [-]", "nominal stress [MPa]");
  PlotPanel off = panel_of("Fit less measurement", curves.x.label, curves.y.label);
  curves.series = {{"measured", curve.strain, curve.stress, false},
                   {"E " + number(linear.modulus_mpa, 4) + " MPa",
                    {0, linear.end_strain},
                    {0, linear.modulus_mpa * linear.end_strain},
                    true,
                    false}};
  std::vector<double> even;
  const double end = task.most_strain > 0 ? std::min(task.most_strain, curve.strain.back()) : curve.strain.back();
  for (int i = 0; i <= 200; ++i) even.push_back(end * i / 200);
  int style = 2;
  for (const FittedLaw& law : results.laws) {
    curves.series.push_back({name_of(law), even, stresses(law, even), true, false, false, style});
    const std::vector<double> strains(curve.strain.begin(),
                                      curve.strain.begin() + static_cast<std::ptrdiff_t>(law.fit.points));
    PlotSeries left{name_of(law), strains, stresses(law, strains), true, true, false, style++};
    for (std::size_t i = 0; i < left.y.size(); ++i) left.y[i] -= curve.stress[i];
    off.series.push_back(std::move(left));
  }
  return {.title = task.file, .rows = {{curves, off}}, .panel_height = 320};
}

Table residual_table(const TensileResults& results) {
  Table table =
      csv_table({"line", "strain", "stress_mpa", "linear_mpa", "neo_hookean_mpa", "mooney_rivlin_mpa", "yeoh_mpa"});
  const TensileCurve& curve = results.curve;
  for (std::size_t i = 0; i < curve.strain.size(); ++i) {
    const double strain = curve.strain[i], stress = curve.stress[i];
    Row& row = table.rows.emplace_back(Row{count_cell(curve.lines[i]), ten_digits(strain), ten_digits(stress),
                                           ten_digits(results.linear.modulus_mpa * strain - stress)});
    for (const FittedLaw& law : results.laws) row.push_back(ten_digits(uniaxial_stress(law.fit.law, strain) - stress));
  }
  return table;
}

std::string tensile_fragment(const TensileTask& task, const TensileResults& results) {
  std::string text = "materials:   # softkin calibrate material --tensile " + printable(task.file) + "\n  " +
                     entry(task, results, results.chosen) + "\n";
  for (const std::string name : {"linear", "neo-hookean", "mooney-rivlin", "yeoh"})
    if (name != results.chosen) text += "  # " + name + ": " + entry(task, results, name) + "\n";
  return text;
}

}  // namespace softkin::calibration
