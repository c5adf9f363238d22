#include <algorithm>
#include <array>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/map.hpp>
#include <utility>

namespace softkin {

namespace {

constexpr std::size_t max_cables = 12;

void check(bool fits, const char* what) {
  if (!fits) throw InvalidInput(std::string("the map is broken: ") + what);
}

void check_cell(const MapData& data, const MapPiece& piece, const MapCell& cell) {
  const Index variables = piece.inputs.size();
  check(cell.low.size() == variables && cell.high.size() == variables && (cell.low.array() < cell.high.array()).all(),
        "a cell has no box");
  check(cell.outputs.variables() == variables && cell.outputs.count() == std::ssize(data.outputs),
        "a cell has other outputs");
  const Index modes = data.shape ? static_cast<Index>(data.shape->units.size()) : 0;
  check(cell.modes.count() == modes && (modes == 0 || cell.modes.variables() == variables),
        "a cell has other modes of the shape");
}

void check_tree(const MapPiece& piece) {
  check(!piece.tree.empty(), "a piece has no cells");
  const Index nodes = piece.tree.size();
  for (Index n = 0; n < nodes; ++n) {
    const MapNode& node = piece.tree[n];
    if (node.variable < 0) {
      check(node.cell >= -1 && node.cell < std::ssize(piece.cells), "a cell is missing");
      continue;
    }
    check(node.variable < static_cast<int>(piece.inputs.size()), "a cell is divided along nothing");
    for (const Index below : {node.first, node.second}) check(below > n && below < nodes, "a cell is missing");
  }
}

using Scaled = std::array<double, maps::max_variables>;

/// Commands of a piece over the box of a cell, from -1 to 1.
Scaled scaled(const MapPiece& piece, const MapCell& cell, const double* commands) {
  Scaled x{};
  for (std::size_t j = 0; j < piece.inputs.size(); ++j) {
    const Index at = j;
    x[j] = (2 * commands[piece.inputs[j]] - cell.low[at] - cell.high[at]) / (cell.high[at] - cell.low[at]);
  }
  return x;
}

}  // namespace

KinematicMap::KinematicMap(MapData data) : data_(std::move(data)) {
  const std::size_t cables = data_.cables.size();
  const auto in_range = [](Index i, std::size_t size) { return i >= 0 && i < static_cast<Index>(size); };
  check(cables <= max_cables, "it has too many cables");
  check(data_.inputs.size() <= maps::max_variables, "it has too many inputs");
  for (const MapCable& cable : data_.cables) {
    check(cable.input == -1 || in_range(cable.input, data_.inputs.size()), "a cable has another input");
    check(in_range(cable.tension, data_.outputs.size()) && in_range(cable.ratio, data_.outputs.size()),
          "a cable has no outputs");
  }
  if (data_.shape)
    check(data_.shape->mean.size() == data_.shape->modes.rows() && data_.shape->mean.size() % 3 == 0 &&
              data_.shape->modes.cols() == data_.shape->units.size(),
          "its shape has other modes");
  for (const MapInput& input : data_.inputs)
    check(in_range(input.actuator, data_.actuation.size()) && input.low < input.high, "an input has no range");
  pieces_.assign(std::size_t{1} << cables, -1);
  for (std::size_t p = 0; p < data_.pieces.size(); ++p) {
    const MapPiece& piece = data_.pieces[p];
    check(piece.taut.size() == cables, "a piece has other cables");
    for (const Index input : piece.inputs) check(in_range(input, data_.inputs.size()), "a piece has another input");
    check_tree(piece);
    for (const MapCell& cell : piece.cells) check_cell(data_, piece, cell);
    pieces_[maps::bits_of(piece.taut)] = p;
  }
}

Index KinematicMap::cell_of(const MapPiece& piece, const double* commands) const {
  const MapNode* node = piece.tree.data();
  while (node->variable >= 0) {
    const double command = commands[piece.inputs[node->variable]];
    node = piece.tree.data() + (command < node->at ? node->first : node->second);
  }
  return node->cell;
}

void KinematicMap::evaluate(const MapPiece& piece, const MapCell& cell, const double* commands, double* values,
                            double* slopes) const {
  const Scaled x = scaled(piece, cell, commands);
  const std::size_t variables = piece.inputs.size();
  if (!slopes) return cell.outputs.evaluate(x.data(), values);
  // the piece's rows first, then to where they belong, from the last on: inputs ascend
  const Index size = outputs();
  cell.outputs.evaluate(x.data(), values, slopes);
  for (Index input = inputs(), j = variables; input-- > 0;) {
    double* row = slopes + input * size;
    if (j == 0 || piece.inputs[j - 1] != input) {
      std::fill_n(row, size, 0.0);
      continue;
    }
    --j;
    const double scale = 2 / (cell.high[j] - cell.low[j]);
    const double* found = slopes + j * size;
    for (Index q = 0; q < size; ++q) row[q] = scale * found[q];
  }
}

KinematicMap::Place KinematicMap::evaluate_bits(Index taut, const double* commands, double* values,
                                                double* slopes) const {
  Place place{pieces_[taut], -1};
  if (place.piece < 0) return place;
  const MapPiece& piece = data_.pieces[place.piece];
  place.cell = cell_of(piece, commands);
  if (place.cell >= 0) evaluate(piece, piece.cells[place.cell], commands, values, slopes);
  return place;
}

/// With all cables taut at first: one that would push goes slack, one that is longer than it may be is taken up. Pieces
/// are approximate: where that goes round in circles, or to a piece that there is not (at rest, where no command goes
/// farther), less than their accuracy is not wrong.
///
/// taut     the bits of the last that were
/// returns  the piece is -1 where there is none of these, the cell where it has none there
KinematicMap::Place KinematicMap::find(const double* commands, double* values, double* slopes, Index& taut) const {
  const std::size_t cables = data_.cables.size();
  taut = (Index{1} << cables) - 1;
  Place place;
  for (std::size_t change = 0; change <= 4 * cables; ++change) {
    place = evaluate_bits(taut, commands, values, slopes);
    if (place.cell < 0) return place;
    const bool circles = change >= 2 * cables;
    std::size_t wrong = cables;
    double worst = 0;
    bool pushes = false;
    for (std::size_t c = 0; c < cables; ++c) {
      const MapCable& cable = data_.cables[c];
      const bool holds = (taut >> c) & 1;
      const double command = cable.input < 0 ? cable.command : commands[cable.input];
      const bool ends = pieces_[taut ^ (Index{1} << c)] < 0;
      const double by = (holds ? -values[cable.tension] : values[cable.ratio] - command * (1 + 1e-12)) -
                        (circles || ends ? data_.outputs[holds ? cable.tension : cable.ratio].accuracy : 0);
      // pushing ones first: those that are too long may then be so no more
      if (!(by > 0) || (pushes && !holds) || (pushes == holds && by <= worst)) continue;
      wrong = c;
      worst = by;
      pushes = holds;
    }
    if (wrong == cables) return place;
    taut ^= Index{1} << wrong;
  }
  place.cell = -1;
  return place;
}

std::optional<KinematicMap::Place> KinematicMap::evaluate(const double* commands, double* values,
                                                          double* slopes) const {
  for (Index i = 0; i < inputs(); ++i) {
    const MapInput& input = data_.inputs[i];
    if (!(commands[i] >= input.low && commands[i] <= input.high)) return std::nullopt;
  }
  Index taut = 0;
  const Place place = find(commands, values, slopes, taut);
  return place.cell < 0 ? std::nullopt : std::optional(place);
}

std::optional<KinematicMap::Place> KinematicMap::evaluate_taut(const std::vector<bool>& taut, const double* commands,
                                                               double* values, double* slopes) const {
  const Place place = evaluate_bits(maps::bits_of(taut), commands, values, slopes);
  return place.cell < 0 ? std::nullopt : std::optional(place);
}

std::optional<std::vector<bool>> KinematicMap::missing_piece(const double* commands, double* values) const {
  Index taut = 0;
  if (find(commands, values, nullptr, taut).piece >= 0) return std::nullopt;
  std::vector<bool> requested(data_.cables.size());
  for (std::size_t c = 0; c < requested.size(); ++c) requested[c] = (taut >> c) & 1;
  return requested;
}

namespace {

Points rows_of(const Eigen::VectorXf& values) {
  return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(values.data(), values.size() / 3, 3)
      .cast<double>();
}

}  // namespace

Points KinematicMap::sum_of_modes(const Eigen::VectorXd& amplitudes) const {
  const MapShape& shape = *data_.shape;
  Eigen::VectorXf sum = Eigen::VectorXf::Zero(shape.mean.size());
  for (Index m = 0; m < amplitudes.size(); ++m)
    sum += static_cast<float>(shape.units[m] * amplitudes[m]) * shape.modes.col(m).cast<float>();
  return rows_of(sum);
}

Points KinematicMap::shape(const double* commands, const Place& place) const {
  if (!data_.shape) throw InvalidInput("the map was made without the robot's shape");
  const MapPiece& piece = data_.pieces[place.piece];
  const MapCell& cell = piece.cells[place.cell];
  Eigen::VectorXd amplitudes(data_.shape->units.size());
  cell.modes.evaluate(scaled(piece, cell, commands).data(), amplitudes.data());
  return rows_of(data_.shape->mean) + sum_of_modes(amplitudes);
}

std::vector<Points> KinematicMap::shape_slopes(const double* commands, const Place& place) const {
  if (!data_.shape) throw InvalidInput("the map was made without the robot's shape");
  const MapPiece& piece = data_.pieces[place.piece];
  const MapCell& cell = piece.cells[place.cell];
  Eigen::VectorXd amplitudes(data_.shape->units.size());
  maps::RowMatrix slopes(piece.inputs.size(), amplitudes.size());
  cell.modes.evaluate(scaled(piece, cell, commands).data(), amplitudes.data(), slopes.data());
  std::vector<Points> all(data_.inputs.size(), Points::Zero(data_.shape->mean.size() / 3, 3));
  for (Index j = 0; j < slopes.rows(); ++j)
    all[piece.inputs[j]] = sum_of_modes(2 / (cell.high[j] - cell.low[j]) * slopes.row(j).transpose());
  return all;
}

Eigen::VectorXd KinematicMap::commands(const Actuation& actuation) const {
  if (actuation.size() != data_.actuation.size())
    throw InvalidInput("the map is of a robot with " + std::to_string(data_.actuation.size()) + " actuators, not " +
                       std::to_string(actuation.size()));
  Eigen::VectorXd commands(inputs());
  Actuation others = actuation;
  for (Index i = 0; i < inputs(); ++i) {
    const Index actuator = data_.inputs[i].actuator;
    commands[i] = actuation[actuator];
    others[actuator] = data_.actuation[actuator];
  }
  for (Index a = 0; a < others.size(); ++a)
    if (others[a] != data_.actuation[a])
      throw InvalidInput("the map knows the robot with command " + std::to_string(a + 1) + " at " +
                         number(data_.actuation[a]) + " alone, not at " + number(others[a]));
  return commands;
}

}  // namespace softkin
