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
  return law.choice.name();
}

/// The largest stress that was fitted.
double peak_of(const TensileResults& results) {
  const std::vector<double>& stress = results.curve.stress;
  return *std::max_element(stress.begin(),
                           stress.begin() + static_cast<std::ptrdiff_t>(results.laws.front().fit.points));
}

/// The first law whose rms is small relative to the fitted stresses, else the best; of Ogden's alone where the law is
/// requested.
std::string choose(const TensileTask& task, const TensileResults& results) {
  constexpr double enough = 0.01;
  const double largest = peak_of(results);
  const FittedLaw* best = nullptr;
  for (const FittedLaw& each : results.laws) {
    if (!task.law.empty() && each.choice.law != Law::ogden) continue;
    if (each.fit.quality.rms_mpa <= enough * largest) return name_of(each);
    if (!best || each.fit.quality.rms_mpa < best->fit.quality.rms_mpa) best = &each;
  }
  return name_of(*best);
}

std::string law_yaml(const FittedLaw& law) {
  const auto key = [](const std::string& name, const std::optional<double>& value) {
    return value ? ", " + name + ": " + number(*value, 5) : "";
  };
  const ElasticSpec& scene = law.scene;
  std::string text = std::string("law: ") + law_name(scene.law) + key("youngs_modulus", scene.youngs_modulus) +
                     key("shear_modulus", scene.shear_modulus) + key("jm", scene.jm) + key("c10", scene.c10) +
                     key("c01", scene.c01) + key("c20", scene.c20) + key("c30", scene.c30);
  for (std::size_t p = 0; p < scene.ogden.size(); ++p)
    text += key("mu" + std::to_string(p + 1), scene.ogden[p].mu) +
            key("alpha" + std::to_string(p + 1), scene.ogden[p].alpha);
  return text + key("poisson_ratio", scene.poisson_ratio);
}

/// A law by its name, or the line where it is linear.
std::string entry(const TensileTask& task, const TensileResults& results, const std::string& name) {
  const LinearRange& linear = results.linear;
  std::string what = "law: neo-hookean, youngs_modulus: " + number(linear.modulus_mpa, 5) +
                     ", poisson_ratio: " + number(task.poisson_ratio);
  for (const FittedLaw& each : results.laws)
    if (name_of(each) == name) what = law_yaml(each);
  const std::string range = linear.points > 0 ? ", linear_range: " + number(linear.end_strain, 4) : "";
  return "- {region: " + task.region + ", " + what + range + "}";
}

std::string constants_text(const IncompressibleLaw& law) {
  switch (law_traits(law.law).constants) {
    case LawConstants::limited:
      return "mu " + number(2 * law.c10, 5) + ", jm " + number(law.jm, 5) + " [-]";
    case LawConstants::ogden: {
      std::string text;
      for (int p = 0; p < law.terms(); ++p) {
        const std::string place = std::to_string(p + 1);
        text += (p == 0 ? "mu" : ", mu") + place + " " + number(law.ogden[p].mu, 5) + ", alpha" + place + " " +
                number(law.ogden[p].alpha, 5) + " [-]";
      }
      return text;
    }
    case LawConstants::lame:
    case LawConstants::coefficients:
      break;
  }
  std::string text = "c10 " + number(law.c10, 5);
  if (law.law == Law::mooney_rivlin) text += ", c01 " + number(law.c01, 5);
  if (law.law == Law::yeoh) text += ", c20 " + number(law.c20, 5) + ", c30 " + number(law.c30, 5);
  return text;
}

const char* mode_text(StretchMode mode) {
  switch (mode) {
    case StretchMode::planar:
      return "stretched along one axis at a fixed width";
    case StretchMode::equibiaxial:
      return "stretched along two axes";
    case StretchMode::uniaxial:
      break;
  }
  return "stretched along one axis";
}

/// Percent of the largest stress that was fitted.
double percent_of_peak(const TensileResults& results, double stress_mpa) {
  return 100 * stress_mpa / peak_of(results);
}

std::string stability_note(const TensileResults& results, const FittedLaw& each) {
  std::string text;
  if (each.fit.free_rms_mpa)
    text += "note: " + name_of(each) +
            " is held stable up to the largest strain that was fitted; without that its rms would be " +
            number(percent_of_peak(results, *each.fit.free_rms_mpa), 3) + " % of the largest stress, not " +
            number(percent_of_peak(results, each.fit.quality.rms_mpa), 3) + " %\n";
  if (each.unstable_at)
    text += "note: " + name_of(each) + " loses its stability at a strain of " +
            decimal(each.unstable_at->stretch - 1, 2) + " where it is " + mode_text(each.unstable_at->mode) + "\n";
  if (each.choice.law == Law::ogden && each.fit.law.terms() < each.choice.terms)
    text += "note: " + name_of(each) + " needs " + std::to_string(each.fit.law.terms()) + " of its " +
            std::to_string(each.choice.terms) + " terms: further ones would not come closer to the test\n";
  return text;
}

std::string notes(const TensileResults& results) {
  std::string text;
  for (const std::string& note : results.curve.notes) text += "note: " + note + "\n";
  constexpr double max_offset = 0.02;
  const LinearRange& linear = results.linear;
  if (std::abs(linear.offset_mpa) > max_offset * linear.modulus_mpa * linear.end_strain)
    text += "note: the straight line that fits the linear range best passes " + number(linear.offset_mpa, 3) +
            " MPa at strain 0: was the test zeroed?\n";
  for (const FittedLaw& each : results.laws) {
    if (each.fit.at_bound)
      text += "note: " + name_of(each) +
              " without a bound has an initial modulus near 0 or below; it is held at 1 % of the mean secant modulus\n";
    if (each.fit.falls_at)
      text += "note: " + name_of(each) + ": the stress falls beyond a strain of " + decimal(*each.fit.falls_at, 2) +
              ": the material would be unstable there\n";
    text += stability_note(results, each);
  }
  return text;
}

Json quality_json(const FitQuality& quality) {
  return {{"r_squared", quality.r_squared}, {"rms_MPa", quality.rms_mpa}, {"largest_MPa", quality.largest_mpa}};
}

Json unstable_json(const FittedLaw& each) {
  if (!each.unstable_at) return nullptr;
  return {{"strain", each.unstable_at->stretch - 1}, {"mode", mode_text(each.unstable_at->mode)}};
}

Json constants_json(const IncompressibleLaw& law) {
  if (law.law == Law::gent) return {{"shear_modulus_MPa", 2 * law.c10}, {"jm", law.jm}};
  if (law.law != Law::ogden)
    return {{"c10_MPa", law.c10}, {"c01_MPa", law.c01}, {"c20_MPa", law.c20}, {"c30_MPa", law.c30}};
  Json json = Json::object();
  for (int p = 0; p < law.terms(); ++p) {
    json["mu" + std::to_string(p + 1) + "_MPa"] = law.ogden[p].mu;
    json["alpha" + std::to_string(p + 1)] = law.ogden[p].alpha;
  }
  return json;
}

Json law_json(const TensileResults& results, const FittedLaw& each) {
  Json json = constants_json(each.fit.law);
  json.update(Json{{"youngs_modulus_MPa", each.fit.law.youngs_modulus()},
                   {"at_bound", each.fit.at_bound},
                   {"points", each.fit.points},
                   {"quality", quality_json(each.fit.quality)},
                   {"rms_percent_of_largest_stress", percent_of_peak(results, each.fit.quality.rms_mpa)},
                   {"quality_in_scene", quality_json(each.scene_quality)},
                   {"falls_at_strain", or_null(each.fit.falls_at)},
                   {"free_rms_MPa", or_null(each.fit.free_rms_mpa)},
                   {"unstable_at", unstable_json(each)},
                   {"scene_yaml", law_yaml(each)}});
  return json;
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
               significant("of the largest stress", "%", 3),
               significant("largest", "MPa", 3),
               significant("in a scene at nu " + number(task.poisson_ratio) + ": rms", "MPa", 3)}};
  for (const FittedLaw& each : results.laws) {
    const FitQuality& quality = each.fit.quality;
    table.rows.push_back({name_of(each), constants_text(each.fit.law), each.fit.law.youngs_modulus(), quality.r_squared,
                          quality.rms_mpa, percent_of_peak(results, quality.rms_mpa), quality.largest_mpa,
                          each.scene_quality.rms_mpa});
  }
  return table;
}

}  // namespace

namespace {

/// The linear range; where there is none, why.
void find_linear_range(const TensileTask& task, TensileResults& results) {
  constexpr double max_residual = 0.1;  // of the largest stress: the curve is a tensile test nevertheless
  try {
    results.linear = linear_range(results.curve, task.tolerance_percent / 100);
  } catch (const InvalidInput& error) {
    const auto is_close = [&](const FittedLaw& each) {
      return each.fit.quality.rms_mpa <= max_residual * peak_of(results);
    };
    if (task.law == "linear" || std::none_of(results.laws.begin(), results.laws.end(), is_close)) throw;
    results.linear_failure = error.what();
  }
}

std::string linear_text(const TensileTask& task, const TensileResults& results) {
  const LinearRange& linear = results.linear;
  if (linear.points == 0) return "note: " + results.linear_failure + "\n";
  return "E " + number(linear.modulus_mpa, 5) + " MPa, linear up to a strain of " + number(linear.end_strain, 4) +
         (linear.whole ? ", the end of the data" : "") + " (" + counted(linear.points, "point") +
         "): no stress there is off the line by more than\n" + number(task.tolerance_percent) +
         " % of the line's stress at the end; R^2 " + decimal(linear.quality.r_squared, 5) + ", rms " +
         number(linear.quality.rms_mpa, 3) + " MPa\n";
}

}  // namespace

TensileResults evaluate(const TensileTask& task, TensileCurve curve) {
  TensileResults results{std::move(curve), {}, {}, {}};
  try {
    if (results.curve.strain.size() < 5) (void)linear_range(results.curve, task.tolerance_percent / 100);
    for (LawChoice choice : fitted_laws()) {
      choice.stable = task.stable;
      if (choice.name() != task.law && !has_points_for(results.curve, choice, task.max_strain)) continue;
      const LawFit fit = fit_law(results.curve, choice, task.max_strain);
      const ElasticSpec scene = scene_constants(fit.law, task.poisson_ratio);
      const double largest = 1 + results.curve.strain[fit.points - 1];
      results.laws.push_back({choice, fit, scene, scene_quality(results.curve, scene, task.max_strain),
                              stability_limit(isochoric(fit.law), 2 * largest)});
    }
    find_linear_range(task, results);
  } catch (const InvalidInput& error) {
    throw InvalidInput({task.file}, error.what());
  }
  results.chosen = task.law.empty() || task.law == "ogden" ? choose(task, results) : task.law;
  return results;
}

std::string tensile_text(const TensileTask& task, const TensileResults& results) {
  return linear_text(task, results) + "\n" + text_of(law_table(task, results)) + notes(results) + "\n" +
         tensile_fragment(task, results);
}

namespace {

Json test_json(const TensileTask& task, const TensileResults& results) {
  const LinearRange& linear = results.linear;
  Json json{{"softkin", SOFTKIN_VERSION},
            {"tensile_file", task.file},
            {"points", results.curve.strain.size()},
            {"poisson_ratio", task.poisson_ratio},
            {"notes", results.curve.notes}};
  json["linear"] = nullptr;
  if (linear.points > 0)
    json["linear"] = {{"youngs_modulus_MPa", linear.modulus_mpa},
                      {"end_strain", linear.end_strain},
                      {"points", linear.points},
                      {"tolerance", task.tolerance_percent / 100},
                      {"ends_with_data", linear.whole},
                      {"offset_MPa", linear.offset_mpa},
                      {"quality", quality_json(linear.quality)}};
  for (const FittedLaw& each : results.laws) json["laws"][name_of(each)] = law_json(results, each);
  json["chosen"] = results.chosen;
  json["materials_yaml"] = tensile_fragment(task, results);
  return json;
}

}  // namespace

std::string tensile_json(const TensileTask& task, const TensileResults& results) {
  return text_of(test_json(task, results));
}

std::string tensile_comparison_json(const std::vector<std::pair<TensileTask, TensileResults>>& tests) {
  Json json{{"softkin", SOFTKIN_VERSION}, {"tests", Json::array()}};
  for (const auto& [task, results] : tests) json["tests"].push_back(test_json(task, results));
  return text_of(json);
}

Plot tensile_plot(const TensileTask& task, const TensileResults& results) {
  const TensileCurve& curve = results.curve;
  const LinearRange& linear = results.linear;
  PlotPanel curves = panel_of("Tensile test", "nominal strain [-]", "nominal stress [MPa]");
  PlotPanel off = panel_of("Fit less measurement", curves.x.label, curves.y.label);
  curves.series = {{"measured", curve.strain, curve.stress, false}};
  if (linear.points > 0)
    curves.series.push_back({"E " + number(linear.modulus_mpa, 4) + " MPa",
                             {0, linear.end_strain},
                             {0, linear.modulus_mpa * linear.end_strain},
                             true,
                             false});
  std::vector<double> even;
  const double end = task.max_strain > 0 ? std::min(task.max_strain, curve.strain.back()) : curve.strain.back();
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

namespace {

std::vector<std::string> residual_columns(const TensileResults& results) {
  std::vector<std::string> columns{"line", "strain", "stress_mpa"};
  if (results.linear.points > 0) columns.emplace_back("linear_mpa");
  for (const FittedLaw& each : results.laws) {
    std::string name = name_of(each);
    std::replace(name.begin(), name.end(), '-', '_');
    columns.push_back(name + "_mpa");
  }
  return columns;
}

}  // namespace

Table residual_table(const TensileResults& results) {
  Table table = csv_table(residual_columns(results));
  const TensileCurve& curve = results.curve;
  for (std::size_t i = 0; i < curve.strain.size(); ++i) {
    const double strain = curve.strain[i], stress = curve.stress[i];
    Row& row = table.rows.emplace_back(Row{count_cell(curve.lines[i]), ten_digits(strain), ten_digits(stress)});
    if (results.linear.points > 0) row.push_back(ten_digits(results.linear.modulus_mpa * strain - stress));
    for (const FittedLaw& law : results.laws) row.push_back(ten_digits(uniaxial_stress(law.fit.law, strain) - stress));
  }
  return table;
}

std::string tensile_comparison(const std::vector<std::pair<TensileTask, TensileResults>>& tests) {
  Table table{{{.key = "test", .left = true},
               {.key = "law", .left = true},
               {.key = "constants, incompressible", .unit = "MPa", .left = true},
               significant("E at rest", "MPa", 4),
               significant("rms of the largest stress", "%", 3),
               significant("up to strain", "", 4)}};
  for (const auto& [task, results] : tests)
    for (const FittedLaw& each : results.laws)
      table.rows.push_back({task.file, name_of(each), constants_text(each.fit.law), each.fit.law.youngs_modulus(),
                            percent_of_peak(results, each.fit.quality.rms_mpa),
                            results.curve.strain[each.fit.points - 1]});
  return text_of(table);
}

std::string tensile_fragment(const TensileTask& task, const TensileResults& results) {
  std::string text = "materials:   # softkin calibrate material --tensile " + printable(task.file) + "\n  " +
                     entry(task, results, results.chosen) + "\n";
  std::vector<std::string> names;
  if (results.linear.points > 0) names.emplace_back("linear");
  for (const FittedLaw& each : results.laws) names.push_back(name_of(each));
  for (const std::string& name : names)
    if (name != results.chosen) text += "  # " + name + ": " + entry(task, results, name) + "\n";
  return text;
}

}  // namespace softkin::calibration
