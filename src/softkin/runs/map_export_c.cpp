#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/runs/map_export_parts.hpp>
#include <softkin/runs/map_export_text.hpp>

namespace softkin::runs {

namespace {

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

constexpr const char* code_name[] = {"map_", "MAP_"};  // stand for the robot's name
constexpr const char* kept_name[] = {
    "m\x01"
    "ap_",
    "M\x01"
    "AP_"};  // do not

/// A text of the user's.
std::string kept(const std::string& text) {
  return replaced(text, {{code_name[0], kept_name[0]}, {code_name[1], kept_name[1]}});
}

/// Inside a comment of C.
std::string commented(const std::string& text) {
  return kept(replaced(on_one_line(text), {{"*/", "* /"}, {"/*", "/ *"}, {"?\?/", "? ?/"}}));
}

/// The lines of tables and what they take.
class CTables {
 public:
  explicit CTables(CNumbers numbers) : floats_(numbers == CNumbers::floats) {}

  /// row: so many belong together, 0: all
  void integers(const char* name, const std::vector<Index>& values, Index row = 0) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const Index bytes = *low < 0 ? (*low >= -128 && *high < 128 ? 1 : 2) : *high < 256 ? 1 : *high < 65536 ? 2 : 4;
    constexpr const char* types[] = {"unsigned char", "unsigned short", "", "unsigned long", "signed char", "short"};
    add(types[bytes - 1 + (*low < 0 ? 4 : 0)], bytes, name, values.size(), row,
        [&](std::size_t i) { return std::to_string(values[i]); });
  }
  void shorts(const char* name, const std::vector<Index>& values, Index row = 0) {
    add("short", 2, name, values.size(), row, [&](std::size_t i) { return std::to_string(values[i]); });
  }
  void reals(const char* name, const double* values, std::size_t count, Index row = 0) {
    add("map_real", floats_ ? 4 : 8, name, count, row, [&](std::size_t i) { return literal(values[i]); });
  }
  void reals(const char* name, const std::vector<double>& values, Index row = 0) {
    reals(name, values.data(), values.size(), row);
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] const std::string& sizes() const { return sizes_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  template <class TextOf>
  void add(const char* type, Index bytes, const char* name, std::size_t count, Index row, const TextOf& text_of) {
    bytes_ += count * static_cast<std::size_t>(bytes);
    sizes_ += (sizes_.empty() ? "" : " + ") + std::string("sizeof(map_") + name + ")";
    text_ += std::string("static const ") + type + " map_" + name + "[" + std::to_string(count) + "] = {";
    std::size_t width = 1000;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string number = text_of(i);
      const bool next = row > 0 && i % static_cast<std::size_t>(row) == 0;
      if (next || width + number.size() > 110) text_ += "\n ", width = 1;
      text_ += " " + number + (i + 1 < count ? "," : "");
      width += number.size() + 2;
    }
    text_ += "};\n";
  }

  [[nodiscard]] std::string literal(double value) const {
    char text[40];
    const auto single = static_cast<float>(value);
    char* const end = text + sizeof text;
    std::string number(text, floats_ ? std::to_chars(text, end, std::abs(single) < 1e-30F ? 0 : single).ptr
                                     : std::to_chars(text, end, value).ptr);
    if (number.find_first_of(".e") == std::string::npos) number += ".0";
    return floats_ ? number + "f" : number;
  }

  bool floats_;
  std::string text_, sizes_;
  std::size_t bytes_ = 0;
};

/// Of the numbers from -1 to 1 over a cell: middle, scale, shift. The shift is what the rounding of the middle left.
std::vector<double> scales_of(const FlatMap& flat, CNumbers numbers) {
  std::vector<double> scales;
  for (const auto& [low, high] : flat.boxes) {
    const double middle = low + (high - low) / 2, scale = high > low ? 2 / (high - low) : 0;
    const double reported = numbers == CNumbers::floats ? static_cast<float>(middle) : middle;
    scales.insert(scales.end(), {reported, scale, scale * ((reported - low) - (high - reported)) / 2});
  }
  return scales;
}

void add_sum_tables(const FlatSums& sums, Index inputs, CTables& tables) {
  tables.integers("cell_degrees", sums.highest, inputs);
  tables.integers("cell_runs", sums.cell_runs);
  tables.integers("cell_terms", sums.cell_terms);
  tables.integers("runs", sums.runs, 8 * inputs);
  tables.reals("coefficients", sums.coefficients, sums.size);
}

void add_tables(const MapData& data, const FlatMap& flat, CNumbers numbers, CTables& tables) {
  const Index inputs = data.inputs.size();
  std::vector<double> low, high, commands, accuracies;
  for (const MapInput& input : data.inputs) {
    low.push_back(input.low);
    high.push_back(input.high);
  }
  tables.reals("low", low);
  tables.reals("high", high);
  std::vector<Index> children, cables;
  for (const auto& [below, above] : flat.node_children) children.insert(children.end(), {below, above});
  for (const MapCable& cable : data.cables) {
    cables.insert(cables.end(), {cable.input, cable.tension, cable.ratio});
    commands.push_back(cable.command);
    for (const Index output : {cable.tension, cable.ratio}) accuracies.push_back(data.outputs[output].accuracy);
  }
  tables.shorts("pieces", flat.pieces);
  tables.integers("variables", flat.variables, inputs);
  tables.shorts("roots", flat.roots);
  tables.shorts("node_inputs", flat.node_inputs);
  tables.reals("node_at", flat.node_at);
  tables.shorts("node_children", children);
  if (!cables.empty()) {
    tables.shorts("cables", cables, 3);
    tables.reals("cable_commands", commands);
    tables.reals("cable_accuracies", accuracies, 2);
  }
  tables.reals("boxes", scales_of(flat, numbers), 3);
  add_sum_tables(flat.outputs, inputs, tables);
}

/// How far an answer may be off: what rounding may do, and a little.
std::vector<double> tolerances_of(const MapAnswers& answers, CNumbers numbers) {
  const double fraction = numbers == CNumbers::floats ? 4e-6 : 1e-12,
               of_slopes = numbers == CNumbers::floats ? 1e-4 : 1e-10;
  std::vector<double> tolerances;
  for (const double scale : answers.output_scale) tolerances.push_back(fraction * scale);
  for (const double scale : answers.slope_scale) tolerances.push_back(of_slopes * scale);
  return tolerances;
}

void add_answers(const MapAnswers& answers, CNumbers numbers, CTables& tables) {
  const auto add = [&](const char* name, const maps::RowMatrix& rows) {
    tables.reals(name, rows.data(), rows.size(), rows.cols());
  };
  add("check_commands", answers.commands);
  add("check_outputs", answers.outputs);
  add("check_slopes", answers.slopes);
  tables.reals("check_tolerances", tolerances_of(answers, numbers), answers.outputs.cols());
}

/// "enum { MAP_IN_AIR = 0, /* kPa, 0 to 30 */ ... };", no name twice.
class CEnum {
 public:
  CEnum(const char* what, std::string text) : text_("\n/* " + std::move(text) + " */\nenum {\n"), what_(what) {}
  void add(const std::string& name, const std::string& comment) {
    std::string word = upper(identifier(name));
    while (!seen_.insert(word).second) word += "_" + std::to_string(count_);
    text_ += std::string(count_ ? ",\n" : "") + "  MAP_" + what_ + "_" + kept(word) + " = " + std::to_string(count_) +
             (comment.empty() ? "" : " /* " + commented(comment) + " */");
    ++count_;
  }
  [[nodiscard]] std::string text() const { return text_ + "\n};\n"; }

 private:
  std::string text_;
  const char* what_;
  std::set<std::string> seen_;
  int count_ = 0;
};

std::string enums(const MapData& data) {
  const auto unit = [](const std::string& text) { return text.empty() ? std::string("a ratio") : text; };
  CEnum inputs("IN", "commands: their places"), outputs("OUT", "outputs"), markers("MARKER", "markers, for map_ik()");
  for (const MapInput& input : data.inputs)
    inputs.add(input.name,
               input.name + ": " + unit(input.unit) + ", " + number(input.low) + " to " + number(input.high));
  for (const MapOutput& output : data.outputs) outputs.add(output.name, output.name + ": " + unit(output.unit));
  const std::vector<std::string> names = marker_names(data);
  for (const std::string& name : names) markers.add(name, name);
  return inputs.text() + outputs.text() + (names.empty() ? "" : markers.text());
}

/// Entries of a table of Chebyshev polynomials.
Index degrees_of(const FlatMap& flat) {
  return std::max<Index>(1, *std::max_element(flat.outputs.highest.begin(), flat.outputs.highest.end())) + 1;
}

std::string definitions(const MapData& data, const FlatMap& flat, const MapAnswers& answers, CNumbers numbers) {
  const bool floats = numbers == CNumbers::floats;
  std::string text = std::string("typedef ") + (floats ? "float" : "double") + " map_real;\n\n";
  const auto define = [&](const char* name, const std::string& value) {
    text += std::string("#define MAP_") + name + " " + value + "\n";
  };
  define("INPUTS", std::to_string(data.inputs.size()));
  define("OUTPUTS", std::to_string(data.outputs.size()));
  define("MARKERS", std::to_string(marker_names(data).size()));
  define("CABLES", std::to_string(data.cables.size()));
  define("DEGREES", std::to_string(degrees_of(flat)));
  define("CHECKS", std::to_string(answers.commands.rows()));
  define("ROUNDING", floats ? "1e-6f" : "1e-12");
  define("SHORTEST", floats ? "1e-5f /* step, over the ranges */" : "1e-7 /* step, over the ranges */");
  define("ARRIVED", floats ? "1e-5f /* square of the last step of map_estimate(), in deviations */"
                           : "1e-6 /* square of the last step of map_estimate(), in deviations */");
  define("NOT_REACHED", "1 /* of map_ik() and map_estimate() */");
  define("OUTSIDE", "2 /* of all of them */");
  text +=
      "#ifndef MAP_REACHED_MM\n#define MAP_REACHED_MM 1e-3 /* as near to its target a marker is there */\n#endif\n"
      "#ifndef MAP_STARTS\n#define MAP_STARTS 4 /* that map_ik() tries, the given one first */\n#endif\n";
  return text + enums(data);
}

/// Bytes of the numbers that functions keep on the stack, and of those that they call.
std::pair<Index, Index> stack_of(const MapData& data, const FlatMap& flat, CNumbers numbers) {
  const Index n = data.inputs.size(), outputs = data.outputs.size();
  const Index bytes = numbers == CNumbers::floats ? 4 : 8;
  const Index fk = 2 * n * degrees_of(flat) + 2 * n + n * outputs, other = 200;  // and counters, registers
  const Index ik = fk + outputs + n * outputs + n * n + 9 * n + 3 * n * 2 + 8;
  const Index estimate = fk + outputs + n * outputs + 4 * n * n + 12 * n + 8;
  return {bytes * fk + other, bytes * std::max(ik, estimate) + 2 * other};
}

std::string head(const MapData& data, const CTables& tables, std::size_t check_bytes, std::pair<Index, Index> stack) {
  std::string text = "/* Where the robot '" + commented(data.name) +
                     "' goes: a map in closed form, exported by softkin " SOFTKIN_VERSION
                     ". C99 and C++; includes nothing.\n\n"
                     "   map_fk()     outputs and their Jacobian at commands\n" +
                     (marker_names(data).empty()
                          ? ""
                          : "   map_ik()     commands that bring a marker to a target\n"
                            "   map_estimate()  commands that were not measured, from outputs that were read\n") +
                     "   map_check()  compares with answers of softkin: call it once\n\n";
  for (const std::string& line : error_lines(data)) text += "   " + commented(line) + "\n";
  text +=
      "   robot's fingerprint: " + commented(data.robot) + "\n\n   Tables: " + std::to_string(tables.bytes()) +
      " bytes of flash, and " + std::to_string(check_bytes) + " where map_check() is called. Stack: about " +
      std::to_string(stack.first) + " bytes in map_fk(), " + std::to_string(stack.second) +
      " in map_ik() and map_estimate(). No heap.\n   Every source file that includes this has tables of its own. */\n";
  return text;
}

}  // namespace

std::string c_name(const MapData& data) {
  std::string name = identifier(data.name);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const bool letter = !name.empty() && name[0] >= 'a';
  return letter ? name : name.empty() ? "robot" : "robot_" + name;
}

std::string map_c_header(const MapData& data, CNumbers numbers) {
  const MapAnswers answers = map_answers(KinematicMap(data), numbers);
  const FlatMap flat = flat_map(data);
  if (flat.node_at.size() > 32767) throw InvalidInput("the map has too many cells for C");
  CTables tables(numbers), checks(numbers);
  add_tables(data, flat, numbers, tables);
  add_answers(answers, numbers, checks);
  const std::string slack =
      data.cables.empty() ? "\n#define map_wrong_cable(taut, circles, commands, outputs) (-1) /* it has no cables */\n"
                          : c_slack;
  const std::string text = head(data, tables, checks.bytes(), stack_of(data, flat, numbers)) +
                           "#ifndef MAP_H\n#define MAP_H\n\n" + definitions(data, flat, answers, numbers) + "\n" +
                           tables.text() + "\n#define MAP_TABLE_BYTES (" + tables.sizes() + ")\n" +
                           replaced(c_evaluation, {{"MAP_SLACK\n", slack}}) +
                           (marker_names(data).empty() ? std::string() : std::string(c_inverse) + c_estimate) + "\n" +
                           checks.text() + c_check + "\n#endif\n";
  return replaced(text, {{code_name[0], kept(c_name(data) + "_")},
                         {code_name[1], kept(upper(c_name(data)) + "_")},
                         {kept_name[0], code_name[0]},
                         {kept_name[1], code_name[1]}});
}

}  // namespace softkin::runs
