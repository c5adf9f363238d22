#include <algorithm>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/csv.hpp>
#include <string_view>

namespace softkin {

namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::vector<std::string_view> split(std::string_view line) {
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
  const std::vector<std::string_view> cells = split(line);
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

std::vector<double> read_row(const Scanner& scanner, std::string_view line, const std::vector<std::string>& columns) {
  const std::vector<std::string_view> cells = split(line);
  if (cells.size() != columns.size())
    scanner.fail("the row has " + std::to_string(cells.size()) + " cells, the header " +
                 std::to_string(columns.size()) + " columns");
  std::vector<double> row(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (!parse_real(cells[i], row[i]))
      scanner.fail("column " + excerpt(columns[i]) + " must hold a finite number, not " + excerpt(cells[i]) +
                   " (cells are separated by commas)");
  return row;
}

}  // namespace

CsvTable read_csv(const std::filesystem::path& path) {
  Scanner scanner(path);
  std::string_view line;
  if (!next_line(scanner, line)) throw InvalidInput({path.string()}, "has no header");
  CsvTable table;
  table.columns = read_header(scanner, line);
  table.header_line = scanner.here().line;
  while (next_line(scanner, line)) {
    table.rows.push_back(read_row(scanner, line, table.columns));
    table.lines.push_back(scanner.here().line);
  }
  if (table.rows.empty()) scanner.fail("no row follows the header");
  return table;
}

}  // namespace softkin
