#pragma once

#include <cstddef>
#include <softkin/model/model.hpp>
#include <softkin/runs/records.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

using runs::ActuatorRecord;
using runs::StepRecord;

/// The steps on the terminal, a row each as they come.
class StepTable {
 public:
  StepTable(const Model& model, std::size_t steps);

  [[nodiscard]] std::string header() const;
  [[nodiscard]] std::string row(std::size_t number_of_step, const StepRecord& step) const;

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

/// Strains, slack cables and what a step may hide, a line each.
[[nodiscard]] std::string findings_text(const Model& model, const StepRecord& step);

/// Why a step did not converge and what its shape is: "air reached 1.62 of 1.8: beyond this point no equilibrium
/// follows; the shape is the last good one".
[[nodiscard]] std::string shortfall_text(const Model& model, const StepRecord& step);

}  // namespace softkin::cli
