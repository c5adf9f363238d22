#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/runs/map_export_parts.hpp>
#include <softkin/runs/map_export_text.hpp>
#include <softkin/runs/map_tables.hpp>
#include <softkin/runs/page.hpp>

namespace softkin::runs {

namespace {

Json rows_table(const maps::RowMatrix& rows) {
  Json table = Json::array();
  for (const auto row : rows.rowwise()) table.push_back(std::vector<double>(row.begin(), row.end()));
  return table;
}

Json answers_table(const MapData& data) {
  const MapAnswers answers = map_answers(KinematicMap(data), CNumbers::doubles);
  return {{"commands", rows_table(answers.commands)},
          {"outputs", rows_table(answers.outputs)},
          {"slopes", rows_table(answers.slopes)},
          {"outputScale", std::vector<double>(answers.output_scale.begin(), answers.output_scale.end())},
          {"slopeScale", std::vector<double>(answers.slope_scale.begin(), answers.slope_scale.end())}};
}

/// Text that is no UTF-8 is replaced.
std::string js_text(const Json& table) {
  return table.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// On one line, as JavaScript counts lines.
std::string js_comment(const std::string& text) {
  return replaced(on_one_line(text), {{"\xe2\x80\xa8", " "}, {"\xe2\x80\xa9", " "}});
}

std::string constant(const char* type, const char* name, const char* comment, const Json& table) {
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

constexpr const char* js_types = R"TS(
/** Outputs, and by how much each changes per command: jacobian[output][input].
    Null: the commands are outside the map. */
export function fk(commands: ArrayLike<number>): {outputs: number[]; jacobian: number[][]} | null;

/** Commands that bring a marker to a target [mm], near those from which it starts (left out: the middles of the
    ranges); where they do not get there, others are tried. Null: it starts outside the map. */
export function ik(marker: number | string, target: ArrayLike<number>, start?: ArrayLike<number>,
                   options?: {reachedMm?: number; starts?: number}):
    {reached: boolean; commands: number[]; errorMm: number} | null;

/** Compares with answers of softkin: '' where all are the same, else what is not. */
export function check(): string;
)TS";

}  // namespace

std::string_view js_script() {
  if (embedded_map_script().empty()) throw InvalidInput(std::string("no module for JavaScript: ") + no_page);
  return embedded_map_script();
}

std::string map_js_module(const MapData& data) {
  const std::string_view script = js_script();
  const Json values[] = {data.name,           data.robot,         inputs_table(data),
                         outputs_table(data), marker_names(data), checked_table(data)};
  std::string text = "// Where a robot goes: a map in closed form, exported by softkin " SOFTKIN_VERSION ".\n";
  for (const std::string& line : error_lines(data)) text += "// " + js_comment(line) + "\n";
  for (std::size_t i = 0; i < std::size(js_constants); ++i)
    text += constant(js_constants[i].type, js_constants[i].name, js_constants[i].comment, values[i]);
  text += "\nconst tables = " + js_text(map_tables(data)) + ";\n";
  if (data.shape) text += "\nconst shapeTables = " + js_text(shape_table(*data.shape)) + ";\n";
  text += "\nconst answers = " + js_text(answers_table(data)) + ";\n\n";
  text += script;
  const bool shaped = data.shape.has_value();
  return text + "\nconst map = softkinMap.exported({name, inputs, outputs, markers, checked, tables" +
         (shaped ? ", shapeTables" : "") + "}, answers);\nexport const {fk, ik, check" +
         (shaped ? ", shape, vertices" : "") + "} = map;\n";
}

std::string map_js_types(const MapData& data) {
  std::string text = "// Types of a map exported by softkin " SOFTKIN_VERSION ".\n";
  for (const JsConstant& reported : js_constants)
    text +=
        std::string("\n/** ") + reported.comment + " */\nexport const " + reported.name + ": " + reported.type + ";\n";
  text += js_types;
  if (data.shape)
    text +=
        "\n/** Of the robot's mesh. */\nexport const vertices: number;\n"
        "\n/** x, y, z of each vertex [mm]. Null: the commands are outside the map. */\n"
        "export function shape(commands: ArrayLike<number>): Float32Array | null;\n";
  return text;
}

}  // namespace softkin::runs
