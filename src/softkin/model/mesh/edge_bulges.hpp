#pragma once

#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/smooth_surface.hpp>

namespace softkin {

/// Moves the nodes of a mesh of order 2 from the middles of the edges to their targets on a surface.
class EdgeBulges {
 public:
  /// Puts every node into the middle.
  explicit EdgeBulges(Mesh& mesh);

  /// Sets the intended displacement of a node on a surface, 0 to stay [mm]; at most a quarter of its edge's length is
  /// used.
  ///
  /// plane  normal of the plane in which it may make room, if it is to stay in it; else 0
  void aim(Index node, const Vec3& bulge, const Vec3& plane);
  /// Moves the nodes as far as no element folds; other nodes make room.
  void go(const SmoothSurface& surface);
  void describe(CurvedEdges& result) const;

 private:
  struct Node {
    Index low = -1, high = -1;       // ends of its edge; -1: of none
    std::size_t begin = 0, end = 0;  // its elements in around_
    Vec3 bulge{0, 0, 0}, plane{0, 0, 0};
    double fraction = 1;  // of the bulge
    bool surface = false, aimed = false;
  };

  [[nodiscard]] Vec3 middle(const Node& node) const;
  void place(Index node);
  [[nodiscard]] double quality(Index element) const;
  [[nodiscard]] double deficit_around(Index node, double wanted) const;
  [[nodiscard]] Vec3 mean_bulge(Index node) const;
  [[nodiscard]] std::vector<Index> elements_below(double least) const;
  [[nodiscard]] bool may_yield(const Node& node) const;
  [[nodiscard]] Vec3 allowed(const Node& node, const Vec3& path) const;
  void go_along(const std::vector<Index>& bad, const SmoothSurface& surface);
  void make_room(Index node, const SmoothSurface& surface, double wanted);
  void hold_back(Index element, bool wholly);

  Mesh& mesh_;
  std::vector<Node> nodes_;  // by vertex
  std::vector<Index> around_;
};

}  // namespace softkin
