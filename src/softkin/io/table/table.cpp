#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/io/table/table.hpp>

namespace softkin {

namespace {

std::string title_of(const Column& column) {
  const std::string title = column.title.empty() ? column.key : column.title;
  return column.unit.empty() ? title : title + " [" + column.unit + "]";
}

std::string text_of(const Cell& cell, const Column& column) {
  if (const auto* value = std::get_if<double>(&cell)) {
    if (!std::isfinite(*value)) return "unknown";
    return column.form == Column::Form::decimals ? decimal(*value, column.digits) : number(*value, column.digits);
  }
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
  if (const auto* words = std::get_if<std::string>(&cell)) return *words;
  return "";
}

/// Without blanks at the end.
std::string aligned(const std::vector<std::string>& cells, const std::vector<Column>& columns,
                    const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t length = characters(cells[i]);
    const std::string fill(length < widths[i] ? widths[i] - length : 0, ' ');
    line += i > 0 ? "  " : "";
    line += columns[i].left ? cells[i] + fill : fill + cells[i];
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& texts, const std::vector<Column>& columns,
                                 std::vector<std::size_t> widths) {
  for (const auto& cells : texts)
    for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], characters(cells[i]));
  std::vector<std::string> lines;
  for (const auto& cells : texts) lines.push_back(aligned(cells, columns, widths));
  return lines;
}

std::vector<std::size_t> widths_of(const std::vector<Column>& columns) {
  std::vector<std::size_t> widths;
  for (const Column& column : columns) widths.push_back(std::max(column.width, characters(title_of(column))));
  return widths;
}

std::vector<std::string> cells_of(const Row& row, const std::vector<Column>& columns) {
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < columns.size(); ++i) cells.push_back(text_of(row.at(i), columns[i]));
  return cells;
}

std::vector<std::string> titles_of(const std::vector<Column>& columns) {
  std::vector<std::string> titles;
  for (const Column& column : columns) titles.push_back(title_of(column));
  return titles;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string csv_of(const Cell& cell) {
  if (const auto* value = std::get_if<double>(&cell)) return std::isfinite(*value) ? exact(*value) : "";
  if (const auto* count = std::get_if<std::int64_t>(&cell)) return std::to_string(*count);
  if (const auto* words = std::get_if<std::string>(&cell)) return quoted(*words);
  return "";
}

}  // namespace

std::string Table::header() const {
  return aligned(titles_of(columns), columns, widths_of(columns));
}

std::string Table::line(const Row& row) const {
  return aligned(cells_of(row, columns), columns, widths_of(columns));
}

std::vector<std::string> Table::lines(std::size_t most) const {
  std::vector<std::vector<std::string>> texts{titles_of(columns)};
  for (const Row& row : rows) texts.push_back(cells_of(row, columns));
  std::vector<std::string> all = aligned(texts, columns, widths_of(columns));
  const auto too_wide = [&](const std::string& line) { return most > 0 && characters(line) > most; };
  if (rows.empty() || std::none_of(all.begin(), all.end(), too_wide)) return all;
  all.clear();
  for (const Row& row : rows) {
    if (!all.empty()) all.emplace_back();
    const std::vector<std::string> lines = turned(row);
    all.insert(all.end(), lines.begin(), lines.end());
  }
  return all;
}

std::vector<std::string> Table::turned(const Row& row) const {
  const std::vector<std::string> cells = cells_of(row, columns);
  std::vector<std::vector<std::string>> texts;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (!cells[i].empty()) texts.push_back({title_of(columns[i]), cells[i]});
  return aligned(texts, {Column{.left = true}, Column{.left = true}}, {0, 0});
}

std::vector<std::string> Table::body() const {
  std::vector<std::vector<std::string>> texts;
  for (const Row& row : rows) texts.push_back(cells_of(row, columns));
  return aligned(texts, columns, std::vector<std::size_t>(columns.size(), 0));
}

std::vector<std::vector<std::string>> Table::cells() const {
  std::vector<std::vector<std::string>> all(1);
  for (const Column& column : columns) all.front().push_back(title_of(column));
  for (const Row& row : rows) all.push_back(cells_of(row, columns));
  return all;
}

std::string Table::csv() const {
  std::string text;
  for (std::size_t i = 0; i < columns.size(); ++i) text += (i > 0 ? "," : "") + quoted(columns[i].key);
  text += "\n";
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < columns.size(); ++i) text += (i > 0 ? "," : "") + csv_of(row.at(i));
    text += "\n";
  }
  return text;
}

std::string Table::json() const {
  Json all = Json::array();
  for (const Row& row : rows) {
    Json object = Json::object();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      Json& value = object[columns[i].key];
      if (const auto* real = std::get_if<double>(&row.at(i)); real != nullptr && std::isfinite(*real)) value = *real;
      if (const auto* count = std::get_if<std::int64_t>(&row.at(i))) value = *count;
      if (const auto* words = std::get_if<std::string>(&row.at(i))) value = *words;
    }
    all.push_back(std::move(object));
  }
  return json_text(all);
}

}  // namespace softkin
