#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/csv.hpp>
#include <string_view>
#include <utility>

namespace softkin {

namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    cells.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

/// The next line that is neither blank nor a comment; false at the end of the file.
bool next_line(Scanner& scanner, std::string_view& line) {
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  while (scanner.remaining() > 0) {
    std::string_view text = scanner.line();
    if (scanner.here().line == 1 && text.substr(0, 3) == byte_order_mark) text.remove_prefix(3);
    line = trimmed(text);
    if (line.empty() || line.front() == '#') continue;
    if (line.find('"') != std::string_view::npos)
      scanner.fail("quotes are not supported; write the cells without them");
    return true;
  }
  return false;
}

bool is_number(std::string_view text) {
  double value = 0;
  return parse_real(text, value);
}

std::vector<std::string> read_header(const Scanner& scanner, std::string_view line) {
  if (line.find('\r') != std::string_view::npos || find_unprintable(line) != std::string_view::npos)
    scanner.fail("the header " + excerpt(line) +
                 " holds control characters or is not UTF-8; lines end with LF or CRLF");
  if (line.find(';') != std::string_view::npos)
    scanner.fail("the header " + excerpt(line) +
                 " has semicolons: separate the cells by commas, and write numbers with a decimal point");
  const std::vector<std::string_view> cells = cells_of(line);
  if (std::all_of(cells.begin(), cells.end(), is_number))
    scanner.fail("the header is missing: " + excerpt(line) + " holds numbers where columns are named");
  std::vector<std::string> columns;
  for (const std::string_view cell : cells) {
    if (cell.empty()) scanner.fail("column " + std::to_string(columns.size() + 1) + " of the header has no name");
    if (std::find(columns.begin(), columns.end(), cell) != columns.end())
      scanner.fail("column " + excerpt(cell) + " appears twice in the header");
    columns.emplace_back(cell);
  }
  return columns;
}

std::vector<double> read_row(const Scanner& scanner, std::string_view line, const std::vector<std::string>& columns,
                             bool gaps) {
  const std::vector<std::string_view> cells = cells_of(line);
  if (cells.size() != columns.size())
    scanner.fail("the row has " + std::to_string(cells.size()) + " cells, the header " +
                 std::to_string(columns.size()) + " columns" +
                 (cells.size() > columns.size() ? "; a number is written with a decimal point, not a comma" : ""));
  std::vector<double> row(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (gaps && cells[i].empty())
      row[i] = std::numeric_limits<double>::quiet_NaN();
    else if (!parse_real(cells[i], row[i]))
      scanner.fail("column " + excerpt(columns[i]) + " must hold a finite number, not " + excerpt(cells[i]) +
                   " (cells are separated by commas)");
  return row;
}

constexpr double max_runs = 1e6;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

CsvTable table_of(Scanner& scanner, const std::string& file, bool gaps = false) {
  std::string_view line;
  if (!next_line(scanner, line)) throw InvalidInput({file}, "has no header");
  CsvTable table;
  table.file = file;
  table.columns = read_header(scanner, line);
  table.header_line = scanner.here().line;
  while (next_line(scanner, line)) {
    table.rows.push_back(read_row(scanner, line, table.columns, gaps));
    table.lines.push_back(scanner.here().line);
  }
  if (table.rows.empty()) scanner.fail("no row follows the header");
  return table;
}

}  // namespace

CsvTable read_csv(const std::filesystem::path& path) {
  Scanner scanner(path);
  return table_of(scanner, path.string());
}

CsvTable read_csv_with_gaps(const std::filesystem::path& path) {
  Scanner scanner(path);
  return table_of(scanner, path.string(), true);
}

CsvTable parse_csv(const std::string& file, std::string_view text) {
  Scanner scanner(file, text);
  return table_of(scanner, file);
}

std::optional<std::size_t> CsvTable::find(const std::string& column) const {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

void CsvTable::fail(std::size_t row, const std::string& message) const {
  throw InvalidInput({file, lines[row]}, message);
}

void CsvTable::fail_header(const std::string& message) const {
  throw InvalidInput({file, header_line}, message);
}

RunTable::RunTable(const std::filesystem::path& path, const std::vector<std::string>& known,
                   const std::vector<std::pair<std::string, std::string>>& units)
    : CsvTable(read_csv(path)) {
  std::vector<std::string> names = known;
  names.insert(names.end(), {"run", "t_s"});
  for (const std::string& column : std::exchange(columns, {})) {
    const std::string name = lower(column);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      for (const auto& [begin, unit] : units)
        if (name.starts_with(begin)) fail_header("column " + excerpt(column) + ": " + unit);
      fail_header("unknown column " + excerpt(column) + suggest_name(name, names));
    }
    if (find(name)) fail_header("column " + excerpt(column) + " appears twice in the header");
    columns.push_back(name);
  }
  group();
  check_times();
}

void RunTable::group() {
  std::vector<double> numbers;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const double number = find("run") ? cell(row, "run") : 1;
    if (number != std::round(number) || std::abs(number) > max_runs)
      fail(row, "column 'run' must hold whole numbers, not " + std::to_string(number));
    const auto found = std::find(numbers.begin(), numbers.end(), number);
    if (found == numbers.end()) {
      numbers.push_back(number);
      runs.push_back({"run " + std::to_string(static_cast<long>(number)), {row}});
      continue;
    }
    Run& run = runs[found - numbers.begin()];
    if (run.rows.back() + 1 != row) fail(row, run.name + " goes on here after another run: keep its rows together");
    run.rows.push_back(row);
  }
}

void RunTable::check_times() const {
  if (!find("t_s")) return;
  for (const Run& run : runs)
    for (std::size_t i = 1; i < run.rows.size(); ++i)
      if (!(cell(run.rows[i], "t_s") > cell(run.rows[i - 1], "t_s")))
        fail(run.rows[i], "column 't_s': times must ascend within " + run.name);
}

std::string RunTable::one_of(const std::vector<std::string>& choices, const std::string& what) const {
  std::string found, names;
  for (const std::string& column : choices) {
    names += (names.empty() ? "" : ", ") + column;
    if (!find(column)) continue;
    if (!found.empty()) fail_header("both '" + found + "' and '" + column + "' give " + what + ": which one counts?");
    found = column;
  }
  if (found.empty()) fail_header("no column gives " + what + ": " + names);
  return found;
}

}  // namespace softkin
