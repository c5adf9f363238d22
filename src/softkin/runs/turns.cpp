#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/runs/turns.hpp>

namespace softkin::runs {

namespace {

constexpr double degrees_per_radian = 180 / std::numbers::pi;

/// A place given by coordinates is a point of one element, and turns with nothing that users would know.
bool is_of_one_element(const Model& model, const EmbeddedPoint& point) {
  constexpr std::size_t most = 10;  // of a tetrahedron of order 2
  if (point.vertices.size() > most) return false;
  const auto has = [](const auto& list, Index v) { return std::find(list.begin(), list.end(), v) != list.end(); };
  const auto all = [&](const auto& belongs) {
    return std::all_of(point.vertices.begin(), point.vertices.end(), belongs);
  };
  for (std::size_t t = 0; t < model.elements.tetrahedra.size(); ++t)
    if (all([&](Index v) {
          return has(model.elements.tetrahedra[t], v) ||
                 (!model.elements.edge_nodes.empty() && has(model.elements.edge_nodes[t], v));
        }))
      return true;
  return std::any_of(model.elements.prisms.begin(), model.elements.prisms.end(),
                     [&](const Prism& prism) { return all([&](Index v) { return has(prism, v); }); });
}

Mat3 moments(const EmbeddedPoint& point, const Points& here, const Points& there) {
  const Vec3 a = point.at(here), b = point.at(there);
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < point.vertices.size(); ++i) {
    const Index v = point.vertices[i];
    sum += std::abs(point.weights[i]) * (there.row(v).transpose() - b) * (here.row(v) - a.transpose());
  }
  return sum;
}

constexpr double flat = 1e-6;  // of squares of lengths: what is thinner is a plane, and less a line

/// Do its vertices at rest span a plane, so that it has an orientation?
bool spans_a_plane(const Model& model, const EmbeddedPoint& point) {
  const Vec3 axes = principal_values(moments(point, model.rest, model.rest));
  return axes[1] > flat * axes[2];
}

/// The linear map that takes its vertices best from rest to where they are; of a plane's normal to the normal.
Mat3 best_map(const EmbeddedPoint& point, const Points& rest, const Points& positions) {
  const SymmetricEigen axes = symmetric_eigen(moments(point, rest, rest));
  const Mat3 from = axes.vectors, there = moments(point, rest, positions);
  Mat3 to;
  for (Index k = 0; k < 3; ++k) to.col(k) = there * from.col(k) / axes.values[k];
  if (axes.values[0] <= flat * axes.values[2]) to.col(0) = from.determinant() * to.col(1).cross(to.col(2)).normalized();
  return to * from.transpose();
}

Eigen::AngleAxisd rotation_of(const EmbeddedPoint& point, const Points& rest, const Points& positions) {
  return Eigen::AngleAxisd(nearest_rotation(best_map(point, rest, positions)).rotation);
}

double turn_of(const EmbeddedPoint& point, const Points& rest, const Points& positions) {
  return degrees_per_radian * rotation_of(point, rest, positions).angle();
}

/// The angle [degrees] that differs from one by whole turns and is nearest to another one.
double nearest_turn(double angle, double near) {
  return angle + 360 * std::round((near - angle) / 360);
}

/// The axis about which a marker has turned by `turn`, of the two directions of that of its rotation; none at rest.
Vec3 axis_of(const Eigen::AngleAxisd& rotation, double turn) {
  constexpr double rounding = 1e-7;  // [radians]: below it the axis is noise
  if (rotation.angle() < rounding) return Vec3::Zero();
  const double angle = degrees_per_radian * rotation.angle();
  const bool along = std::abs(nearest_turn(angle, turn) - turn) <= std::abs(nearest_turn(-angle, turn) - turn);
  return along ? rotation.axis() : Vec3(-rotation.axis());
}

}  // namespace

double TurnMeter::next(const Vec3& line) {
  if (!line.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  constexpr double rounding = 1e-9;  // below it the axis of a turn is noise
  const Vec3 turned = start_.cross(line);
  if (axis_.isZero() && turned.norm() > rounding * start_.norm() * line.norm()) axis_ = turned.normalized();
  const double turn = degrees_per_radian * std::atan2(axis_.dot(turned), start_.dot(line));
  last_ = nearest_turn(turn, last_);
  return last_;
}

Vec3 MarkerLine::in(const std::vector<Vec3>& markers) const {
  return markers.at(to) - markers.at(from);
}

Vec3 MarkerLine::at_rest(const Model& model) const {
  return model.markers.at(to).at(model.rest) - model.markers.at(from).at(model.rest);
}

std::optional<MarkerLine> read_marker_line(const Model& model, const std::vector<std::string>& names,
                                           const std::string& source) {
  if (names.empty()) return std::nullopt;
  std::vector<std::string> known;
  for (const Marker& marker : model.markers) known.push_back(marker.name);
  MarkerLine line;
  for (const auto& [name, index] : {std::pair{names.at(0), &line.from}, std::pair{names.at(1), &line.to}}) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw InvalidInput(source + ": there is no marker " + excerpt(name) +
                         (known.empty() ? "; the robot has none" : suggest_name(name, known)));
    *index = found - known.begin();
  }
  if (!(line.at_rest(model).norm() > 1e-9 * model.diagonal_mm))
    throw InvalidInput(source + ": markers '" + names[0] + "' and '" + names[1] +
                       "' are at one place at rest, so no line goes from one to the other");
  return line;
}

LineTurns::LineTurns(const Model& model) {
  const Index count = std::ssize(model.markers);
  for (Index to = 1; to < count; ++to)
    for (Index from = 0; from < to; ++from) meters_.emplace_back(MarkerLine{from, to}.at_rest(model));
}

std::vector<double> LineTurns::next(const std::vector<Vec3>& markers) {
  std::vector<double> turns;
  turns.reserve(meters_.size());
  for (std::size_t to = 1; to < markers.size(); ++to)
    for (std::size_t from = 0; from < to; ++from)
      turns.push_back(meters_[turns.size()].next(markers[to] - markers[from]));
  return turns;
}

std::size_t LineTurns::number(const MarkerLine& line) {
  const Index from = std::min(line.from, line.to), to = std::max(line.from, line.to);
  return static_cast<std::size_t>(to * (to - 1) / 2 + from);
}

std::vector<bool> oriented_markers(const Model& model) {
  std::vector<bool> oriented;
  for (const Marker& marker : model.markers)
    oriented.push_back(!is_of_one_element(model, marker.point) && spans_a_plane(model, marker.point));
  return oriented;
}

std::vector<double> marker_turns(const Model& model, const Points& positions) {
  const std::vector<bool> oriented = oriented_markers(model);
  std::vector<double> turns;
  for (std::size_t m = 0; m < model.markers.size(); ++m)
    turns.push_back(oriented[m] ? turn_of(model.markers[m].point, model.rest, positions)
                                : std::numeric_limits<double>::quiet_NaN());
  return turns;
}

std::vector<double> continued_marker_turns(const Model& model, const Points& positions,
                                           const std::vector<double>& before, const Points& positions_before) {
  std::vector<double> turns = marker_turns(model, positions);
  for (std::size_t m = 0; m < turns.size(); ++m) {
    if (!std::isfinite(turns[m]) || m >= before.size() || !std::isfinite(before[m])) continue;
    const EmbeddedPoint& point = model.markers[m].point;
    const Vec3 axis_before = axis_of(rotation_of(point, model.rest, positions_before), before[m]);
    const bool is_reversed = rotation_of(point, model.rest, positions).axis().dot(axis_before) < 0;
    turns[m] = nearest_turn(is_reversed ? -turns[m] : turns[m], before[m]);
  }
  return turns;
}

}  // namespace softkin::runs
