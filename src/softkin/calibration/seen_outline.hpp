#pragma once

#include <array>
#include <optional>
#include <softkin/core/types.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <vector>

namespace softkin::calibration {

/// A place of an outline: on an edge of the surface, between two of its vertices.
struct OutlinePlace {
  std::array<Index, 2> vertices{-1, -1};
  double fraction = 0;                         // of the edge from the first to the second [-]
  Eigen::Vector2d place{0, 0}, outward{0, 0};  // [mm]; normal of the edge, of length 1
};

/// What edges of a surface can be its outline: the triangles that each has, once for all shapes.
class SurfaceEdges {
 public:
  explicit SurfaceEdges(std::vector<Triangle> triangles);

  struct Edge {
    std::array<Index, 2> vertices;
    std::vector<Index> across;  // third vertices of its triangles
  };
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }

 private:
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
};

/// The outer border of a surface as seen along z from far away: edges along which the surface turns back, or ends, with
/// a free region beyond that the surface does not enclose. Enclosed regions are detected on a grid of a 160th of the
/// size: smaller holes count as outside, regions that are connected through a smaller gap alone as enclosed.
class SeenOutline {
 public:
  /// surface  must outlive the object
  /// seen     vertices as they lie across the line of sight [mm], #V by 3; z is not looked at
  SeenOutline(const SurfaceEdges& surface, const Points& seen);
  SeenOutline(const SurfaceEdges&, Points&&) = delete;

  /// The nearest place of it, whose edge does not look away from a direction where that is not 0. None: it has no such.
  [[nodiscard]] std::optional<OutlinePlace> nearest(const Eigen::Vector2d& point, const Eigen::Vector2d& outward) const;
  /// Its edges, from end to end; of those that something hides in part the others of their pieces.
  [[nodiscard]] std::vector<std::array<Eigen::Vector2d, 2>> lines() const;

 private:
  struct Fold {
    Index edge;
    Eigen::Vector2d begin, end, outward;
  };

  enum class Ground : char { surface, outside, enclosed };

  [[nodiscard]] Eigen::Vector2d at(Index vertex) const { return seen_.row(vertex).head<2>().transpose(); }
  void find_folds();
  void fill_grid();
  void find_outside();
  [[nodiscard]] std::size_t cell(double place, int axis) const;
  [[nodiscard]] bool covered(const Eigen::Vector2d& point) const;
  [[nodiscard]] Ground ground_at(const std::array<int, 2>& square) const;
  /// Is an uncovered place, with the region further in a direction, enclosed by the surface?
  [[nodiscard]] bool enclosed(const Eigen::Vector2d& point, const Eigen::Vector2d& outward) const;
  /// Does it lie open beyond a place of an edge, and outside?
  [[nodiscard]] bool is_open(const Fold& fold, double fraction) const;

  const SurfaceEdges& surface_;
  const Points& seen_;
  std::vector<Fold> folds_;
  Eigen::Vector2d low_{0, 0}, high_{0, 0};
  std::array<std::size_t, 2> cells_{1, 1};
  std::vector<std::vector<Index>> grid_;  // triangles per cell
  std::vector<Ground> ground_;            // in the middles of squares, with a rim of them around
  Eigen::Vector2d ground_low_{0, 0};      // corner of the first
  double square_ = 0;                     // side of one [mm]
  std::array<int, 2> squares_{0, 0};
};

}  // namespace softkin::calibration
