#pragma once

#include <nlohmann/json.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/measure.hpp>
#include <string>
#include <vector>

#include "solve_options.hpp"

namespace softkin::cli {

/// The report: what it is about, then the steps.
class Report {
 public:
  using Json = nlohmann::ordered_json;

  Report(const Model& model, const SolveOptions& options);

  /// What it is about: version, scene, robot, formulation, materials, actuators, solver, units, mesh, notes.
  [[nodiscard]] const Json& head() const { return head_; }
  /// One more entry of what it is about.
  void note(const std::string& key, Json value) { head_[key] = std::move(value); }
  /// Throws Json::exception on a step that step_json did not make.
  void add(Json step);
  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  [[nodiscard]] const Json& last() const { return last_; }
  /// A step that did not converge, without its history.
  struct Unconverged {
    std::size_t number = 0;
    Json step;
  };
  [[nodiscard]] const std::vector<Unconverged>& unconverged() const { return unconverged_; }

  /// JSON, a line for each key and each step. Grows by what add() brings, so that it can be written after every step.
  [[nodiscard]] std::string text() const;

 private:
  Json head_, last_;
  std::vector<std::string> lines_;
  std::vector<Unconverged> unconverged_;
  double seconds_ = 0;
};

/// One solved step; deformation: of its shape.
[[nodiscard]] Report::Json step_json(const Model& model, const Equilibrium& equilibrium,
                                     const ElementDeformation& deformation);

}  // namespace softkin::cli
