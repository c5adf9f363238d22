#include <cmath>

#include "calibrate_results.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr const char* indent = "  ";

std::string law_name(Law law) {
  return law == Law::corotational          ? "corotational"
         : law == Law::st_venant_kirchhoff ? "st-venant-kirchhoff"
                                           : "neo-hookean";
}

std::string percent(double value) {
  return decimal(value, 2);
}

using Rows = std::vector<std::vector<std::string>>;

std::string table_text(const Rows& rows) {
  std::string text;
  for (const std::string& line : aligned(rows, std::string(rows.front().size(), 'r'))) text += line + "\n";
  return text;
}

/// Columns of a fit: the specimen's own ratio, and its interface at the ratio of all.
void append_fit(Rows& rows, const std::optional<calibration::RatioFit>& fit, const std::string& name,
                const std::string& ratio, const std::vector<StretchedSpecimen>& specimens) {
  if (!fit) return;
  for (const std::string& title : {name + ": " + ratio, std::string("dL1 [mm]"), std::string("off [%]")})
    rows[0].push_back(title);
  for (std::size_t i = 0; i < specimens.size(); ++i) {
    const calibration::SpecimenFit& each = fit->specimens[i];
    const bool found = each.status == Status::converged;
    rows[i + 1].push_back(found ? decimal(std::exp(each.own_log_ratio), 3) : "-");
    rows[i + 1].push_back(found ? decimal(each.response.moved_mm, 4) : "-");
    rows[i + 1].push_back(found ? percent(off_percent(each.response.moved_mm, specimens[i].interface_moved_mm)) : "-");
  }
}

std::string specimen_table(const SpecimenResults& results) {
  Rows rows{{"line", "L [mm]", "L1 [mm]", "dL [mm]", "dL1 [mm]", "Eq. (16)"}};
  for (const StretchedSpecimen& s : results.specimens)
    rows.push_back({std::to_string(s.line), number(s.length_mm), number(s.interface_mm), number(s.stretch_mm),
                    number(s.interface_moved_mm), decimal(calibration::elasticity_ratio(s), 3)});
  append_fit(rows, results.physical, "physical", "E_A/E_B", results.specimens);
  append_fit(rows, results.target, "target-shape", "R_A/R_B", results.specimens);
  for (const TriedRatio& each : results.tried) {
    rows[0].push_back("at R_A/R_B " + number(each.ratio) + ": dL1 [mm]");
    rows[0].push_back("off [%]");
    for (std::size_t i = 0; i < results.specimens.size(); ++i) {
      rows[i + 1].push_back(decimal(each.stretched[i].moved_mm, 4));
      rows[i + 1].push_back(percent(off_percent(each.stretched[i].moved_mm, results.specimens[i].interface_moved_mm)));
    }
  }
  return table_text(rows);
}

void append_turns(Rows& rows, const std::string& name, const std::vector<calibration::SpecimenResponse>& responses,
                  const std::vector<TwistedSpecimen>& twists) {
  if (responses.empty()) return;
  rows[0].push_back(name + " [deg]");
  rows[0].push_back("off [%]");
  for (std::size_t i = 0; i < twists.size(); ++i) {
    rows[i + 1].push_back(decimal(responses[i].turned_deg, 3));
    rows[i + 1].push_back(
        twists[i].interface_deg ? percent(off_percent(responses[i].turned_deg, *twists[i].interface_deg)) : "-");
  }
}

std::string twist_table(const SpecimenResults& results) {
  Rows rows{{"line", "L [mm]", "L1 [mm]", "twist [deg]", "interface measured [deg]", "rod [deg]"}};
  for (const TwistedSpecimen& t : results.twists)
    rows.push_back({std::to_string(t.line), number(t.length_mm), number(t.interface_mm), number(t.twist_deg),
                    t.interface_deg ? number(*t.interface_deg) : "-",
                    decimal(t.twist_deg * calibration::rod_share(results.rod.ratio, t.length_mm, t.interface_mm), 3)});
  append_turns(rows, "physical", results.physical_twists, results.twists);
  append_turns(rows, "target-shape", results.target_twists, results.twists);
  for (const TriedRatio& each : results.tried)
    append_turns(rows, "at R_A/R_B " + number(each.ratio), each.twisted, results.twists);
  return "Turn of the interface where the free end is twisted:\n" + table_text(rows);
}

std::string spread_text(const calibration::RatioEstimate& estimate) {
  if (estimate.specimens < 2) return "; one specimen: no spread";
  return "; spread " + percent(100 * estimate.spread) + " %, " + decimal(estimate.least, 3) + " to " +
         decimal(estimate.greatest, 3);
}

std::string shape_text(const calibration::ShapeRatios& shape) {
  const double nu_a = calibration::poisson_ratio_of_shape_ratio(shape.a),
               nu_b = calibration::poisson_ratio_of_shape_ratio(shape.b);
  return "R_omega " + number(shape.a, 4) + " and " + number(shape.b, 4) + ", which stand for Poisson's ratios of " +
         decimal(nu_a, 2) + " and " + decimal(nu_b, 2);
}

std::string moduli_text(const calibration::Moduli& moduli) {
  std::string text = "E_A " + number(moduli.a_mpa, 5) + " MPa, E_B " + number(moduli.b_mpa, 5) + " MPa";
  if (moduli.specimens > 1) text += "; spread " + percent(100 * moduli.spread) + " %";
  return text;
}

void append_ratios(Rows& rows, const SpecimenResults& results, const MaterialOptions& options) {
  const double stiffer = options.specimen.stiffer_shape_ratio;
  rows.push_back({"E_A / E_B of a rod, Eq. (16):", decimal(results.rod.ratio, 3) + spread_text(results.rod)});
  if (results.rod_moduli) rows.push_back({"moduli of a rod:", moduli_text(*results.rod_moduli)});
  if (results.physical && results.physical->estimate.specimens > 0) {
    const calibration::RatioEstimate& found = results.physical->estimate;
    rows.push_back({"E_A / E_B, physical simulation:", decimal(found.ratio, 3) + spread_text(found)});
    if (results.physical->moduli)
      rows.push_back({"moduli, physical simulation:", moduli_text(*results.physical->moduli)});
  }
  if (!results.target || results.target->estimate.specimens == 0) return;
  const calibration::RatioEstimate& found = results.target->estimate;
  rows.push_back({"R_A / R_B, target-shape simulation:", decimal(found.ratio, 3) + spread_text(found)});
  rows.push_back({"", shape_text(calibration::shape_ratios(std::log(found.ratio), stiffer))});
  const double closed = calibration::closed_form_log_ratio(results.rod.ratio, stiffer);
  rows.push_back({"R_A / R_B, closed form of Eq. (16):", decimal(std::exp(closed), 3)});
  rows.push_back({"", shape_text(calibration::shape_ratios(closed, stiffer))});
}

std::string shear_note(const SpecimenResults& results, const MaterialOptions& options) {
  const calibration::SpecimenOptions& s = options.specimen;
  const double nu = calibration::poisson_ratio_of_shape_ratio(s.stiffer_shape_ratio);
  constexpr double most = 0.1;
  if (!results.target || std::abs(nu - s.poisson_ratio) < most) return "";
  const double right = calibration::shape_ratio_of_poisson_ratio(s.poisson_ratio);
  std::string text = "note: R_omega " + number(s.stiffer_shape_ratio, 4) +
                     " of the stiffer material stands for a Poisson's ratio of " + decimal(nu, 2) + ", not " +
                     number(s.poisson_ratio) + ": tension agrees, twist does not";
  if (right > 0 && right <= 1) text += "; --stiffer " + number(right, 3) + " has that Poisson's ratio";
  return text + "\n";
}

}  // namespace

std::vector<std::string> set_up_lines(const MaterialOptions& options) {
  const calibration::SpecimenOptions& s = options.specimen;
  const bool own_size = options.given.contains("--width") && options.given.contains("--height");
  std::vector<std::string> lines{"cross-section " + number(s.width_mm) + " x " + number(s.height_mm) + " mm" +
                                     (own_size ? "" : options.unless_given("--width")),
                                 "ends " + options.grip + options.unless_given("--grip")};
  const std::string cells = " cells across the height" + options.unless_given("--cells");
  if (options.formulation != "target-shape")
    lines.push_back("physical: law " + law_name(s.law) + options.unless_given("--law") + ", Poisson's ratio " +
                    number(s.poisson_ratio) + options.unless_given("--poisson-ratio") + ", " +
                    std::to_string(calibration::cells_across(s, Formulation::physical)) + cells);
  if (options.formulation != "physical")
    lines.push_back("target-shape: R_omega " + number(s.stiffer_shape_ratio, 4) + " of the stiffer material" +
                    options.unless_given("--stiffer") + ", " +
                    std::to_string(calibration::cells_across(s, Formulation::target_shape)) + cells);
  return lines;
}

std::string specimens_text(const SpecimenResults& results, const MaterialOptions& options) {
  std::string text = options.specimens + ": " + counted(results.specimens.size(), "specimen") + "; simulated with\n" +
                     joined(set_up_lines(options), indent) + "\n" + specimen_table(results) + "\n";
  Rows rows;
  append_ratios(rows, results, options);
  text += joined(aligned(rows, "ll"), "") + shear_note(results, options);
  if (!results.twists.empty()) text += "\n" + twist_table(results);
  if (!results.failure(options).empty()) return text;
  text += "\n" + specimens_fragment(results, options);
  const auto add = [&](const char* what, const std::string& file) {
    if (!file.empty()) text += std::string(what) + ": " + file + "\n";
  };
  add("materials", options.fragment);
  add("plot", options.plot);
  add("residuals", options.residuals);
  return text;
}

std::string specimens_fragment(const SpecimenResults& results, const MaterialOptions& options) {
  const calibration::SpecimenOptions& s = options.specimen;
  std::string a = "  - {region: " + options.regions[0], b = "  - {region: " + options.regions[1];
  std::string remark;
  if (results.target) {
    const calibration::ShapeRatios shape =
        calibration::shape_ratios(std::log(results.target->estimate.ratio), s.stiffer_shape_ratio);
    a += ", shape_ratio: " + number(shape.a, 5);
    b += ", shape_ratio: " + number(shape.b, 5);
  }
  if (results.physical) {
    const double ratio = results.physical->estimate.ratio;
    std::optional<calibration::Moduli> moduli = results.physical->moduli;
    if (!moduli && options.modulus_b) moduli = calibration::Moduli{ratio * *options.modulus_b, *options.modulus_b};
    if (moduli) {
      const std::string rest = ", poisson_ratio: " + number(s.poisson_ratio) +
                               (s.law == Law::neo_hookean ? "" : ", law: " + law_name(s.law));
      a += ", youngs_modulus: " + number(moduli->a_mpa, 5) + rest;
      b += ", youngs_modulus: " + number(moduli->b_mpa, 5) + rest;
    } else {
      remark = "  # physical: youngs_modulus of " + options.regions[0] + " = " + number(ratio, 5) + " x that of " +
               options.regions[1] + "; a column force_n or --modulus-b gives both\n";
    }
  }
  if (!results.target && !remark.empty()) return "# no materials without a modulus\n" + remark;
  return "materials:   # softkin calibrate material " + printable(options.specimens) + "\n" + a + "}\n" + b + "}\n" +
         remark;
}

}  // namespace softkin::cli
