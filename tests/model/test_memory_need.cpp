#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/memory_need.hpp>
#include <softkin/model/mesh/mesh_order.hpp>

#include "model/block_mesh.hpp"

namespace softkin {
namespace {

/// Numbers of a Cholesky factor whose vertices are eliminated in the order of least degree, by brute force.
double factor_by_least_degree(const Mesh& mesh) {
  std::vector<std::set<Index>> near(mesh.vertices.rows());
  const auto couple = [&near](const std::vector<Index>& nodes) {
    for (const Index a : nodes)
      for (const Index b : nodes)
        if (a != b) near[a].insert(b);
  };
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    std::vector<Index> nodes(mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    if (!mesh.edge_nodes.empty()) nodes.insert(nodes.end(), mesh.edge_nodes[t].begin(), mesh.edge_nodes[t].end());
    couple(nodes);
  }
  std::set<Index> left;
  for (Index v = 0; v < std::ssize(near); ++v) left.insert(v);
  double values = 0;
  while (!left.empty()) {
    const Index v =
        *std::min_element(left.begin(), left.end(), [&](Index a, Index b) { return near[a].size() < near[b].size(); });
    const std::set<Index> around = near[v];
    values += 9.0 * static_cast<double>(1 + around.size());
    for (const Index a : around) {
      near[a].erase(v);
      for (const Index b : around)
        if (a != b) near[a].insert(b);
    }
    left.erase(v);
  }
  return values;
}

TEST(MemoryNeed, IsThatOfAnEliminationWithinAFactor) {
  using testing::Split;
  for (const auto& [cells, order] :
       {std::pair(std::array{6, 6, 6}, 1), std::pair(std::array{30, 3, 3}, 1), std::pair(std::array{4, 4, 4}, 2)}) {
    const Vec3 size(cells[0], cells[1], cells[2]);
    Mesh mesh = testing::layered_mesh(cells, size, Split::five, Split::five);
    if (order == 2) mesh = elevated(mesh);
    const MemoryNeed need = memory_need(mesh.vertices, mesh.tetrahedra, mesh.edge_nodes, mesh.prisms);
    EXPECT_EQ(need.unknowns, 3.0 * static_cast<double>(mesh.vertices.rows()));
    const double exact = factor_by_least_degree(mesh);
    EXPECT_GT(need.values, 0.7 * exact);
    EXPECT_LT(need.values, 6 * exact);  // with what waits, and fronts as rectangles, as the solver stores them
  }
}

/// Of a cube of n vertices a factor grows as n^(4/3), of a bar as n: George 1973.
TEST(MemoryNeed, GrowsAsNestedDissectionDoes) {
  const auto values = [](const std::array<int, 3>& cells) {
    const Vec3 size(cells[0], cells[1], cells[2]);
    const Mesh mesh = testing::layered_mesh(cells, size, testing::Split::five, testing::Split::five);
    return memory_need(mesh.vertices, mesh.tetrahedra, mesh.edge_nodes, mesh.prisms).values;
  };
  EXPECT_NEAR(std::log2(values({32, 32, 32}) / values({16, 16, 16})), 4, 0.4);
  EXPECT_NEAR(std::log2(values({256, 4, 4}) / values({128, 4, 4})), 1, 0.2);
}

}  // namespace
}  // namespace softkin
