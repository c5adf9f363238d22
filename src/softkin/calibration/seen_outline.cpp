#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/calibration/seen_outline.hpp>

namespace softkin::calibration {

namespace {

using Eigen::Vector2d;

constexpr double flat = 1e-9;      // twice the area over the squares of sides: a triangle seen on its edge
constexpr double beyond = 1e-4;    // of an edge's length: distance beyond it that must be free
constexpr double off_ends = 1e-2;  // the same: minimum distance of the tested places from its ends
constexpr double triangles_a_cell = 2;
constexpr double squares_along = 160;
constexpr int squares_nearby = 2;
constexpr int pieces_of_line = 8;  // in which an edge is drawn that something hides in part

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

SurfaceEdges::SurfaceEdges(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
  std::map<std::array<Index, 2>, std::size_t> known;
  for (const Triangle& t : triangles_)
    for (std::size_t i = 0; i < 3; ++i) {
      std::array<Index, 2> ends{t[i], t[(i + 1) % 3]};
      if (ends[0] > ends[1]) std::swap(ends[0], ends[1]);
      const auto [found, is_new] = known.emplace(ends, edges_.size());
      if (is_new) edges_.push_back({ends, {}});
      edges_[found->second].across.push_back(t[(i + 2) % 3]);
    }
}

SeenOutline::SeenOutline(const SurfaceEdges& surface, const Points& seen) : surface_(surface), seen_(seen) {
  find_folds();
  fill_grid();
  find_outside();
}

/// An edge is none of the outline where its triangles lie on either side of it. Where they all lie on one, it ends
/// there or turns back; a triangle seen on its edge lies on no side.
void SeenOutline::find_folds() {
  for (std::size_t e = 0; e < surface_.edges().size(); ++e) {
    const SurfaceEdges::Edge& edge = surface_.edges()[e];
    const Vector2d begin = at(edge.vertices[0]), end = at(edge.vertices[1]), along = end - begin;
    bool left = false, right = false;
    for (const Index third : edge.across) {
      const Vector2d arm = at(third) - begin;
      const double area = cross(along, arm), least = flat * (along.squaredNorm() + arm.squaredNorm());
      left = left || area > least;
      right = right || area < -least;
    }
    if (left == right) continue;
    const Vector2d normal = Vector2d(along.y(), -along.x()).normalized();
    folds_.push_back({static_cast<Index>(e), begin, end, left ? normal : Vector2d(-normal)});
  }
}

std::size_t SeenOutline::cell(double place, int axis) const {
  const auto count = static_cast<double>(cells_[axis]);
  const double fraction = (place - low_[axis]) / (high_[axis] - low_[axis]);
  return static_cast<std::size_t>(std::clamp(std::floor(fraction * count), 0.0, count - 1));
}

void SeenOutline::fill_grid() {
  const std::vector<Triangle>& triangles = surface_.triangles();
  if (triangles.empty()) return;
  low_ = high_ = at(triangles[0][0]);
  for (const Triangle& t : triangles)
    for (const Index v : t) low_ = low_.cwiseMin(at(v)), high_ = high_.cwiseMax(at(v));
  const Vector2d size = (high_ - low_).cwiseMax(Vector2d::Constant(1e-9 + 1e-6 * (high_ - low_).norm()));
  high_ = low_ + size;
  const double side = std::sqrt(size.prod() * triangles_a_cell / static_cast<double>(triangles.size()));
  const auto most = static_cast<double>(triangles.size());
  for (std::size_t axis = 0; axis < 2; ++axis)
    cells_[axis] = static_cast<std::size_t>(std::clamp(size[axis] / side, 1.0, most));
  grid_.resize(cells_[0] * cells_[1]);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector2d a = at(triangles[t][0]), b = at(triangles[t][1]), c = at(triangles[t][2]);
    const Vector2d least = a.cwiseMin(b).cwiseMin(c), largest = a.cwiseMax(b).cwiseMax(c);
    for (std::size_t i = cell(least.x(), 0); i <= cell(largest.x(), 0); ++i)
      for (std::size_t j = cell(least.y(), 1); j <= cell(largest.y(), 1); ++j) grid_[i * cells_[1] + j].push_back(t);
  }
}

bool SeenOutline::covered(const Vector2d& point) const {
  if ((point.array() < low_.array()).any() || (point.array() > high_.array()).any() || grid_.empty()) return false;
  const std::vector<Index>& near = grid_[cell(point.x(), 0) * cells_[1] + cell(point.y(), 1)];
  return std::any_of(near.begin(), near.end(), [&](Index number) {
    const Triangle& t = surface_.triangles()[number];
    const Vector2d a = at(t[0]) - point, b = at(t[1]) - point, c = at(t[2]) - point;
    const double ab = cross(a, b), bc = cross(b, c), ca = cross(c, a);
    return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
  });
}

/// From the rim, which is outside, on to all neighbours that are not covered.
void SeenOutline::find_outside() {
  if (grid_.empty()) return;
  square_ = (high_ - low_).maxCoeff() / squares_along;
  ground_low_ = low_ - Vector2d::Constant(square_);
  for (std::size_t axis = 0; axis < 2; ++axis)
    squares_[axis] = static_cast<int>(std::ceil((high_ - low_)[axis] / square_)) + 2;
  for (int j = 0; j < squares_[1]; ++j)
    for (int i = 0; i < squares_[0]; ++i)
      ground_.push_back(covered(ground_low_ + square_ * Vector2d(i + 0.5, j + 0.5)) ? Ground::surface
                                                                                    : Ground::enclosed);
  std::vector<std::array<int, 2>> next{{0, 0}};
  while (!next.empty()) {
    const auto [i, j] = next.back();
    next.pop_back();
    if (i < 0 || j < 0 || i >= squares_[0] || j >= squares_[1]) continue;
    Ground& ground = ground_[j * squares_[0] + i];
    if (ground != Ground::enclosed) continue;
    ground = Ground::outside;
    next.insert(next.end(), {{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}});
  }
}

SeenOutline::Ground SeenOutline::ground_at(const std::array<int, 2>& square) const {
  if (square[0] < 0 || square[1] < 0 || square[0] >= squares_[0] || square[1] >= squares_[1]) return Ground::outside;
  return ground_[square[1] * squares_[0] + square[0]];
}

bool SeenOutline::enclosed(const Vector2d& point, const Vector2d& outward) const {
  const auto square_of = [&](const Vector2d& place) {
    const Vector2d squares = (place - ground_low_) / square_;
    return std::array{static_cast<int>(std::floor(squares.x())), static_cast<int>(std::floor(squares.y()))};
  };
  bool any = false;
  for (Vector2d at = point; !covered(at); at += 0.5 * square_ * outward) {
    const Ground ground = ground_at(square_of(at));
    if (ground == Ground::outside) return false;
    any = any || ground == Ground::enclosed;
  }
  if (any) return true;
  // where it is narrower than a square by what is nearby
  const std::array<int, 2> here = square_of(point);
  for (int i = here[0] - squares_nearby; i <= here[0] + squares_nearby; ++i)
    for (int j = here[1] - squares_nearby; j <= here[1] + squares_nearby; ++j) {
      if (ground_at({i, j}) == Ground::outside) return false;
      any = any || ground_at({i, j}) == Ground::enclosed;
    }
  return any;
}

bool SeenOutline::is_open(const Fold& fold, double fraction) const {
  const Vector2d along = fold.end - fold.begin;
  const Vector2d place =
      fold.begin + std::clamp(fraction, off_ends, 1 - off_ends) * along + beyond * along.norm() * fold.outward;
  return !covered(place) && !enclosed(place, fold.outward);
}

std::optional<OutlinePlace> SeenOutline::nearest(const Vector2d& point, const Vector2d& outward) const {
  struct Candidate {
    double square, fraction;
    std::size_t fold;
  };
  std::vector<Candidate> candidates;
  for (std::size_t f = 0; f < folds_.size(); ++f) {
    const Fold& fold = folds_[f];
    if (!outward.isZero(0) && !(fold.outward.dot(outward) > 0)) continue;
    const Vector2d along = fold.end - fold.begin;
    const double fraction = std::clamp((point - fold.begin).dot(along) / along.squaredNorm(), 0.0, 1.0);
    candidates.push_back({(fold.begin + fraction * along - point).squaredNorm(), fraction, f});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::pair(a.square, a.fold) < std::pair(b.square, b.fold);
  });
  for (const Candidate& each : candidates) {
    const Fold& fold = folds_[each.fold];
    if (!is_open(fold, each.fraction)) continue;
    return OutlinePlace{surface_.edges()[fold.edge].vertices, each.fraction,
                        fold.begin + each.fraction * (fold.end - fold.begin), fold.outward};
  }
  return std::nullopt;
}

std::vector<std::array<Vector2d, 2>> SeenOutline::lines() const {
  std::vector<std::array<Vector2d, 2>> lines;
  for (const Fold& fold : folds_) {
    int begin = -1;  // of the pieces that lie open one after another
    for (int piece = 0; piece <= pieces_of_line; ++piece) {
      const bool open = piece < pieces_of_line && is_open(fold, (piece + 0.5) / pieces_of_line);
      if (open && begin < 0) begin = piece;
      if (open || begin < 0) continue;
      const Vector2d along = (fold.end - fold.begin) / pieces_of_line;
      lines.push_back({fold.begin + begin * along, fold.begin + piece * along});
      begin = -1;
    }
  }
  return lines;
}

}  // namespace softkin::calibration
