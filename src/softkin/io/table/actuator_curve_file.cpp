#include <cmath>
#include <softkin/core/text.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/io/table/actuator_curve_file.hpp>
#include <sstream>
#include <utility>

namespace softkin {

namespace {

using namespace scene;

constexpr const char* input_names[] = {"gauge_pressure_kPa", "voltage_kV"};

CurveBranch read_branch(const Node& node, CurveInput input) {
  std::vector<double> x, y, spread;
  for (const auto& item : list(node)) {
    const auto& cells = list(*item);
    if (cells.size() != 2 && cells.size() != 3)
      fail(*item, item->name + " must be [" + input_names[static_cast<int>(input)] +
                      ", ratio] or the same with the ratio's standard deviation");
    x.push_back(number(*cells[0]));
    y.push_back(positive(*cells[1]));
    if (cells.size() == 3) spread.push_back(number(*cells[2]));
    if (cells.size() == 3 && spread.back() < 0) fail(*cells[2], "a standard deviation must not be negative");
    if (spread.size() != x.size() && !spread.empty())
      fail(*item, "either every point of " + node.name + " has a standard deviation, or none has");
    if (x.size() > 1 && !(x[x.size() - 1] > x[x.size() - 2] && y[y.size() - 1] > y[y.size() - 2]))
      fail(*item, item->name + ": inputs and ratios must ascend from point to point");
  }
  try {
    return {MonotoneCurve(std::move(x), std::move(y)), std::move(spread)};
  } catch (const InvalidInput& error) {
    fail(node, node.name + ": " + error.what());
  }
}

std::string branch_text(const char* name, const CurveBranch& branch) {
  std::string text = std::string(name) + ":\n";
  for (std::size_t i = 0; i < branch.ratio.x().size(); ++i) {
    text += "  - [" + exact(branch.ratio.x()[i]) + ", " + exact(branch.ratio.y()[i]);
    if (!branch.spread.empty()) text += ", " + exact(branch.spread[i]);
    text += "]\n";
  }
  return text;
}

}  // namespace

ActuatorCurve read_actuator_curve(const std::filesystem::path& path) {
  const auto root = parse_yaml(read_file(path), path.string());
  const std::string begin = "a curve file is a map that begins with 'softkin_curve: 1'";
  check_version(*root, "softkin_curve", "curves", begin, begin);
  const Map map(*root, {"softkin_curve", "input", "atmosphere_kPa", "end", "loading", "unloading"});
  const auto input = static_cast<CurveInput>(choice(map.at("input"), {input_names[0], input_names[1]}));
  ActuatorCurve curve{path.string(), input, 100, "", read_branch(map.at("loading"), input), std::nullopt};
  if (const Node* node = map.find("atmosphere_kPa")) {
    if (input != CurveInput::pressure) fail(*node, node->name + " belongs to curves of pressures");
    curve.atmosphere_kPa = positive(*node);
  }
  if (const Node* node = map.find("end")) curve.end = text(*node);
  if (const Node* node = map.find("unloading")) curve.unloading = read_branch(*node, input);
  return curve;
}

std::string actuator_curve_text(const ActuatorCurve& curve, const std::string& comments) {
  std::istringstream lines(comments);
  std::string text = "softkin_curve: 1\n";
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  text += std::string("input: ") + input_names[static_cast<int>(curve.input)] + "\n";
  if (curve.input == CurveInput::pressure)
    text += "atmosphere_kPa: " + exact(curve.atmosphere_kPa) + "   # absolute, under the gauge pressures\n";
  if (!curve.end.empty()) text += "end: " + curve.end + "\n";
  const bool spread = !curve.loading.spread.empty();
  text += std::string("# points: [") + input_names[static_cast<int>(curve.input)] + ", ratio to that without input" +
          (spread ? ", its standard deviation between repeated runs" : "") + "]\n";
  text += branch_text("loading", curve.loading);
  if (curve.unloading) text += branch_text("unloading", *curve.unloading);
  return text;
}

}  // namespace softkin
