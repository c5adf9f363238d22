#include <algorithm>
#include <cctype>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/run_table.hpp>

namespace softkin {

namespace {

constexpr double most_runs = 1e6;

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

RunTable::RunTable(const std::filesystem::path& path, const std::vector<std::string>& known,
                   const std::vector<std::pair<std::string, std::string>>& units)
    : file_(path.string()), table_(read_csv(path)) {
  std::vector<std::string> names = known;
  names.insert(names.end(), {"run", "t_s"});
  for (const std::string& column : table_.columns) {
    const std::string name = lower(column);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      for (const auto& [begin, unit] : units)
        if (name.starts_with(begin)) fail_header("column " + excerpt(column) + ": " + unit);
      fail_header("unknown column " + excerpt(column) + suggest_name(name, names));
    }
    if (has(name)) fail_header("column " + excerpt(column) + " appears twice in the header");
    columns_.push_back(name);
  }
  group();
  check_times();
}

void RunTable::group() {
  std::vector<double> numbers;
  for (std::size_t row = 0; row < table_.rows.size(); ++row) {
    const double number = has("run") ? cell(row, "run") : 1;
    if (number != std::round(number) || std::abs(number) > most_runs)
      fail(row, "column 'run' must hold whole numbers, not " + std::to_string(number));
    const auto found = std::find(numbers.begin(), numbers.end(), number);
    if (found == numbers.end()) {
      numbers.push_back(number);
      runs_.push_back({"run " + std::to_string(static_cast<long>(number)), {row}});
      continue;
    }
    Run& run = runs_[static_cast<std::size_t>(found - numbers.begin())];
    if (run.rows.back() + 1 != row) fail(row, run.name + " goes on here after another run: keep its rows together");
    run.rows.push_back(row);
  }
}

void RunTable::check_times() const {
  if (!has("t_s")) return;
  for (const Run& run : runs_)
    for (std::size_t i = 1; i < run.rows.size(); ++i)
      if (!(cell(run.rows[i], "t_s") > cell(run.rows[i - 1], "t_s")))
        fail(run.rows[i], "column 't_s': times must ascend within " + run.name);
}

std::optional<std::size_t> RunTable::place(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

bool RunTable::has(const std::string& column) const {
  return place(column).has_value();
}

std::string RunTable::one_of(const std::vector<std::string>& columns, const std::string& what) const {
  std::string found, names;
  for (const std::string& column : columns) {
    names += (names.empty() ? "" : ", ") + column;
    if (!has(column)) continue;
    if (!found.empty()) fail_header("both '" + found + "' and '" + column + "' give " + what + ": which one counts?");
    found = column;
  }
  if (found.empty()) fail_header("no column gives " + what + ": " + names);
  return found;
}

double RunTable::cell(std::size_t row, const std::string& column) const {
  return table_.rows[row][place(column).value()];
}

void RunTable::fail(std::size_t row, const std::string& message) const {
  throw InvalidInput({file_, table_.lines[row]}, message);
}

void RunTable::fail_header(const std::string& message) const {
  throw InvalidInput({file_, table_.header_line}, message);
}

}  // namespace softkin
