#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace softkin {

/// A column of a table that users see. Numbers of the text have so many digits; CSV and JSON hold them as they are.
struct Column {
  enum class Form { decimals, significant };

  std::string key{};    // of CSV and JSON, with its unit: "tip_x_mm"
  std::string title{};  // of the text: "tip x"; empty: the key; both empty: none
  std::string unit{};   // of the text: "mm", "-"; empty: the title is all there is
  int digits = 6;       // behind the point, or significant
  Form form = Form::significant;
  std::size_t width = 0;  // of the text, at least
  bool left = false;      // aligned to the left; else to the right
};

/// Nothing (not known, does not apply), a number, a count, or words.
using Cell = std::variant<std::monostate, double, std::int64_t, std::string>;
using Row = std::vector<Cell>;

/// Columns and rows, rendered to aligned text, CSV and JSON.
struct Table {
  std::vector<Column> columns;
  std::vector<Row> rows{};

  /// The columns' titles with their units, and a row below them: what is printed row by row as it comes. A column is as
  /// wide as its title, its width says more.
  [[nodiscard]] std::string header() const;
  [[nodiscard]] std::string line(const Row& row) const;

  /// Header and all rows, every column as wide as it needs, a line each; where they are wider than `most` characters,
  /// every row turned instead, with an empty line between them. 0: as wide as they are
  [[nodiscard]] std::vector<std::string> lines(std::size_t most = 0) const;
  /// A row on its side: a line of title and value for each cell that is not nothing.
  [[nodiscard]] std::vector<std::string> turned(const Row& row) const;
  /// The rows alone, every column as wide as their cells need; titles do not count.
  [[nodiscard]] std::vector<std::string> body() const;

  /// The titles with their units, then the cells of every row, as they are shown.
  [[nodiscard]] std::vector<std::vector<std::string>> cells() const;

  /// A line of keys, then the rows: numbers so that they read back as they were, nothing as an empty cell.
  [[nodiscard]] std::string csv() const;

  /// An array of objects, by the columns' keys; nothing is null.
  [[nodiscard]] std::string json() const;
};

}  // namespace softkin
