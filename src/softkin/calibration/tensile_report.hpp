#pragma once

#include <softkin/calibration/tensile_fit.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// What is asked of a tensile test.
struct TensileTask {
  std::string file;  // of the test, for messages
  double poisson_ratio = 0.45;
  double tolerance_percent = 5;  // of the linear range
  double most_strain = 0;        // that laws are fitted to; 0: all
  std::string law;               // of the scene: "linear" or that of a fit; empty: the one that fits
  std::string region = "body";   // of the scene
};

/// A law fitted, and as a scene has it.
struct FittedLaw {
  LawFit fit;
  ElasticSpec scene;
  FitQuality scene_quality;
};

struct TensileResults {
  TensileCurve curve;
  LinearRange linear;
  std::vector<FittedLaw> laws;  // neo-hookean, mooney-rivlin, yeoh
  std::string chosen;           // "linear" or one of them
};

/// The linear range and all laws. Where none is asked for, that with the fewest constants is chosen whose rms is 1 % of
/// the largest stress or less, else the best.
/// throws  InvalidInput naming the file, as linear_range and fit_law do
[[nodiscard]] TensileResults evaluate(const TensileTask& task, TensileCurve curve);

// The results, for people and programs.

[[nodiscard]] std::string tensile_text(const TensileTask& task, const TensileResults& results);
[[nodiscard]] std::string tensile_json(const TensileTask& task, const TensileResults& results);
[[nodiscard]] Plot tensile_plot(const TensileTask& task, const TensileResults& results);
[[nodiscard]] Table residual_table(const TensileResults& results);
/// The material of a scene, YAML; the other laws as comments.
[[nodiscard]] std::string tensile_fragment(const TensileTask& task, const TensileResults& results);

}  // namespace softkin::calibration
