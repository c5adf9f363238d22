#include <algorithm>
#include <cmath>
#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/material_tables.hpp>

#include "calibrate_material.hpp"
#include "command.hpp"
#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

/// A law fitted, and as the scene has it.
struct FittedLaw {
  std::string name;
  calibration::LawFit fit;
  ElasticSpec scene;
  calibration::FitQuality scene_quality;

  [[nodiscard]] std::size_t constants() const {
    return fit.law.law == Law::yeoh ? 3 : fit.law.law == Law::mooney_rivlin ? 2 : 1;
  }
  [[nodiscard]] std::string yaml() const {
    const auto key = [](const char* name_of_key, const std::optional<double>& value) {
      return value ? std::string(", ") + name_of_key + ": " + number(*value, 5) : "";
    };
    return "law: " + name + key("youngs_modulus", scene.youngs_modulus) + key("c10", scene.c10) +
           key("c01", scene.c01) + key("c20", scene.c20) + key("c30", scene.c30) +
           key("poisson_ratio", scene.poisson_ratio);
  }
};

class TensileRun {
 public:
  explicit TensileRun(const MaterialOptions& options)
      : options_(options), curve_(read_tensile_curve(options.tensile)), nu_(options.specimen.poisson_ratio) {
    check_outputs(options.outputs(), options.inputs());
    try {
      linear_ = calibration::linear_range(curve_, options.tolerance_percent / 100);
      for (const auto& [law, name] : {std::pair(Law::neo_hookean, "neo-hookean"),
                                      std::pair(Law::mooney_rivlin, "mooney-rivlin"), std::pair(Law::yeoh, "yeoh")})
        add(law, name);
    } catch (const InvalidInput& error) {
      throw InvalidInput({options.tensile}, error.what());
    }
    chosen_ = options.law.empty() ? choose() : options.law;
  }

  int run() const {
    const OutputFolders folders(options_.outputs());
    if (!options_.fragment.empty()) write_file(options_.fragment, fragment());
    if (!options_.plot.empty()) write_svg(options_.plot, plot());
    if (!options_.residuals.empty()) write_file(options_.residuals, residuals());
    if (options_.json)
      print(json());
    else
      print(text());
    return done;
  }

 private:
  void add(Law law, const std::string& name) {
    FittedLaw& each = laws_.emplace_back();
    each.name = name;
    each.fit = calibration::fit_law(curve_, law, options_.most_strain);
    each.scene = calibration::scene_constants(each.fit.law, nu_);
    each.scene_quality = calibration::scene_quality(curve_, each.scene, options_.most_strain);
  }

  [[nodiscard]] double largest_stress() const {
    const auto points = static_cast<std::ptrdiff_t>(laws_.front().fit.points);
    return *std::max_element(curve_.stress.begin(), curve_.stress.begin() + points);
  }

  [[nodiscard]] std::string choose() const {
    constexpr double enough = 0.01;
    const FittedLaw* best = &laws_.front();
    for (const FittedLaw& each : laws_) {
      if (each.fit.quality.rms_mpa <= enough * largest_stress()) return each.name;
      if (each.fit.quality.rms_mpa < best->fit.quality.rms_mpa) best = &each;
    }
    return best->name;
  }

  /// A law that is chosen, or the line where it is linear.
  [[nodiscard]] std::string entry(const std::string& name) const {
    std::string what =
        "law: neo-hookean, youngs_modulus: " + number(linear_.modulus_mpa, 5) + ", poisson_ratio: " + number(nu_);
    for (const FittedLaw& each : laws_)
      if (each.name == name) what = each.yaml();
    return "- {region: " + options_.region + ", " + what + ", linear_range: " + number(linear_.end_strain, 4) + "}";
  }

  [[nodiscard]] std::string fragment() const {
    std::string text = "materials:   # softkin calibrate material --tensile " + printable(options_.tensile) + "\n  " +
                       entry(chosen_) + "\n";
    for (const std::string name : {"linear", "neo-hookean", "mooney-rivlin", "yeoh"})
      if (name != chosen_) text += "  # " + name + ": " + entry(name) + "\n";
    return text;
  }

  [[nodiscard]] std::string constants_text(const calibration::IncompressibleLaw& law) const {
    std::string text = "c10 " + number(law.c10, 5);
    if (law.law == Law::mooney_rivlin) text += ", c01 " + number(law.c01, 5);
    if (law.law == Law::yeoh) text += ", c20 " + number(law.c20, 5) + ", c30 " + number(law.c30, 5);
    return text;
  }

  [[nodiscard]] std::string notes() const {
    std::string text;
    constexpr double most_offset = 0.02;
    if (std::abs(linear_.offset_mpa) > most_offset * linear_.modulus_mpa * linear_.end_strain)
      text += "note: the straight line that fits the linear range best passes " + number(linear_.offset_mpa, 3) +
              " MPa at strain 0: was the test zeroed?\n";
    for (const FittedLaw& each : laws_) {
      if (each.fit.at_bound)
        text += "note: " + each.name +
                " without a bound has an initial modulus near 0 or below; it is held at 1 % of " +
                "the mean secant modulus\n";
      if (each.fit.falls_at)
        text += "note: " + each.name + ": the stress falls beyond a strain of " + decimal(*each.fit.falls_at, 2) +
                ": the material would be unstable there\n";
    }
    return text;
  }

  [[nodiscard]] std::string text() const {
    std::string text = options_.tensile + ": " + counted(curve_.strain.size(), "point") + " up to a strain of " +
                       number(curve_.strain.back(), 4) + "; Poisson's ratio " + number(nu_) +
                       options_.unless_given("--poisson-ratio") + ", tolerance " + number(options_.tolerance_percent) +
                       " %" + options_.unless_given("--linear-tolerance") + ", laws up to a strain of " +
                       number(options_.most_strain > 0 ? options_.most_strain : curve_.strain.back(), 4) +
                       options_.unless_given("--up-to") + "\n\n";
    text += "E " + number(linear_.modulus_mpa, 5) + " MPa, linear up to a strain of " + number(linear_.end_strain, 4) +
            (linear_.whole ? ", the end of the data" : "") + " (" + counted(linear_.points, "point") +
            "): no stress there is off the line by more than\n" + number(options_.tolerance_percent) +
            " % of the line's stress at the end; R^2 " + decimal(linear_.quality.r_squared, 5) + ", rms " +
            number(linear_.quality.rms_mpa, 3) + " MPa\n\n";
    std::vector<std::vector<std::string>> rows{{"law", "constants, incompressible [MPa]", "E at rest [MPa]", "R^2",
                                                "rms [MPa]", "largest [MPa]",
                                                "in a scene at nu " + number(nu_) + ": rms [MPa]"}};
    for (const FittedLaw& each : laws_)
      rows.push_back({each.name, constants_text(each.fit.law), number(each.fit.law.youngs_modulus(), 5),
                      decimal(each.fit.quality.r_squared, 5), number(each.fit.quality.rms_mpa, 3),
                      number(each.fit.quality.largest_mpa, 3), number(each.scene_quality.rms_mpa, 3)});
    text += joined(aligned(rows, "llrrrrr"), "") + notes() + "\n" + fragment();
    for (const auto& [what, file] : {std::pair("materials: ", options_.fragment), std::pair("plot: ", options_.plot),
                                     std::pair("residuals: ", options_.residuals)})
      if (!file.empty()) text += what + file + "\n";
    return text;
  }

  static Json quality_json(const calibration::FitQuality& quality) {
    return {{"r_squared", quality.r_squared}, {"rms_MPa", quality.rms_mpa}, {"largest_MPa", quality.largest_mpa}};
  }

  [[nodiscard]] Json json() const {
    Json json{{"softkin", SOFTKIN_VERSION}, {"tensile_file", options_.tensile}, {"points", curve_.strain.size()}};
    json["poisson_ratio"] = nu_;
    json["linear"] = {{"youngs_modulus_MPa", linear_.modulus_mpa},
                      {"end_strain", linear_.end_strain},
                      {"points", linear_.points},
                      {"tolerance", options_.tolerance_percent / 100},
                      {"ends_with_data", linear_.whole},
                      {"offset_MPa", linear_.offset_mpa},
                      {"quality", quality_json(linear_.quality)}};
    for (const FittedLaw& each : laws_) {
      const calibration::IncompressibleLaw& law = each.fit.law;
      Json& out = json["laws"][each.name];
      out = {{"c10_MPa", law.c10},
             {"c01_MPa", law.c01},
             {"c20_MPa", law.c20},
             {"c30_MPa", law.c30},
             {"youngs_modulus_MPa", law.youngs_modulus()},
             {"at_bound", each.fit.at_bound},
             {"points", each.fit.points},
             {"quality", quality_json(each.fit.quality)},
             {"quality_in_scene", quality_json(each.scene_quality)}};
      out["falls_at_strain"] = each.fit.falls_at ? Json(*each.fit.falls_at) : Json();
    }
    json["chosen"] = chosen_;
    json["materials_yaml"] = fragment();
    return json;
  }

  [[nodiscard]] std::vector<double> stresses(const FittedLaw& law, const std::vector<double>& strains) const {
    std::vector<double> all;
    for (const double strain : strains) all.push_back(calibration::uniaxial_stress(law.fit.law, strain));
    return all;
  }

  [[nodiscard]] Plot plot() const {
    PlotPanel curves, off;
    curves.title = "Tensile test";
    off.title = "Fit less measurement";
    curves.x.label = off.x.label = "nominal strain [-]";
    curves.y.label = off.y.label = "nominal stress [MPa]";
    PlotSeries data{"measured", curve_.strain, curve_.stress, false};
    PlotSeries line{"E " + number(linear_.modulus_mpa, 4) + " MPa",
                    {0, linear_.end_strain},
                    {0, linear_.modulus_mpa * linear_.end_strain},
                    true,
                    false};
    curves.series = {data, line};
    std::vector<double> even;
    const double end =
        options_.most_strain > 0 ? std::min(options_.most_strain, curve_.strain.back()) : curve_.strain.back();
    for (int i = 0; i <= 200; ++i) even.push_back(end * i / 200);
    int style = 2;
    for (const FittedLaw& law : laws_) {
      PlotSeries fitted{law.name, even, stresses(law, even), true, false, false, style};
      curves.series.push_back(fitted);
      const auto count = static_cast<std::ptrdiff_t>(law.fit.points);
      PlotSeries left{law.name, {curve_.strain.begin(), curve_.strain.begin() + count}, {}, true, true, false, style++};
      left.y = stresses(law, left.x);
      for (std::size_t i = 0; i < left.y.size(); ++i) left.y[i] -= curve_.stress[i];
      off.series.push_back(left);
    }
    Plot plot;
    plot.title = options_.tensile;
    plot.rows = {{curves, off}};
    plot.panel_height = 320;
    return plot;
  }

  [[nodiscard]] std::string residuals() const {
    std::string text = "line,strain,stress_mpa,linear_mpa,neo_hookean_mpa,mooney_rivlin_mpa,yeoh_mpa\n";
    for (std::size_t i = 0; i < curve_.strain.size(); ++i) {
      const double strain = curve_.strain[i], stress = curve_.stress[i];
      text += std::to_string(curve_.lines[i]) + "," + number(strain, 10) + "," + number(stress, 10) + "," +
              number(linear_.modulus_mpa * strain - stress, 10);
      for (const FittedLaw& law : laws_)
        text += "," + number(calibration::uniaxial_stress(law.fit.law, strain) - stress, 10);
      text += "\n";
    }
    return text;
  }

  const MaterialOptions& options_;
  TensileCurve curve_;
  double nu_;
  calibration::LinearRange linear_;
  std::vector<FittedLaw> laws_;
  std::string chosen_;
};

}  // namespace

int calibrate_tensile(const MaterialOptions& options) {
  return TensileRun(options).run();
}

}  // namespace softkin::cli
