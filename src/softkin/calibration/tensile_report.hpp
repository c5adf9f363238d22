#pragma once

#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/core/elastic_stability.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// The options of a tensile test's evaluation.
struct TensileTask {
  std::string file;  // of the test, for messages
  double poisson_ratio = 0.45;
  double tolerance_percent = 5;  // of the linear range
  double max_strain = 0;         // that laws are fitted to; 0: all
  std::string law;               // of the scene: "linear", "ogden" or that of a fit; empty: the one that fits
  std::string region = "body";   // of the scene
  bool stable = true;            // laws are kept stable over the range that is fitted
};

/// A law fitted, and as a scene has it.
struct FittedLaw {
  LawChoice choice;
  LawFit fit;
  ElasticSpec scene;
  FitQuality scene_quality;
  std::optional<StabilityLimit> unstable_at;  // stretches up to twice the largest that was fitted
};

struct TensileResults {
  TensileCurve curve;
  LinearRange linear;            // without points: it has none
  std::vector<FittedLaw> laws;   // fitted_laws()
  std::string chosen;            // "linear" or one of them
  std::string linear_failure{};  // why there is no linear range
};

/// Finds the linear range and fits all laws. Where no law is requested, the first of fitted_laws() is chosen whose rms
/// is 1 % of the largest stress or less, else the best.
/// A curve without a linear range is accepted where a law comes within 10 % of its largest stress (rms): its beginning
/// is noisy or slack, but it is a tensile test.
///
/// throws  InvalidInput naming the file, as linear_range and fit_law do
[[nodiscard]] TensileResults evaluate(const TensileTask& task, TensileCurve curve);

// The results, for people and programs.

[[nodiscard]] std::string tensile_text(const TensileTask& task, const TensileResults& results);
[[nodiscard]] std::string tensile_json(const TensileTask& task, const TensileResults& results);
[[nodiscard]] Plot tensile_plot(const TensileTask& task, const TensileResults& results);
[[nodiscard]] Table residual_table(const TensileResults& results);
/// Several tests side by side: a row for each law of each.
[[nodiscard]] std::string tensile_comparison(const std::vector<std::pair<TensileTask, TensileResults>>& tests);
[[nodiscard]] std::string tensile_comparison_json(const std::vector<std::pair<TensileTask, TensileResults>>& tests);
/// The material of a scene, YAML; the other laws as comments.
[[nodiscard]] std::string tensile_fragment(const TensileTask& task, const TensileResults& results);

}  // namespace softkin::calibration
