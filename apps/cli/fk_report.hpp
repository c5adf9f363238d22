#pragma once

#include <nlohmann/json.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <string>

namespace softkin::cli {

/// One solved step as the report has it (DESIGN: report, JSON).
[[nodiscard]] nlohmann::ordered_json step_json(const Model& model, const Equilibrium& equilibrium);

/// The report around the steps.
[[nodiscard]] nlohmann::ordered_json report_json(const Model& model, const std::string& scene);

/// Header and rows of the table on the terminal.
[[nodiscard]] std::string table_header(const Model& model);
[[nodiscard]] std::string table_row(const Model& model, std::size_t step, const nlohmann::ordered_json& json);

/// "1,851 vertices, 5,556 tetrahedra, ..." and the model's notes, a line each.
[[nodiscard]] std::string summary(const Model& model);

/// Strains and what the step may hide, for the last step, a line each.
[[nodiscard]] std::string findings(const nlohmann::ordered_json& step);

}  // namespace softkin::cli
