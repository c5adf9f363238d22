#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>
#include <softkin/runs/map_export_parts.hpp>

namespace softkin::runs {

namespace {

/// The sums of a cell, of a piece with other variables before its own.
void add_sums(const maps::Polynomials& sums, Index before, FlatSums& flat) {
  const maps::Terms& terms = sums.terms();
  const Index own = terms.cols(), inputs = before + own;
  flat.highest.resize(flat.highest.size() + static_cast<std::size_t>(inputs), 0);
  Index* highest = flat.highest.data() + std::ssize(flat.highest) - own;
  for (Index t = 0; t < terms.rows(); ++t) {
    for (Index j = 0; j < own; ++j) highest[j] = std::max<Index>(highest[j], terms(t, j));
    if (own == 0 || terms(t, own - 1) == 0) {
      flat.runs.insert(flat.runs.end(), own == 0 ? inputs - 1 : before, 0);
      for (Index j = 0; j + 1 < own; ++j) flat.runs.push_back(terms(t, j));
      flat.runs.push_back(0);
    }
    ++flat.runs.back();
  }
  const maps::RowMatrix& coefficients = sums.coefficients();
  flat.coefficients.insert(flat.coefficients.end(), coefficients.data(), coefficients.data() + coefficients.size());
  flat.cell_runs.push_back(static_cast<Index>(flat.runs.size()) / inputs);
  flat.cell_terms.push_back(flat.cell_terms.back() + terms.rows());
}

void add_tree(const MapPiece& piece, Index first_cell, FlatMap& flat) {
  const Index root = flat.node_at.size();
  flat.roots.push_back(root);
  for (const MapNode& node : piece.tree) {
    const bool leaf = node.variable < 0;
    flat.node_inputs.push_back(leaf ? -1 : piece.inputs[node.variable]);
    flat.node_at.push_back(leaf ? 0 : node.at);
    flat.node_children.push_back(leaf ? std::pair<Index, Index>(node.cell < 0 ? -1 : first_cell + node.cell, 0)
                                      : std::pair(root + node.first, root + node.second));
  }
}

void add_piece(const MapData& data, const MapPiece& piece, FlatMap& flat) {
  const Index inputs = data.inputs.size(), own = piece.inputs.size();
  for (Index i = 0; i < inputs; ++i)
    if (std::find(piece.inputs.begin(), piece.inputs.end(), i) == piece.inputs.end()) flat.variables.push_back(i);
  flat.variables.insert(flat.variables.end(), piece.inputs.begin(), piece.inputs.end());
  add_tree(piece, std::ssize(flat.outputs.cell_terms) - 1, flat);
  for (const MapCell& cell : piece.cells) {
    flat.boxes.insert(flat.boxes.end(), inputs - own, {0, 0});
    for (Index j = 0; j < own; ++j) flat.boxes.emplace_back(cell.low[j], cell.high[j]);
    add_sums(cell.outputs, inputs - own, flat.outputs);
    if (data.shape) add_sums(cell.modes, inputs - own, flat.modes);
  }
}

double rounded(double value, CNumbers numbers) {
  return numbers == CNumbers::floats ? static_cast<float>(value) : value;
}

/// Does the map answer by one sum around the commands? Rounding may choose another at an edge.
bool is_inside(const KinematicMap& map, const Eigen::VectorXd& commands, const KinematicMap::Place& place) {
  constexpr double fraction = 1e-4;  // of the ranges
  Eigen::VectorXd values(map.outputs());
  for (const double side : {-fraction, fraction}) {
    Eigen::VectorXd beside = commands;
    for (Index i = 0; i < map.inputs(); ++i) {
      const MapInput& input = map.data().inputs[i];
      beside[i] += side * (input.high - input.low);
    }
    const auto found = map.evaluate(beside.data(), values.data());
    if (!found || found->piece != place.piece || found->cell != place.cell) return false;
  }
  return true;
}

}  // namespace

FlatMap flat_map(const MapData& data) {
  FlatMap flat;
  flat.outputs.size = data.outputs.size();
  if (data.shape) flat.modes.size = data.shape->units.size();
  for (FlatSums* sums : {&flat.outputs, &flat.modes}) sums->cell_runs = sums->cell_terms = {0};
  flat.pieces.assign(std::size_t{1} << data.cables.size(), -1);
  for (std::size_t p = 0; p < data.pieces.size(); ++p) {
    flat.pieces[maps::bits_of(data.pieces[p].taut)] = p;
    add_piece(data, data.pieces[p], flat);
  }
  return flat;
}

std::vector<std::string> marker_names(const MapData& data) {
  std::vector<std::string> names;
  for (std::size_t q = 0; q + 2 < data.outputs.size(); q += 3) {
    const std::string& first = data.outputs[q].name;
    const std::string name = first.substr(0, first.size() < 2 ? 0 : first.size() - 2);
    for (std::size_t k = 0; k < 3; ++k)
      if (data.outputs[q + k].name != name + "_" + axis_names[k] || data.outputs[q + k].unit != "mm") return names;
    names.push_back(name);
  }
  return names;
}

MapAnswers map_answers(const KinematicMap& map, CNumbers numbers) {
  constexpr Index wanted = 16, tries = 200 * wanted;
  constexpr std::uint64_t seed = 7;
  const Index inputs = map.inputs(), outputs = map.outputs();
  MapAnswers answers{maps::random_commands(map.data(), tries, seed),
                     maps::RowMatrix(wanted, outputs),
                     maps::RowMatrix(wanted, outputs),
                     {},
                     {}};
  Index found = 0;
  Eigen::VectorXd values(outputs);
  maps::RowMatrix slopes(inputs, outputs);
  for (Index n = 0; n < tries && found < wanted; ++n) {
    Eigen::VectorXd commands = answers.commands.row(n).unaryExpr([&](double c) { return rounded(c, numbers); });
    const auto place = map.evaluate(commands.data(), values.data(), slopes.data());
    if (!place || !is_inside(map, commands, *place)) continue;
    answers.commands.row(found) = commands;
    answers.outputs.row(found) = values;
    answers.slopes.row(found).setZero();
    for (Index i = 0; i < inputs; ++i) {
      const MapInput& input = map.data().inputs[i];
      answers.slopes.row(found) += static_cast<double>(i + 1) * (input.high - input.low) * slopes.row(i);
    }
    ++found;
  }
  if (found == 0) throw InvalidInput("the map has no answer at " + std::to_string(tries) + " random commands");
  for (maps::RowMatrix* rows : {&answers.commands, &answers.outputs, &answers.slopes})
    rows->conservativeResize(found, Eigen::NoChange);
  answers.output_scale = answers.outputs.cwiseAbs().colwise().maxCoeff().cwiseMax(1e-6);
  answers.slope_scale = answers.slopes.cwiseAbs().colwise().maxCoeff().cwiseMax(1e-6);
  return answers;
}

std::vector<std::string> error_lines(const MapData& data) {
  const MapCheck& check = data.check;
  const auto error = [](double largest, double mean, const std::string& unit) {
    return "within " + number(largest, 2) + (unit.empty() ? "" : " " + unit) + ", on average " + number(mean, 2);
  };
  const std::string made = "made of " +
                           counted(static_cast<std::size_t>(data.equilibria), "equilibrium", "equilibria") +
                           " of the finite-element robot; ";
  if (check.points == 0)
    return {made + "not checked, so its errors are unknown: none of " + std::to_string(check.outside) +
            " random actuations is inside the map and has an equilibrium"};
  std::vector<std::string> lines{made + "checked at " + counted(static_cast<std::size_t>(check.points), "point") +
                                 " that it was not made of (not a bound):"};
  for (std::size_t q = 0; q < data.outputs.size(); ++q)
    lines.push_back("  " + data.outputs[q].name + " " + error(check.largest[q], check.mean[q], data.outputs[q].unit));
  if (data.shape) lines.push_back("  every vertex " + error(check.shape_largest_mm, check.shape_mean_mm, "mm"));
  if (check.outside > 0)
    lines.push_back("  of " + std::to_string(check.points + check.outside) + " random actuations " +
                    std::to_string(check.outside) + " are outside the map or have no equilibrium");
  return lines;
}

std::string identifier(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (plain || (!name.empty() && name.back() != '_')) name += plain ? c : '_';
  }
  if (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

std::string replaced(std::string text, const std::vector<std::pair<std::string, std::string>>& by) {
  for (const auto& [from, to] : by)
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  return text;
}

}  // namespace softkin::runs
