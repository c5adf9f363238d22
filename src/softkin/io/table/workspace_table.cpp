#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/workspace_table.hpp>
#include <string_view>
#include <utility>

namespace softkin {

namespace {

constexpr std::array<Status, 3> statuses{Status::converged, Status::not_converged, Status::limit};

std::vector<std::string> all_columns(const WorkspaceColumns& columns) {
  std::vector<std::string> all{"sample"};
  for (const auto* part : {&columns.actuators, &columns.markers, &columns.loads})
    all.insert(all.end(), part->begin(), part->end());
  all.insert(all.end(), {"status", "reached", "iterations"});
  return all;
}

std::string column_line(const WorkspaceColumns& columns) {
  std::string line;
  for (const std::string& name : all_columns(columns)) line += (line.empty() ? "" : ",") + name;
  return line;
}

void add_number(std::string& line, double value) {
  std::array<char, 32> text;
  const double printed = value == 0 ? 0.0 : value;  // never "-0"
  line.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), printed).ptr);
}

/// The cells of one row.
class RowReader {
 public:
  RowReader(Origin origin, const WorkspaceColumns& columns, std::string_view line)
      : origin_(std::move(origin)), columns_(columns), line_(line) {}

  /// Cells of markers and loads stand before the status that determines whether they are empty.
  WorkspaceSample read() {
    WorkspaceSample sample;
    sample.number = integer("sample");
    sample.actuation.resize(columns_.actuators.size());
    for (Index a = 0; a < sample.actuation.size(); ++a) sample.actuation[a] = real(columns_.actuators[a]);
    const std::size_t values = cursor_;
    for (std::size_t i = 0; i < columns_.markers.size() + columns_.loads.size(); ++i) (void)cell();
    sample.status = status();
    const bool has_values = read_reached(sample);
    sample.iterations = integer("iterations");
    if (!ended_) fail("the row has more cells than the header has columns");
    cursor_ = values;
    ended_ = false;
    if (has_values)
      read_values(sample);
    else
      for (std::size_t i = 0; i < columns_.markers.size() + columns_.loads.size(); ++i)
        if (!cell().empty()) fail("a sample without an equilibrium has values of markers or loads");
    return sample;
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput(origin_, message); }

  std::string_view cell() {
    if (ended_) fail("the row has fewer cells than the header has columns");
    const std::size_t comma = line_.find(',', cursor_);
    const std::string_view text = line_.substr(cursor_, comma - cursor_);
    ended_ = comma == std::string_view::npos;
    cursor_ = comma + 1;
    return text;
  }

  Index integer(const char* column) {
    const std::string_view text = cell();
    std::int64_t value = 0;
    if (!parse_integer(text, value) || value < 0 || value > std::numeric_limits<Index>::max())
      fail(std::string("column '") + column + "' must hold a whole number, not " + excerpt(text));
    return value;
  }

  double real(const std::string& column) { return real(cell(), column); }

  double real(std::string_view text, const std::string& column) const {
    double value = 0;
    if (!parse_real(text, value))
      fail("column " + excerpt(column) + " must hold a finite number, not " + excerpt(text));
    return value;
  }

  Status status() {
    const std::string_view text = cell();
    for (const Status each : statuses)
      if (text == workspace_status(each)) return each;
    fail("column 'status' must hold converged, not_converged or limit, not " + excerpt(text));
  }

  /// Has the sample a shape?
  bool read_reached(WorkspaceSample& sample) {
    const std::string_view text = cell();
    if (sample.status != Status::converged && text.empty()) return false;
    sample.reached = real(text, "reached");
    const bool whole = sample.status == Status::converged;
    if (sample.status == Status::not_converged || !(sample.reached > 0 && sample.reached <= 1) ||
        whole != (sample.reached == 1))
      fail(
          "column 'reached' must be 1 where a sample converged, between 0 and 1 or empty at a limit, and empty where "
          "it did not converge");
    return true;
  }

  void read_values(WorkspaceSample& sample) {
    sample.markers.resize(static_cast<Index>(columns_.markers.size() / 3), 3);
    for (Index i = 0; i < sample.markers.size(); ++i) sample.markers.data()[i] = real(columns_.markers[i]);
    sample.multipliers.setZero(sample.actuation.size());
    for (std::size_t i = 0; i < columns_.loads.size(); ++i)
      sample.multipliers[columns_.loaded[i]] = real(columns_.loads[i]);
  }

  Origin origin_;
  const WorkspaceColumns& columns_;
  std::string_view line_;
  std::size_t cursor_ = 0;  // in the line
  bool ended_ = false;
};

class SampleReader {
 public:
  SampleReader(const std::filesystem::path& path, const WorkspaceColumns& columns)
      : file_(path.string()), columns_(columns), content_(read_file(path)) {}

  WorkspaceTable read() {
    read_head();
    std::set<Index> seen;
    while (next_line()) {
      const WorkspaceSample sample = RowReader({file_, number_}, columns_, line_).read();
      if (!seen.insert(sample.number).second) fail("sample " + std::to_string(sample.number) + " stands twice");
      table_.samples.push_back(sample);
      table_.rows.push_back(std::string(line_) + "\n");
    }
    table_.whole_bytes = at_;
    table_.torn = at_ < content_.size();
    return std::move(table_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput({file_, number_}, message); }

  /// The next line that is whole.
  bool next_line() {
    const std::size_t end = content_.find('\n', at_);
    if (end == std::string::npos) return false;
    line_ = std::string_view(content_).substr(at_, end - at_);
    at_ = end + 1;
    ++number_;
    return true;
  }

  void read_head() {
    while (next_line() && line_.starts_with("# ")) {
      const std::size_t colon = line_.find(": ");
      if (colon == std::string_view::npos) continue;
      table_.head.emplace_back(line_.substr(2, colon - 2), line_.substr(colon + 2));
    }
    if (table_.head.empty() || table_.head.front().first != "softkin workspace")
      throw InvalidInput({file_},
                         "is not a workspace that softkin wrote: it does not begin with '# softkin workspace'");
    if (line_ == column_line(columns_)) return;
    fail("the columns are those of another robot: " + excerpt(line_) + " instead of " + excerpt(column_line(columns_)));
  }

  std::string file_;
  const WorkspaceColumns& columns_;
  std::string content_;
  WorkspaceTable table_;
  std::size_t at_ = 0, number_ = 0;  // bytes and lines read
  std::string_view line_;
};

}  // namespace

std::string workspace_header(const WorkspaceHead& head, const WorkspaceColumns& columns) {
  std::set<std::string> seen;
  for (const std::string& name : all_columns(columns)) {
    if (name.empty() || find_unprintable(name) != std::string_view::npos ||
        name.find_first_of(",\"\t\r\n#") != std::string::npos)
      throw InvalidInput("column " + excerpt(name) +
                         ": a name with a comma, quote, # or control character cannot head a column of a CSV file");
    if (!seen.insert(name).second)
      throw InvalidInput("two columns of the workspace would have the name " + excerpt(name));
  }
  std::string text;
  for (const auto& [key, value] : head) text += "# " + key + ": " + value + "\n";
  return text + column_line(columns) + "\n";
}

std::string workspace_row(const WorkspaceSample& sample, const WorkspaceColumns& columns) {
  std::string line = std::to_string(sample.number);
  const auto add = [&](double value) {
    line += ',';
    add_number(line, value);
  };
  for (Index a = 0; a < sample.actuation.size(); ++a) add(sample.actuation[a]);
  const bool has_values = sample.markers.rows() > 0 || sample.status == Status::converged;
  if (has_values) {
    for (Index i = 0; i < sample.markers.size(); ++i) add(sample.markers.data()[i]);
    for (const Index a : columns.loaded) add(sample.multipliers[a]);
  } else {
    line.append(columns.markers.size() + columns.loads.size(), ',');
  }
  line += std::string(",") + workspace_status(sample.status) + ",";
  if (has_values) add_number(line, sample.reached);
  return line + "," + std::to_string(sample.iterations) + "\n";
}

WorkspaceSample read_workspace_row(std::string_view row, const WorkspaceColumns& columns, const std::string& source) {
  const std::string_view line = row.ends_with('\n') ? row.substr(0, row.size() - 1) : row;
  return RowReader({source}, columns, line).read();
}

const char* workspace_status(Status status) {
  return status == Status::converged ? "converged" : status == Status::limit ? "limit" : "not_converged";
}

WorkspaceTable read_workspace(const std::filesystem::path& path, const WorkspaceColumns& columns) {
  return SampleReader(path, columns).read();
}

}  // namespace softkin
