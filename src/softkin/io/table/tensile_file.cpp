#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/table/tensile_branch.hpp>
#include <softkin/io/table/tensile_file.hpp>

namespace softkin {

namespace {

constexpr double max_machine_strain = 25;  // 2500 %: beyond what any elastomer stretches by

/// What a column holds.
enum class Measure { strain, true_strain, stretch, elongation, stress, true_stress, force };

bool is_length(Measure m) {
  return m == Measure::strain || m == Measure::true_strain || m == Measure::stretch || m == Measure::elongation;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string_view stripped(std::string_view cell) {
  while (!cell.empty() && (std::isspace(static_cast<unsigned char>(cell.front())) || cell.front() == '"'))
    cell.remove_prefix(1);
  while (!cell.empty() && (std::isspace(static_cast<unsigned char>(cell.back())) || cell.back() == '"'))
    cell.remove_suffix(1);
  return cell;
}

std::vector<std::string_view> split_cells(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t at = line.find(separator);
    cells.push_back(stripped(line.substr(0, at)));
    if (at == std::string_view::npos) return cells;
    line.remove_prefix(at + 1);
  }
}

/// A number of the file, with a decimal comma where commas do not separate cells.
bool parse_cell(std::string_view cell, char separator, double& value) {
  std::string text(cell);
  if (separator != ',') std::replace(text.begin(), text.end(), ',', '.');
  return parse_real(text, value);
}

/// What stands in the last brackets of a name, or behind its last underscore or blank where that is a unit.
std::string unit_of(const std::string& name) {
  for (const auto& [open, close] : {std::pair{'(', ')'}, std::pair{'[', ']'}}) {
    const std::size_t from = name.rfind(open), to = name.rfind(close);
    if (from != std::string::npos && to != std::string::npos && from < to)
      return lower_case(stripped(std::string_view(name).substr(from + 1, to - from - 1)));
  }
  const std::size_t at = name.find_last_of("_ /");
  return at == std::string::npos ? "" : lower_case(std::string_view(name).substr(at + 1));
}

/// What a unit is worth in that of softkin: 1 for strains, MPa, N or mm; none: it is not a unit of such a measure.
std::optional<double> unit_scale(Measure measure, const std::string& unit) {
  struct Unit {
    const char* name;
    double scale;
  };
  static const std::vector<Unit> ratios{{"-", 1},     {"1", 1},    {"mm/mm", 1},      {"m/m", 1},
                                        {"in/in", 1}, {"%", 0.01}, {"percent", 0.01}, {"pct", 0.01}};
  static const std::vector<Unit> stresses{{"mpa", 1},        {"n/mm2", 1}, {"n/mm^2", 1}, {"n/mm\xC2\xB2", 1},
                                          {"kpa", 1e-3},     {"pa", 1e-6}, {"gpa", 1e3},  {"psi", 0.006894757},
                                          {"ksi", 6.894757}, {"bar", 0.1}};
  static const std::vector<Unit> forces{{"n", 1},         {"kn", 1000},       {"mn", 1e-3},    {"lbf", 4.448222},
                                        {"lb", 4.448222}, {"gf", 0.00980665}, {"kgf", 9.80665}};
  static const std::vector<Unit> lengths{{"mm", 1}, {"cm", 10}, {"m", 1000}, {"um", 1e-3}, {"in", 25.4}};
  const std::vector<Unit>& known = measure == Measure::elongation ? lengths
                                   : measure == Measure::force    ? forces
                                   : is_length(measure)           ? ratios
                                                                  : stresses;
  for (const Unit& each : known)
    if (unit == each.name) return each.scale;
  return std::nullopt;
}

bool has_word(const std::string& name, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* w) { return name.find(w) != std::string::npos; });
}

/// By its name, with or without a unit.
std::optional<Measure> measure_of(std::string_view column) {
  const std::string name = lower_case(column);
  if (name.size() > 60 || has_word(name, {"rate", "energy", "cell", "fitted"})) return std::nullopt;
  const bool is_true = has_word(name, {"true", "log", "hencky", "cauchy"});
  if (has_word(name, {"strain"})) return is_true ? Measure::true_strain : Measure::strain;
  if (has_word(name, {"stress"})) return is_true ? Measure::true_stress : Measure::stress;
  if (has_word(name, {"stretch"})) return Measure::stretch;
  if (has_word(name, {"elongation", "extension", "displacement"}))
    return unit_scale(Measure::strain, unit_of(name)).value_or(1) == 0.01 ? Measure::strain : Measure::elongation;
  if (has_word(name, {"force", "load"})) return Measure::force;
  return std::nullopt;
}

struct ChosenColumn {
  std::size_t at = 0;
  std::string name;
  Measure measure = Measure::strain;
  double scale = 1;
};

/// Reads the text of one file.
class TensileText {
 public:
  TensileText(std::string file, const std::string& text, TensileLayout layout)
      : file_(std::move(file)), layout_(std::move(layout)) {
    std::size_t from = text.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
    while (from < text.size()) {
      std::size_t to = text.find_first_of("\r\n", from);
      if (to == std::string::npos) to = text.size();
      lines_.emplace_back(text.substr(from, to - from));
      from = to + (text.compare(to, 2, "\r\n") == 0 ? 2 : 1);
    }
  }

  /// Is there a line that may be the header?
  [[nodiscard]] bool has_header() { return seek_header(); }

  /// The first line that is neither blank nor a comment.
  [[nodiscard]] std::string first_line() const {
    const auto found = std::find_if(lines_.begin(), lines_.end(), [](const std::string& line) {
      return !stripped(line).empty() && stripped(line).front() != '#';
    });
    return found == lines_.end() ? "" : *found;
  }

  [[nodiscard]] TensileCurve read() {
    find_header();
    ChosenColumn strain = chosen(true), stress = chosen(false);
    read_unit_row(strain, stress);
    set_scale(strain, layout_.strain_unit);
    set_scale(stress, layout_.stress_unit);
    TensileCurve curve = rows(strain, stress);
    note(curve, strain, stress);
    return curve;
  }

 private:
  [[noreturn]] void refuse(std::size_t line, const std::string& message) const {
    throw InvalidInput({file_, line + 1}, message);
  }

  [[nodiscard]] bool is_header(const std::vector<std::string_view>& cells) const {
    const auto has = [&](const std::string& named, bool length) {
      return std::any_of(cells.begin(), cells.end(), [&](std::string_view cell) {
        if (!named.empty()) return lower_case(cell) == lower_case(stripped(named));
        const std::optional<Measure> measure = measure_of(cell);
        return measure && is_length(*measure) == length;
      });
    };
    return cells.size() > 1 && has(layout_.strain_column, true) && has(layout_.stress_column, false);
  }

  [[nodiscard]] bool seek_header() {
    for (header_ = 0; header_ < lines_.size(); ++header_)
      for (const char separator : {';', '\t', ','}) {
        if (lines_[header_].empty() || lines_[header_].front() == '#') continue;
        const std::vector<std::string_view> cells = split_cells(lines_[header_], separator);
        if (!is_header(cells)) continue;
        separator_ = separator;
        for (const std::string_view cell : cells) columns_.emplace_back(cell);
        return true;
      }
    return false;
  }

  void find_header() {
    if (seek_header()) return;
    const bool named = !layout_.strain_column.empty() || !layout_.stress_column.empty();
    throw InvalidInput(
        {file_},
        named ? "no line has columns " + quoted(layout_.strain_column, "of a strain") + " and " +
                    quoted(layout_.stress_column, "of a stress") +
                    ": write their names as the header of the file has them"
              : std::string(
                    "no line is a header with a strain (strain, stretch or elongation) and a stress "
                    "(stress, force or load): name them by the option 'strain-column' and the option 'stress-column'"));
  }

  static std::string quoted(const std::string& name, const char* otherwise) {
    return name.empty() ? otherwise : excerpt(name);
  }

  /// The column that is named, or the only one of its kind; nominal ones before true ones before those of the specimen.
  [[nodiscard]] ChosenColumn chosen(bool length) const {
    const std::string& named = length ? layout_.strain_column : layout_.stress_column;
    std::vector<ChosenColumn> found;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      std::optional<Measure> measure = measure_of(columns_[c]);
      if (measure && is_length(*measure) != length) measure = std::nullopt;
      if (!named.empty()) {
        if (lower_case(columns_[c]) != lower_case(stripped(named))) continue;
        if (!measure) measure = length ? Measure::strain : Measure::stress;
        if (length && layout_.true_strain) measure = Measure::true_strain;
        if (!length && layout_.true_stress) measure = Measure::true_stress;
      }
      if (measure) found.push_back({c, columns_[c], *measure});
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return rank(a) < rank(b); });
    if (found.size() > 1 && rank(found[0]) == rank(found[1]))
      refuse(header_, std::string("columns ") + excerpt(found[0].name) + " and " + excerpt(found[1].name) +
                          " may both be the " + (length ? "strain" : "stress") + ": name one by " +
                          (length ? "the option 'strain-column'" : "the option 'stress-column'"));
    return found.front();
  }

  static int rank(const ChosenColumn& column) {
    switch (column.measure) {
      case Measure::strain:
      case Measure::stress:
        return 0;
      case Measure::true_strain:
      case Measure::true_stress:
        return 1;
      case Measure::stretch:
        return 2;
      case Measure::elongation:
      case Measure::force:
        break;
    }
    return 3;
  }

  /// A row of units below the header, as "(s)","(mm)","(N)".
  void read_unit_row(ChosenColumn& strain, ChosenColumn& stress) {
    first_row_ = header_ + 1;
    if (first_row_ >= lines_.size()) return;
    const std::vector<std::string_view> cells = split_cells(lines_[first_row_], separator_);
    double value = 0;
    if (cells.size() != columns_.size() ||
        std::any_of(cells.begin(), cells.end(), [&](auto cell) { return parse_cell(cell, separator_, value); }))
      return;
    if (cells[strain.at].empty() && cells[stress.at].empty()) return;
    for (ChosenColumn* each : {&strain, &stress})
      if (unit_of(each->name).empty() || !unit_scale(each->measure, unit_of(each->name)))
        each->name += cells[each->at].find_first_of("([") == std::string_view::npos
                          ? " (" + std::string(cells[each->at]) + ")"
                          : " " + std::string(cells[each->at]);
    ++first_row_;
  }

  void set_scale(ChosenColumn& column, const std::string& given) const {
    const bool length = is_length(column.measure);
    const std::string unit = given.empty() ? unit_of(column.name) : lower_case(given);
    const std::optional<double> scale = unit_scale(column.measure, unit);
    const bool may_have_none = column.measure != Measure::elongation && length;
    if (!scale && !(may_have_none && given.empty() && !has_brackets(column.name)))
      refuse(header_, "column " + excerpt(column.name) + " has no unit that is known (" + known_units(column.measure) +
                          "): give it by " + (length ? "the option 'strain-unit'" : "the option 'stress-unit'"));
    column.scale = scale.value_or(1);
    if (column.measure == Measure::elongation && !(layout_.length_mm > 0))
      refuse(header_,
             "column " + excerpt(column.name) + " is an elongation: give the specimen's length by the option 'length'");
    if (column.measure == Measure::force && !(layout_.area_mm2 > 0))
      refuse(header_, "column " + excerpt(column.name) +
                          " is a force: give the area of the specimen's cross-section by "
                          "the option 'area'");
    if (column.measure == Measure::elongation) column.scale /= layout_.length_mm;
    if (column.measure == Measure::force) column.scale /= layout_.area_mm2;
  }

  static bool has_brackets(const std::string& name) { return name.find_first_of("([") != std::string::npos; }

  static const char* known_units(Measure measure) {
    if (measure == Measure::elongation) return "mm, cm, m, um, in";
    if (measure == Measure::force) return "N, kN, mN, lbf, gf, kgf";
    return is_length(measure) ? "-, mm/mm, %" : "MPa, kPa, Pa, GPa, N/mm2, psi, ksi, bar";
  }

  [[nodiscard]] double cell(const std::vector<std::string_view>& cells, const ChosenColumn& column,
                            std::size_t line) const {
    double value = 0;
    if (column.at >= cells.size() || !parse_cell(cells[column.at], separator_, value) || !std::isfinite(value))
      refuse(line, "column " + excerpt(column.name) + " must hold a finite number, not " +
                       excerpt(column.at < cells.size() ? cells[column.at] : std::string_view()));
    return value * column.scale;
  }

  /// Nominal strain and stress of every row.
  [[nodiscard]] TensileCurve rows(const ChosenColumn& strain, const ChosenColumn& stress) const {
    TensileCurve curve;
    for (std::size_t line = first_row_; line < lines_.size(); ++line) {
      const std::vector<std::string_view> cells = split_cells(lines_[line], separator_);
      if (lines_[line].empty() || lines_[line].front() == '#' ||
          std::all_of(cells.begin(), cells.end(), [](std::string_view c) { return c.empty(); }))
        continue;
      const double measured = cell(cells, strain, line);
      const double e = strain.measure == Measure::true_strain ? std::expm1(measured)
                       : strain.measure == Measure::stretch   ? measured - 1
                                                              : measured;
      const double force = cell(cells, stress, line);
      if (!(e > -1)) refuse(line, "column " + excerpt(strain.name) + " is a strain of -100 % or less");
      if (e > max_machine_strain)
        refuse(line, "column " + excerpt(strain.name) + " is " + number(100 * e) +
                         " %, more than 2500 %: is it in percent? Then give the option 'strain-unit' as %");
      curve.strain.push_back(e);
      curve.stress.push_back(stress.measure == Measure::true_stress ? force / (1 + e) : force);
      curve.lines.push_back(line + 1);
    }
    return curve;
  }

  void note(TensileCurve& curve, const ChosenColumn& strain, const ChosenColumn& stress) const {
    const auto kind = [](const ChosenColumn& c) {
      return c.measure == Measure::true_strain || c.measure == Measure::true_stress
                 ? " (true, converted at constant volume)"
                 : "";
    };
    curve.notes.push_back("strain from column " + excerpt(strain.name) + kind(strain) + ", stress from column " +
                          excerpt(stress.name) + kind(stress));
  }

  std::string file_;
  TensileLayout layout_;
  std::vector<std::string> lines_, columns_;
  std::size_t header_ = 0, first_row_ = 0;
  char separator_ = ',';
};

/// Rows of a slightly negative strain before the curve begins.
void drop_before_rest(TensileCurve& curve, const std::string& file) {
  if (curve.strain.empty()) return;
  const double most = *std::max_element(curve.strain.begin(), curve.strain.end());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < curve.strain.size(); ++i) {
    if (curve.strain[i] < -0.02 * most)
      throw InvalidInput({file, curve.lines[i]}, "the strain is " + number(curve.strain[i], 4) +
                                                     ": a tensile test begins at rest, and its strain is not below 0");
    if (curve.strain[i] < 0) continue;
    curve.strain[kept] = curve.strain[i];
    curve.stress[kept] = curve.stress[i];
    curve.lines[kept++] = curve.lines[i];
  }
  if (kept < curve.strain.size())
    curve.notes.push_back(counted(curve.strain.size() - kept, "row") + " of a strain below 0 left out");
  curve.strain.resize(kept);
  curve.stress.resize(kept);
  curve.lines.resize(kept);
}

}  // namespace

bool is_machine_file(const std::string& text) {
  TensileText reader("", text, TensileLayout{});
  const std::string line = reader.first_line();
  for (const std::string_view cell : split_cells(line, ','))
    if ((cell.starts_with("strain") || cell.starts_with("stress")) &&
        cell.find_first_of(" ;\t([%") == std::string_view::npos)
      return false;
  return reader.has_header();
}

TensileCurve parse_tensile_file(const std::string& file, const std::string& text, const TensileLayout& layout) {
  TensileCurve curve = TensileText(file, text, layout).read();
  if (layout.zero == TensileZero::file) drop_before_rest(curve, file);
  if (curve.strain.empty()) throw InvalidInput({file}, "no row follows the header");
  curve = branch_of(curve, layout.branch);
  try {
    set_zero(curve, layout.zero);
  } catch (const InvalidInput& error) {
    throw InvalidInput({file}, error.what());
  }
  constexpr std::size_t min_rows = 5;
  if (curve.strain.size() < min_rows)
    throw InvalidInput(
        {file}, "a tensile test needs at least five rows that ascend, not " + std::to_string(curve.strain.size()));
  if (!(*std::max_element(curve.stress.begin(), curve.stress.end()) > 0))
    throw InvalidInput({file}, "no stress is greater than 0: tension counts positive");
  return curve;
}

TensileCurve read_tensile_file(const std::filesystem::path& path, const TensileLayout& layout) {
  return parse_tensile_file(path.string(), read_file(path), layout);
}

}  // namespace softkin
