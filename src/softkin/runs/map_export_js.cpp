#include <bit>
#include <nlohmann/json.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/base64.hpp>
#include <softkin/runs/map_export_parts.hpp>
#include <softkin/runs/map_export_text.hpp>

namespace softkin::runs {

namespace {

using JsTable = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "arrays of a module are little-endian");

template <class Scalar>
std::string packed(const Scalar* values, std::size_t count) {
  return to_base64({reinterpret_cast<const char*>(values), count * sizeof(Scalar)});
}

JsTable rows_table(const maps::RowMatrix& rows) {
  JsTable table = JsTable::array();
  for (const auto row : rows.rowwise()) table.push_back(std::vector<double>(row.begin(), row.end()));
  return table;
}

JsTable sums_table(const FlatSums& sums) {
  return {{"size", sums.size},       {"highest", sums.highest},
          {"cells", sums.cell_runs}, {"terms", sums.cell_terms},
          {"runs", sums.runs},       {"coefficients", packed(sums.coefficients.data(), sums.coefficients.size())}};
}

/// Values in rows of so many.
template <class Values>
JsTable in_rows(const Values& values, std::size_t size) {
  JsTable table = JsTable::array();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i % size == 0) table.push_back(JsTable::array());
    table.back().push_back(values[i]);
  }
  return table;
}

JsTable map_tables(const MapData& data) {
  const FlatMap flat = flat_map(data);
  JsTable nodes = JsTable::array(), cables = JsTable::array();
  for (std::size_t n = 0; n < flat.node_at.size(); ++n) {
    const auto& [below, above] = flat.node_children[n];
    nodes.push_back(flat.node_inputs[n] < 0 ? JsTable{below}
                                            : JsTable{flat.node_inputs[n], flat.node_at[n], below, above});
  }
  for (const MapCable& cable : data.cables)
    cables.push_back(
        {{"input", cable.input}, {"command", cable.command}, {"tension", cable.tension}, {"ratio", cable.ratio}});
  return {{"pieces", flat.pieces},
          {"variables", in_rows(flat.variables, data.inputs.size())},
          {"roots", flat.roots},
          {"nodes", nodes},
          {"cables", cables},
          {"boxes", in_rows(flat.boxes, data.inputs.size())},
          {"outputs", sums_table(flat.outputs)},
          {"modes", sums_table(flat.modes)}};
}

JsTable inputs_table(const MapData& data) {
  JsTable table = JsTable::array();
  for (const MapInput& input : data.inputs)
    table.push_back({{"name", input.name}, {"unit", input.unit}, {"low", input.low}, {"high", input.high}});
  return table;
}

JsTable outputs_table(const MapData& data) {
  JsTable table = JsTable::array();
  for (std::size_t q = 0; q < data.outputs.size(); ++q) {
    const auto at = static_cast<Index>(q);
    table.push_back({{"name", data.outputs[q].name},
                     {"unit", data.outputs[q].unit},
                     {"accuracy", data.outputs[q].accuracy},
                     {"largestError", data.check.largest[at]},
                     {"meanError", data.check.mean[at]}});
  }
  return table;
}

JsTable checked_table(const MapData& data) {
  JsTable table{{"points", data.check.points}, {"outside", data.check.outside}, {"equilibria", data.equilibria}};
  if (data.shape) {
    table["shapeLargestErrorMm"] = data.check.shape_largest_mm;
    table["shapeMeanErrorMm"] = data.check.shape_mean_mm;
  }
  return table;
}

JsTable answers_table(const MapData& data) {
  const MapAnswers answers = map_answers(KinematicMap(data), CNumbers::doubles);
  return {{"commands", rows_table(answers.commands)},
          {"outputs", rows_table(answers.outputs)},
          {"slopes", rows_table(answers.slopes)},
          {"outputScale", std::vector<double>(answers.output_scale.begin(), answers.output_scale.end())},
          {"slopeScale", std::vector<double>(answers.slope_scale.begin(), answers.slope_scale.end())}};
}

JsTable shape_table(const MapShape& shape) {
  return {{"mean", packed(shape.mean.data(), static_cast<std::size_t>(shape.mean.size()))},
          {"units", std::vector<double>(shape.units.begin(), shape.units.end())},
          {"modes", packed(shape.modes.data(), static_cast<std::size_t>(shape.modes.size()))}};
}

/// Text that is no UTF-8 is replaced.
std::string js_text(const JsTable& table) {
  return table.dump(-1, ' ', false, JsTable::error_handler_t::replace);
}

/// On one line, as JavaScript counts lines.
std::string js_comment(const std::string& text) {
  return replaced(on_one_line(text), {{"\xe2\x80\xa8", " "}, {"\xe2\x80\xa9", " "}});
}

std::string constant(const char* type, const char* name, const char* comment, const JsTable& table) {
  return std::string("\n/** ") + comment + "\n    @type {" + type + "} */\nexport const " + name + " = " +
         js_text(table) + ";\n";
}

struct JsConstant {
  const char *name, *type, *comment;
};

constexpr JsConstant js_constants[] = {
    {"name", "string", "Of the robot."},
    {"fingerprint", "string", "Of the robot's model."},
    {"inputs", "{name: string, unit: string, low: number, high: number}[]",
     "Commands: their units ('' : a ratio) and ranges."},
    {"outputs", "{name: string, unit: string, accuracy: number, largestError: number, meanError: number}[]",
     "What it gives, with the errors that were found where it was checked: not a bound."},
    {"markers", "string[]", "Outputs 3 i, 3 i + 1 and 3 i + 2 are where the i-th is."},
    {"checked",
     "{points: number, outside: number, equilibria: number, shapeLargestErrorMm?: number, shapeMeanErrorMm?: number}",
     "Actuations at which the map was compared with the finite-element robot, and how many it was made of."}};

}  // namespace

std::string map_js_module(const MapData& data) {
  const JsTable values[] = {data.name,           data.robot,         inputs_table(data),
                            outputs_table(data), marker_names(data), checked_table(data)};
  std::string text = "// Where a robot goes: a map in closed form, exported by softkin " SOFTKIN_VERSION ".\n";
  for (const std::string& line : error_lines(data)) text += "// " + js_comment(line) + "\n";
  for (std::size_t i = 0; i < std::size(js_constants); ++i)
    text += constant(js_constants[i].type, js_constants[i].name, js_constants[i].comment, values[i]);
  text += "\nconst tables = " + js_text(map_tables(data)) + ";\n";
  if (data.shape) text += "\nconst shapeTables = " + js_text(shape_table(*data.shape)) + ";\n";
  text += js_evaluation;
  if (data.shape) text += js_shape;
  text += js_inverse;
  return text + "\nconst answers = " + js_text(answers_table(data)) + ";\n" + js_check;
}

std::string map_js_types(const MapData& data) {
  std::string text = "// Types of a map exported by softkin " SOFTKIN_VERSION ".\n";
  for (const JsConstant& told : js_constants)
    text += std::string("\n/** ") + told.comment + " */\nexport const " + told.name + ": " + told.type + ";\n";
  text += js_types;
  if (data.shape)
    text +=
        "\n/** Of the robot's mesh. */\nexport const vertices: number;\n"
        "\n/** x, y, z of each vertex [mm]. Null: the commands are outside the map. */\n"
        "export function shape(commands: ArrayLike<number>): Float32Array | null;\n";
  return text;
}

}  // namespace softkin::runs
