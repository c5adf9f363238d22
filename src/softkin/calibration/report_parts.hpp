#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/plot/svg_plot.hpp>
#include <softkin/io/table/table.hpp>
#include <string>

// Declarations for the .cpp files of the reports; no header of the module includes this one.

namespace softkin::calibration {

template <class Value>
[[nodiscard]] Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

[[nodiscard]] inline std::string text_of(const Json& json) {
  return json_text(json) + "\n";
}

[[nodiscard]] inline std::string text_of(const Table& table) {
  std::string text;
  for (const std::string& line : table.lines()) text += line + "\n";
  return text;
}

[[nodiscard]] inline Column decimals(const std::string& title, const std::string& unit, int digits) {
  return {.key = title, .unit = unit, .digits = digits, .form = Column::Form::decimals};
}

[[nodiscard]] inline Column significant(const std::string& title, const std::string& unit, int digits = 6) {
  return {.key = title, .unit = unit, .digits = digits};
}

[[nodiscard]] inline Cell or_dash(bool known, double value) {
  return known ? Cell(value) : Cell("-");
}

/// A cell of a CSV of measured and fitted values, which are not known to more digits.
[[nodiscard]] inline Cell ten_digits(double value) {
  return number(value, 10);
}

[[nodiscard]] inline Cell count_cell(std::size_t count) {
  return static_cast<std::int64_t>(count);
}

[[nodiscard]] inline PlotPanel panel_of(const std::string& title, const std::string& x, const std::string& y) {
  PlotPanel panel;
  panel.title = title;
  panel.x.label = x;
  panel.y.label = y;
  return panel;
}

/// A table of these columns, by their keys, without rows.
[[nodiscard]] inline Table csv_table(const std::vector<std::string>& keys) {
  Table table;
  for (const std::string& key : keys) table.columns.push_back({.key = key});
  return table;
}

}  // namespace softkin::calibration
