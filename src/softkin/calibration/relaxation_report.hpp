#pragma once

#include <softkin/calibration/relaxation_fit.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/relaxation_runs.hpp>
#include <softkin/io/table/table.hpp>
#include <string>
#include <vector>

namespace softkin::calibration {

/// The options of a fit to relaxation, creep and cyclic tests.
struct RelaxationTask {
  std::vector<std::string> tests, creep;  // CSV: of imposed stretches, and of imposed stresses
  std::string law = "neo-hookean";        // or mooney-rivlin, yeoh, gent
  std::map<std::string, double> constants{};
  std::optional<std::size_t> branches{};
  StripSize size{};
  double poisson_ratio = 0.49;  // of the scene
  std::string region = "body";  // of the scene
};

/// "c10=0.4,c01=1.9": constants by their names.
///
/// throws  InvalidInput, naming the option, on anything else
[[nodiscard]] std::map<std::string, double> read_constants(const std::string& option, const std::string& text);

struct RelaxationResults {
  std::vector<RelaxationRun> runs;
  RelaxationFit fit;
  std::vector<Eigen::VectorXd> answers;  // what each run would have answered
};

/// Reads the tests and fits law and branches.
/// throws  InvalidInput on a law of another name, as read_relaxation_runs and fit_relaxation do
[[nodiscard]] RelaxationResults evaluate(const RelaxationTask& task);

// The results, for people and programs.

[[nodiscard]] std::string relaxation_text(const RelaxationTask& task, const RelaxationResults& results);
[[nodiscard]] std::string relaxation_json(const RelaxationTask& task, const RelaxationResults& results);
/// Relaxation and creep over the logarithm of time, cycles as loops.
[[nodiscard]] Plot relaxation_plot(const RelaxationTask& task, const RelaxationResults& results);
/// Measured, fitted and their difference.
[[nodiscard]] Table relaxation_table(const RelaxationResults& results);
/// The material of a scene, YAML.
[[nodiscard]] std::string relaxation_fragment(const RelaxationTask& task, const RelaxationResults& results);

}  // namespace softkin::calibration
