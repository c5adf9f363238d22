#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

/// The steps on the terminal, a row each as they come.
class StepTable {
 public:
  StepTable(const Model& model, std::size_t steps);

  [[nodiscard]] std::string header() const;
  /// json: of step_json.
  [[nodiscard]] std::string row(std::size_t step, const nlohmann::ordered_json& json) const;

 private:
  void add(const std::string& header, std::size_t width);
  [[nodiscard]] std::string line(const std::vector<std::string>& cells) const;

  const Model& model_;
  int decimals_ = 3;              // of lengths
  std::size_t length_width_ = 8;  // of one coordinate
  std::vector<std::string> headers_;
  std::vector<std::size_t> widths_;
};

/// "1,851 vertices, 5,556 tetrahedra of order 1; physical formulation (neo-hookean), solver newton", the actuators and
/// the model's notes, a line each.
[[nodiscard]] std::string summary(const Model& model, const std::string& solver);

/// Strains, slack cables and what a step may hide, a line each. step: of step_json.
[[nodiscard]] std::string findings(const Model& model, const nlohmann::ordered_json& step);

/// Why a step did not converge and what its shape is: "air reached 1.62 of 1.8: beyond this point no equilibrium
/// follows; the shape is the last good one". step: of step_json.
[[nodiscard]] std::string shortfall(const Model& model, const nlohmann::ordered_json& step);

/// "0 to 3, 7"; numbers ascend.
[[nodiscard]] std::string list_text(const std::vector<std::size_t>& numbers);

}  // namespace softkin::cli
