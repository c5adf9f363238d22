#include <algorithm>
#include <cmath>
#include <softkin/calibration/relaxation_problem.hpp>
#include <softkin/calibration/relaxation_report.hpp>
#include <softkin/calibration/report_parts.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/model/names.hpp>

namespace softkin::calibration {

namespace {

Law relaxing_law(const std::string& name) {
  std::vector<std::string> names;
  for (const Law law : {Law::neo_hookean, Law::mooney_rivlin, Law::yeoh, Law::gent}) {
    if (name == law_name(law)) return law;
    names.push_back(law_name(law));
  }
  throw InvalidInput("law " + excerpt(name) + " is none that relaxation is fitted with" + suggest_name(name, names));
}

/// "MPa"; jm has none.
std::string unit_of_constant(const std::string& name) {
  return name == "jm" ? "-" : "MPa";
}

/// By what the scene's moduli are those of the fit, as `calibrate material` has them: its law is compressible, and E
/// when relaxed is to be that of the fit.
double scene_scale(const RelaxationTask& task) {
  return 3 / (2 * (1 + task.poisson_ratio));
}

/// Young's moduli [MPa].
struct Stiffness {
  double relaxed = 0, at_once = 0, at_once_in_scene = 0;
};

Stiffness stiffness_of(const RelaxationTask& task, const ElementFit& fit) {
  const double shear = fit.element.law.youngs_modulus() / 3, nu = task.poisson_ratio;
  double at_once = shear;
  for (const ViscousBranch& branch : fit.element.branches) at_once += branch.modulus_MPa;
  const double bulk = 2 * scene_scale(task) * shear * (1 + nu) / (3 * (1 - 2 * nu));
  const double in_scene = scene_scale(task) * at_once;
  return {3 * shear, 3 * at_once, 9 * bulk * in_scene / (3 * bulk + in_scene)};
}

std::string fit_name(const RelaxationTask& task, const RelaxationFit& fit) {
  return task.law + " with " + (fit.chosen == 0 ? "no branch" : counted(fit.chosen, "branch", "branches"));
}

std::string choice_text(const RelaxationFit& fit) {
  if (fit.by == BranchCount::requested) return "as requested";
  if (fit.by == BranchCount::repeats) return "the fewest that are off by no more than repeated runs differ";
  return "the fewest that no other number is better than by more than 6 (BIC)";
}

std::string noise_text(const RelaxationFit& fit) {
  if (!fit.repeat_MPa && !fit.repeat_stretch) return "no run repeats another: the noise is what is left";
  std::string text = "repeated runs differ by ";
  if (fit.repeat_MPa) text += number(*fit.repeat_MPa, 3) + " MPa";
  if (fit.repeat_MPa && fit.repeat_stretch) text += " and ";
  if (fit.repeat_stretch) text += number(*fit.repeat_stretch, 3) + " in stretch";
  return text + " (rms about their mean)";
}

std::string read_text(const RelaxationResults& results) {
  std::string text;
  for (std::size_t i = 0; i < results.runs.size(); ++i) {
    const RelaxationRun& run = results.runs[i];
    const auto [least, most] = std::minmax_element(run.stretch.begin(), run.stretch.end());
    text += run.file + ", " + run.name + ": " + (run.load_imposed ? "stress imposed" : "stretch imposed") + ", " +
            counted(run.time_s.size(), "row") + " in " + number(run.time_s.back() - run.time_s.front(), 4) +
            " s, stretch " + number(*least, 4) + " to " + number(*most, 4) + "\n";
  }
  return text;
}

Cell deviation_cell(const Estimate& estimate) {
  return estimate.deviation ? Cell(*estimate.deviation) : Cell("-");
}

Table tried_table(const RelaxationFit& fit) {
  Table table{{significant("branches", "")}};
  const bool stresses = fit.best().rms_stress_MPa.has_value(), stretches = fit.best().rms_stretch.has_value();
  if (stresses) table.columns.push_back(significant("stress off (rms)", "MPa", 3));
  if (stretches) table.columns.push_back(significant("stretch off (rms)", "-", 3));
  table.columns.push_back(decimals("BIC", "", 1));
  for (const ElementFit& each : fit.tried) {
    Row& row = table.rows.emplace_back(Row{count_cell(each.branches.size())});
    if (stresses) row.emplace_back(*each.rms_stress_MPa);
    if (stretches) row.emplace_back(*each.rms_stretch);
    row.emplace_back(each.criterion);
  }
  return table;
}

Table constants_table(const RelaxationTask& task, const RelaxationFit& fit) {
  Table table{{{.key = "constant", .left = true},
               significant("value", "", 5),
               {.key = "", .left = true},
               significant("+-", "", 2),
               {.key = "", .left = true}}};
  const std::vector<std::string> names = constant_names(fit.best().element.law.law);
  for (std::size_t c = 0; c < names.size(); ++c)
    table.rows.push_back({names[c], fit.best().constants[c].value, unit_of_constant(names[c]),
                          deviation_cell(fit.best().constants[c]), task.constants.contains(names[c]) ? "given" : ""});
  return table;
}

Table branch_table(const RelaxationFit& fit) {
  Table table{{significant("branch", ""), significant("modulus", "MPa", 5), significant("+-", "MPa", 2),
               significant("time", "s", 5), significant("+-", "s", 2)}};
  for (const BranchEstimate& branch : fit.best().branches)
    table.rows.push_back({count_cell(table.rows.size() + 1), branch.modulus_MPa.value,
                          deviation_cell(branch.modulus_MPa), branch.time_s.value, deviation_cell(branch.time_s)});
  return table;
}

/// Returns notes on the estimates that the tests do not determine.
std::string relaxation_notes(const RelaxationTask& task, const RelaxationFit& fit) {
  std::string text;
  const std::vector<std::string> names = constant_names(fit.best().element.law.law);
  for (std::size_t c = 0; c < names.size(); ++c)
    if (!fit.best().constants[c].deviation && !task.constants.contains(names[c]))
      text += "note: the tests do not determine " + names[c] + ": it is at a bound, or others make up for it\n";
  for (std::size_t b = 0; b < fit.best().branches.size(); ++b)
    if (!fit.best().branches[b].time_s.deviation)
      text += "note: the tests do not determine the time of branch " + std::to_string(b + 1) +
              ": it is at an end of the range, or another branch makes up for it\n";
  return text;
}

std::string scene_text(const RelaxationTask& task, const Stiffness& e) {
  return "E " + number(e.relaxed, 5) + " MPa relaxed, " + number(e.at_once, 5) + " MPa at once\nin a scene at nu " +
         number(task.poisson_ratio) + ": all moduli times " + number(scene_scale(task), 5) +
         ", so that E is the same relaxed; at once it is " + number(e.at_once_in_scene, 5) + " MPa\n";
}

Json estimate_with_deviation(const Estimate& estimate) {
  return {{"value", estimate.value}, {"deviation", or_null(estimate.deviation)}};
}

/// Does what is imposed come back? Then the run is a loop, else something over time.
bool is_loop(const RelaxationRun& run) {
  if (run.load_imposed) return false;
  double route = 0;
  for (std::size_t i = 1; i < run.stretch.size(); ++i) route += std::abs(run.stretch[i] - run.stretch[i - 1]);
  const auto [least, most] = std::minmax_element(run.stretch.begin(), run.stretch.end());
  constexpr double there_and_back = 1.5;
  return route > there_and_back * (*most - *least) && *most > *least;
}

/// A run in its panel: what was measured, and the fit as a line.
void add_run(PlotPanel& panel, const RelaxationRun& run, const Eigen::VectorXd& answer, const std::string& label) {
  const bool loop = is_loop(run);
  const int style = static_cast<int>(panel.series.size() / 2);
  PlotSeries measured{.label = label, .x = {}, .y = {}, .line = false, .style = style, .mark_radius = 1.5};
  PlotSeries fitted{.label = "", .x = {}, .y = {}, .marks = false, .style = style};
  for (std::size_t i = 0; i < run.time_s.size(); ++i) {
    const double x = loop ? run.stretch[i] : run.time_s[i] - run.time_s[0];
    if (!loop && x <= 0) continue;  // the first row has no place on a logarithmic axis
    measured.x.push_back(x);
    fitted.x.push_back(x);
    measured.y.push_back(run.load_imposed ? run.stretch[i] : run.stress_MPa[i]);
    fitted.y.push_back(answer[i]);
  }
  panel.series.push_back(std::move(measured));
  panel.series.push_back(std::move(fitted));
}

std::string scene_constants_text(const RelaxationTask& task, const ElementFit& fit) {
  if (fit.element.law.law == Law::neo_hookean)
    return ", youngs_modulus: " + number(fit.element.law.youngs_modulus(), 5);
  std::string text;
  const std::vector<std::string> names = constant_names(fit.element.law.law);
  for (std::size_t c = 0; c < names.size(); ++c)
    text += ", " + names[c] + ": " + number(fit.constants[c].value * (names[c] == "jm" ? 1 : scene_scale(task)), 5);
  return text;
}

}  // namespace

std::map<std::string, double> read_constants(const std::string& option, const std::string& text) {
  std::map<std::string, double> constants;
  for (std::size_t begin = 0; begin <= text.size() && !text.empty();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string piece = text.substr(begin, end - begin);
    const std::size_t equals = piece.find('=');
    double value = 0;
    if (equals == std::string::npos || !parse_real(piece.substr(equals + 1), value) ||
        !constants.emplace(piece.substr(0, equals), value).second)
      throw InvalidInput(option + " " + excerpt(text) + ": must be NAME=NUMBER,NAME=NUMBER, such as c10=0.4,c01=1.9");
    begin = end + 1;
  }
  return constants;
}

RelaxationResults evaluate(const RelaxationTask& task) {
  const Law law = relaxing_law(task.law);
  RelaxationResults results;
  for (const bool load_imposed : {false, true})
    for (const std::string& file : load_imposed ? task.creep : task.tests)
      for (RelaxationRun& run : read_relaxation_runs(file, load_imposed, task.size))
        results.runs.push_back(std::move(run));
  results.fit = fit_relaxation(results.runs, {law, task.constants, task.branches});
  for (const RelaxationRun& run : results.runs)
    results.answers.push_back(answer_of(results.fit.best().element, run).value());
  return results;
}

std::string relaxation_text(const RelaxationTask& task, const RelaxationResults& results) {
  const RelaxationFit& fit = results.fit;
  return read_text(results) + "the tests determine relaxation times of " + number(fit.shortest_s, 3) + " to " +
         number(fit.longest_s, 4) + " s; " + noise_text(fit) + "\n\n" + text_of(tried_table(fit)) +
         fit_name(task, fit) + ": " + choice_text(fit) + "\n\n" + text_of(constants_table(task, fit)) +
         (fit.chosen > 0 ? text_of(branch_table(fit)) : "") + relaxation_notes(task, fit) +
         scene_text(task, stiffness_of(task, fit.best())) + "\n" + relaxation_fragment(task, results);
}

std::string relaxation_json(const RelaxationTask& task, const RelaxationResults& results) {
  const RelaxationFit& fit = results.fit;
  const Stiffness e = stiffness_of(task, fit.best());
  const std::vector<std::string> names = constant_names(fit.best().element.law.law);
  Json json{{"softkin", SOFTKIN_VERSION}, {"law", task.law}, {"poisson_ratio", task.poisson_ratio}};
  for (const RelaxationRun& run : results.runs)
    json["runs"].push_back({{"file", run.file},
                            {"name", run.name},
                            {"imposed", run.load_imposed ? "stress" : "stretch"},
                            {"rows", run.time_s.size()}});
  json["shortest_time_s"] = fit.shortest_s;
  json["longest_time_s"] = fit.longest_s;
  json["repeats_differ"] = {{"stress_MPa", or_null(fit.repeat_MPa)}, {"stretch", or_null(fit.repeat_stretch)}};
  constexpr const char* choices[] = {"asked", "repeats", "information"};
  json["chosen_by"] = choices[static_cast<std::size_t>(fit.by)];
  for (const ElementFit& each : fit.tried)
    json["tried"].push_back({{"branches", each.branches.size()},
                             {"rms_stress_MPa", or_null(each.rms_stress_MPa)},
                             {"rms_stretch", or_null(each.rms_stretch)},
                             {"criterion", each.criterion}});
  for (std::size_t c = 0; c < names.size(); ++c)
    json["constants"][names[c] == "jm" ? names[c] : names[c] + "_MPa"] =
        estimate_with_deviation(fit.best().constants[c]);
  json["branches"] = Json::array();
  for (const BranchEstimate& branch : fit.best().branches)
    json["branches"].push_back({{"modulus_MPa", estimate_with_deviation(branch.modulus_MPa)},
                                {"time_s", estimate_with_deviation(branch.time_s)}});
  json["youngs_modulus_MPa"] = {
      {"relaxed", e.relaxed}, {"at_once", e.at_once}, {"at_once_in_scene", e.at_once_in_scene}};
  json["materials_yaml"] = relaxation_fragment(task, results);
  return text_of(json);
}

Plot relaxation_plot(const RelaxationTask& task, const RelaxationResults& results) {
  PlotPanel relaxation = panel_of("Relaxation", "time [s]", "nominal stress [MPa]");
  PlotPanel creep = panel_of("Creep", "time [s]", "stretch [-]");
  PlotPanel cycles = panel_of("Cycles", "stretch [-]", "nominal stress [MPa]");
  relaxation.x.logarithmic = creep.x.logarithmic = true;
  for (std::size_t i = 0; i < results.runs.size(); ++i) {
    const RelaxationRun& run = results.runs[i];
    const bool several = task.tests.size() + task.creep.size() > 1;
    const std::string label = (several ? std::filesystem::path(run.file).stem().string() + ", " : "") + run.name;
    add_run(is_loop(run) ? cycles : run.load_imposed ? creep : relaxation, run, results.answers[i], label);
  }
  Plot plot{
      .title = fit_name(task, results.fit) + ": measured (dots) and fitted (lines)", .rows = {{}}, .panel_height = 320};
  for (PlotPanel* panel : {&relaxation, &creep, &cycles})
    if (!panel->series.empty()) plot.rows.front().push_back(std::move(*panel));
  return plot;
}

Table relaxation_table(const RelaxationResults& results) {
  Table table = csv_table({"run", "line", "t_s", "stretch", "stress_mpa", "fit_stress_mpa", "fit_stretch", "off"});
  for (std::size_t r = 0; r < results.runs.size(); ++r) {
    const RelaxationRun& run = results.runs[r];
    for (std::size_t i = 0; i < run.time_s.size(); ++i) {
      const double fitted = results.answers[r][i];
      const double measured = run.load_imposed ? run.stretch[i] : run.stress_MPa[i];
      const Cell cell = ten_digits(fitted), none;
      table.rows.push_back({count_cell(r + 1), count_cell(run.lines[i]), ten_digits(run.time_s[i]),
                            ten_digits(run.stretch[i]), ten_digits(run.stress_MPa[i]), run.load_imposed ? none : cell,
                            run.load_imposed ? cell : none, ten_digits(fitted - measured)});
    }
  }
  return table;
}

std::string relaxation_fragment(const RelaxationTask& task, const RelaxationResults& results) {
  const ElementFit& fit = results.fit.best();
  std::string files, branches;
  for (const std::string& file : task.tests) files += " " + printable(file);
  for (const std::string& file : task.creep) files += ", creep: " + printable(file);
  for (const ViscousBranch& branch : fit.element.branches)
    branches += std::string(branches.empty() ? "" : ", ") +
                "{modulus: " + number(scene_scale(task) * branch.modulus_MPa, 5) +
                ", time: " + number(branch.time_s, 5) + "}";
  return "materials:   # softkin calibrate relaxation" + files + "\n  - {region: " + task.region +
         ", law: " + task.law + scene_constants_text(task, fit) + ", poisson_ratio: " + number(task.poisson_ratio) +
         (branches.empty() ? "" : ", viscosity: [" + branches + "]") + "}\n";
}

}  // namespace softkin::calibration
