#pragma once

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <numbers>
#include <random>
#include <softkin/kinematics/map.hpp>

/// Maps of made-up robots that are known in closed form.

namespace softkin::runs::testing {

using Function = std::function<Eigen::VectorXd(const Eigen::VectorXd& commands)>;

/// Returns the polynomial of `count` terms that is nearest to a function of commands inside a box.
inline maps::Polynomials fitted(const Eigen::VectorXd& low, const Eigen::VectorXd& high, Index count,
                                const Function& function) {
  const Index d = low.size();
  const maps::Terms terms = maps::min_terms(Eigen::VectorXd::Ones(d), d == 0 ? 1 : count);
  const Index points = 3 * terms.rows();
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> angle(0, std::numbers::pi);
  Eigen::MatrixXd known(points, terms.rows()), wanted;
  for (Index n = 0; n < points; ++n) {
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(d, [&] { return std::cos(angle(generator)); });
    Eigen::VectorXd values;
    maps::evaluate_terms(terms, x, values, nullptr);
    known.row(n) = values;
    const Eigen::VectorXd found = function(low + ((x.array() + 1) / 2 * (high - low).array()).matrix());
    wanted.conservativeResize(points, found.size());
    wanted.row(n) = found;
  }
  return {terms, maps::RowMatrix(known.householderQr().solve(wanted))};
}

inline MapCell fitted_cell(const Eigen::VectorXd& low, const Eigen::VectorXd& high, Index count,
                           const Function& function, const Function& modes = {}) {
  return {low, high, fitted(low, high, count, function), modes ? fitted(low, high, count, modes) : maps::Polynomials()};
}

inline MapData outline(const std::string& name, const std::vector<MapInput>& inputs,
                       const std::vector<std::string>& others = {}) {
  MapData data;
  data.robot = "0123456789abcdef";
  data.name = name;
  data.actuation = Actuation::Zero(inputs.size());
  data.inputs = inputs;
  for (const char* axis : {"tip_x", "tip_y", "tip_z"}) data.outputs.push_back({axis, "mm", 0.01});
  for (const std::string& output : others) data.outputs.push_back({output, "kPa", 0.1});
  const Index outputs = data.outputs.size();
  data.check = {200,  0,   1, Eigen::VectorXd::Constant(outputs, 1e-4), Eigen::VectorXd::Constant(outputs, 1e-5),
                0.01, 1e-3};
  data.equilibria = 64;
  return data;
}

inline Eigen::VectorXd limits(const MapData& data, const std::vector<Index>& inputs, double MapInput::*which) {
  return Eigen::VectorXd::NullaryExpr(inputs.size(), [&](Index j) { return data.inputs[inputs[j]].*which; });
}

/// An arm of constant curvature that three chambers bend: 6 outputs.
inline Eigen::VectorXd arm(const Eigen::VectorXd& p) {
  Eigen::Vector2d bend(0, 0);
  for (int i = 0; i < 3; ++i) bend += 0.025 * p[i] * Eigen::Vector2d(std::cos(2.0944 * i), std::sin(2.0944 * i));
  const double length = 100 + 0.3 * p.sum(), angle = bend.squaredNorm();
  // (1 - cos) / angle and sin / angle, of the square of the angle
  double out = 0, along = 0, term = 1;
  for (int k = 0; k < 12; ++k) {
    along += term / (2 * k + 1);
    out += term / ((2 * k + 1) * (2 * k + 2));
    term *= -angle / ((2 * k + 1) * (2 * k + 2));
  }
  Eigen::VectorXd values(6);
  values << length * out * bend, length * along, 3 + p[0] * p[0] / 30, p[1] + 0.1 * p[2], std::exp(p[2] / 40);
  return values;
}

inline MapData arm_map(Index terms = 115) {
  MapData data = outline("Three-chamber arm", {{"a", "kPa", 0, 0, 30}, {"b", "kPa", 1, 0, 30}, {"c", "kPa", 2, 0, 30}},
                         {"a_answer", "b_answer", "c_answer"});
  const std::vector<Index> all{0, 1, 2};
  data.pieces.push_back(
      {{},
       all,
       {{-1, 0, -1, -1, 0}},
       {fitted_cell(limits(data, all, &MapInput::low), limits(data, all, &MapInput::high), terms, arm)}});
  return data;
}

/// More chambers than coordinates.
inline MapData redundant_map() {
  MapData data = outline("5 chambers", {});
  for (Index i = 0; i < 5; ++i)
    data.inputs.push_back({std::string("p") + std::to_string(i), "kPa", i, -1.0 - static_cast<double>(i), 2});
  data.actuation = Actuation::Zero(5);
  const std::vector<Index> all{0, 1, 2, 3, 4};
  const Function tip = [](const Eigen::VectorXd& p) -> Eigen::VectorXd {
    return Eigen::Vector3d(10 * p[0] + 4 * p[1] * p[3] + p[4], 8 * p[1] - 3 * p[2] + p[3] * p[3],
                           50 + 6 * p[4] + 2 * p[2] + p[0] * p[1]);
  };
  data.pieces.push_back(
      {{},
       all,
       {{-1, 0, -1, -1, 0}},
       {fitted_cell(limits(data, all, &MapInput::low), limits(data, all, &MapInput::high), 60, tip)}});
  return data;
}

/// What two cables of compliance a, whose free ratios are r, do at lengths c: those that would push are slack.
struct TwoCables {
  Eigen::Matrix2d a{{0.02, 0.006}, {0.006, 0.03}};

  [[nodiscard]] static Eigen::Vector2d free_ratios(double p) { return {1 - 0.1 * p, 1 - 0.05 * p - 0.03 * p * p}; }

  [[nodiscard]] Eigen::VectorXd outputs(double p, const Eigen::Vector2d& c, const std::vector<bool>& taut) const {
    const Eigen::Vector2d r = free_ratios(p);
    Eigen::Vector2d tension(0, 0);
    if (taut[0] && taut[1])
      tension = a.inverse() * (r - c);
    else if (taut[0])
      tension[0] = (r[0] - c[0]) / a(0, 0);
    else if (taut[1])
      tension[1] = (r[1] - c[1]) / a(1, 1);
    const Eigen::Vector2d ratio = r - a * tension;
    Eigen::VectorXd values(7);
    values << 3 * tension[0] + p * p, 2 * tension[1] - p * tension[0], 80 + 10 * p - tension.sum(), tension[0],
        ratio[0], tension[1], ratio[1];
    return values;
  }
};

/// A chamber and two cables, the second of which may be tied at a length; with a shape of 5 vertices and 3 modes.
///
/// askew  error by which ratios of slack cables are too large: near the kink neither taut nor slack is right
inline MapData cable_map(bool tied = false, double askew = 0) {
  MapData data =
      outline(tied ? "tied" : "finger \"map_1\" */ \xc3\xbc", {{"air", "", 0, 0, 2}, {"tendon1", "", 1, 0.6, 1.1}});
  if (!tied) data.inputs.push_back({"tendon2", "", 2, 0.5, 1.2});
  data.actuation = Eigen::Vector3d(1, 1, 0.9);
  data.outputs.insert(data.outputs.end(), {{"tendon1_tension", "N", 0.1},
                                           {"tendon1_ratio", "", 1e-4},
                                           {"tendon2_tension", "N", 0.1},
                                           {"tendon2_ratio", "", 1e-4}});
  data.check.largest = data.check.mean = Eigen::VectorXd::Constant(7, 1e-5);
  data.cables = {{1, 1, 1, 3, 4}, {2, tied ? -1 : 2, 0.9, 5, 6}};
  const Index vertices = 5, modes = 3;
  std::mt19937 generator(5);
  MapShape& shape = data.shape.emplace();
  shape.mean =
      Eigen::VectorXf::NullaryExpr(3 * vertices, [&] { return 0.01F * static_cast<float>(generator() % 9999); });
  shape.modes.resize(3 * vertices, modes);
  for (Index k = 0; k < shape.modes.size(); ++k)
    shape.modes.data()[k] = static_cast<std::int16_t>(static_cast<int>(generator() % 60000) - 30000);
  shape.units = Eigen::Vector3d(1e-3, 2e-4, 3e-5);
  shape.accuracy_mm = 0.05;
  for (int bits = 3; bits >= 0; --bits) {
    MapPiece& piece = data.pieces.emplace_back();
    piece.taut = {(bits & 1) != 0, (bits & 2) != 0};
    piece.inputs = {0};
    for (Index c = 0; c < 2; ++c)
      if (piece.taut[c] && (c == 0 || !tied)) piece.inputs.push_back(c + 1);
    const auto commands_of = [inputs = piece.inputs](const Eigen::VectorXd& of_piece) {
      Eigen::Vector3d commands(0, 1, 0.9);
      for (std::size_t j = 0; j < inputs.size(); ++j) commands[inputs[j]] = of_piece[j];
      return commands;
    };
    const Function outputs = [=, taut = piece.taut](const Eigen::VectorXd& of_piece) {
      const Eigen::Vector3d commands = commands_of(of_piece);
      Eigen::VectorXd values = TwoCables().outputs(commands[0], commands.tail<2>(), taut);
      for (const Index c : {0, 1})
        if (!taut[c]) values[4 + 2 * c] += askew;
      return values;
    };
    const Function amplitudes = [=](const Eigen::VectorXd& of_piece) -> Eigen::VectorXd {
      const Eigen::Vector3d commands = commands_of(of_piece);
      return Eigen::Vector3d(commands.sum() - 1, commands[0] * commands[1], commands[0] * commands[0] - bits);
    };
    piece.tree = {{-1, 0, -1, -1, 0}};
    piece.cells = {fitted_cell(limits(data, piece.inputs, &MapInput::low), limits(data, piece.inputs, &MapInput::high),
                               60, outputs, amplitudes)};
  }
  return data;
}

/// Near the kink, neither taut nor slack cables are right, except within the accuracy.
inline MapData askew_map() {
  constexpr double askew = 0.02;
  MapData data = cable_map(false, askew);
  data.name = "askew";
  for (const MapCable& cable : data.cables) {
    data.outputs[cable.tension].accuracy = 1.2 * askew / 0.02;
    data.outputs[cable.ratio].accuracy = 0;
  }
  return data;
}

/// Has pieces of taut cables alone, as where the ranges end before cables go slack up to an error.
inline MapData ending_map() {
  MapData data = cable_map();
  data.name = "ends";
  data.pieces.resize(1);
  for (const MapCable& cable : data.cables) data.outputs[cable.tension].accuracy = 8;
  return data;
}

/// Two commands; four boxes, one of them outside the map, in each of which the outputs are others.
inline MapData divided_map() {
  MapData data = outline("2 boxes", {{"u", "N", 0, -1, 3}, {"v", "N", 1, 100, 101}});
  MapPiece piece{{}, {0, 1}, {}, {}};
  piece.tree = {{0, 1, 1, 2, -1},   {1, 100.25, 3, 4, -1}, {1, 100.5, 5, 6, -1}, {-1, 0, -1, -1, 0},
                {-1, 0, -1, -1, 1}, {-1, 0, -1, -1, 2},    {-1, 0, -1, -1, -1}};
  const double boxes[][4] = {{-1, 1, 100, 100.25}, {-1, 1, 100.25, 101}, {1, 3, 100, 100.5}};
  for (const auto& box : boxes) {
    const double turn = box[1] + 3 * box[3];
    piece.cells.push_back(fitted_cell(Eigen::Vector2d(box[0], box[2]), Eigen::Vector2d(box[1], box[3]), 40,
                                      [=](const Eigen::VectorXd& c) -> Eigen::VectorXd {
                                        const double v = c[1] - 100;
                                        return Eigen::Vector3d(20 * std::sin(c[0] + v + turn), 30 * v * c[0], 100 * v);
                                      }));
  }
  data.pieces.push_back(std::move(piece));
  return data;
}

inline MapData single_map() {
  MapData data = outline("", {{"air", "kPa", 0, 0, 50}}, {"air_answer"});
  data.pieces.push_back({{},
                         {0},
                         {{-1, 0, -1, -1, 0}},
                         {fitted_cell(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 50), 14,
                                      [](const Eigen::VectorXd& p) -> Eigen::VectorXd {
                                        const double angle = 0.04 * p[0];
                                        return Eigen::Vector4d(60 * std::sin(angle), 0, 60 * std::cos(angle), p[0]);
                                      })}});
  return data;
}

}  // namespace softkin::runs::testing
