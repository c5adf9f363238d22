#include <gtest/gtest.h>

#include <set>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh/mesh_check.hpp>
#include <softkin/model/mesh/mesh_joining.hpp>

#include "model/quadratic_mesh.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

using Ends = std::set<Index>;

std::set<Ends> brute_edges(const Mesh& mesh) {
  std::set<Ends> edges;
  for (const Tetrahedron& t : mesh.tetrahedra)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) edges.insert({t[i], t[j]});
  return edges;
}

TEST(MeshOrder, ElevatedHasANodeInTheMiddleOfEveryEdge) {
  for (const Split split : {Split::five, Split::six}) {
    const Mesh mesh = block_mesh({3, 2, 2}, {3, 4, 5}, split);
    const Mesh raised = elevated(mesh);
    const std::set<Ends> edges = brute_edges(mesh);
    ASSERT_EQ(raised.vertices.rows(), mesh.vertices.rows() + static_cast<Index>(edges.size()));
    EXPECT_EQ(raised.vertices.topRows(mesh.vertices.rows()), mesh.vertices);
    EXPECT_EQ(raised.tetrahedra, mesh.tetrahedra);
    ASSERT_EQ(raised.edge_nodes.size(), mesh.tetrahedra.size());
    std::set<Index> nodes;
    for (std::size_t t = 0; t < raised.tetrahedra.size(); ++t) {
      // the order that mesh.hpp documents, written out
      const int ends[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
      for (int e = 0; e < 6; ++e) {
        const Index node = raised.edge_nodes[t][e];
        nodes.insert(node);
        const auto middle = 0.5 * (mesh.vertices.row(mesh.tetrahedra[t][ends[e][0]]) +
                                   mesh.vertices.row(mesh.tetrahedra[t][ends[e][1]]));
        EXPECT_LT((raised.vertices.row(node) - middle).norm(), 1e-14);
      }
    }
    EXPECT_EQ(nodes.size(), edges.size()) << "shared by the elements";
  }
}

TEST(MeshOrder, RegionsOfVerticesGetTheNodesBetweenThem) {
  Mesh mesh = block_mesh({2, 1, 1}, {2, 1, 1});
  add_vertex_region(mesh, "end", {11, 2, 5, 8});  // x = 2
  add_vertex_region(mesh, "corners", {0, 11});
  const Mesh raised = elevated(mesh);
  const auto& end = raised.regions[raised.regions.size() - 2];
  EXPECT_EQ(end.vertices.size(), 9u);  // four sides and a diagonal
  EXPECT_TRUE(std::is_sorted(end.vertices.begin(), end.vertices.end()));
  for (const Index v : end.vertices) EXPECT_DOUBLE_EQ(raised.vertices(v, 0), 2);
  EXPECT_EQ(raised.regions.back().vertices, (std::vector<Index>{0, 11}));
}

TEST(MeshOrder, EdgeTableFindsNodes) {
  const Mesh mesh = quadratic_block({2, 2, 1}, {2, 2, 1});
  const EdgeTable table(mesh);
  EXPECT_FALSE(table.empty());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    for (int e = 0; e < 6; ++e) {
      const Index a = mesh.tetrahedra[t][tetrahedron_edges[e][0]], b = mesh.tetrahedra[t][tetrahedron_edges[e][1]];
      EXPECT_EQ(table.find(a, b), mesh.edge_nodes[t][e]);
      EXPECT_EQ(table.find(b, a), mesh.edge_nodes[t][e]);
      EXPECT_EQ(edge_node(mesh.tetrahedra[t], mesh.edge_nodes[t], b, a), mesh.edge_nodes[t][e]);
    }
  EXPECT_EQ(table.find(0, 17), -1);
  EXPECT_THROW((void)edge_node(mesh.tetrahedra[0], mesh.edge_nodes[0], 0, 17), InvalidInput);
  EXPECT_TRUE(EdgeTable(block_mesh({1, 1, 1}, {1, 1, 1})).empty());

  Mesh cracked = mesh;
  const Index node = cracked.edge_nodes[0][3];
  cracked.edge_nodes[0][3] = node + 1;
  EXPECT_THROW((void)EdgeTable(cracked), InvalidInput);
  Mesh joined = mesh;
  for (EdgeNodes& nodes : joined.edge_nodes)
    for (Index& v : nodes)
      if (v == node) v = node + 1;
  EXPECT_THROW((void)EdgeTable(joined), InvalidInput);
}

TEST(MeshOrder, ExchangingCornersExchangesTheirEdges) {
  const Mesh mesh = quadratic_block({1, 1, 1}, {1, 1, 1});
  const EdgeTable table(mesh);
  Tetrahedron element = mesh.tetrahedra[2];
  EdgeNodes nodes = mesh.edge_nodes[2];
  std::swap(element[2], element[3]);
  exchange_corners_2_and_3(nodes);
  for (int e = 0; e < 6; ++e)
    EXPECT_EQ(nodes[e], table.find(element[tetrahedron_edges[e][0]], element[tetrahedron_edges[e][1]])) << e;
}

TEST(MeshOrder, LoweredForgetsTheEdgeNodes) {
  Mesh mesh = block_mesh({2, 1, 1}, {2, 1, 1});
  add_vertex_region(mesh, "end", {2, 5, 8, 11});
  const Mesh back = lowered(elevated(mesh));
  EXPECT_TRUE(back.edge_nodes.empty());
  EXPECT_EQ(back.regions.back().vertices, mesh.regions.back().vertices);
  EXPECT_GT(back.vertices.rows(), mesh.vertices.rows());
}

/// Two triangles beside a block, of which one hangs on an edge of it.
TEST(MeshOrder, EdgesOfSheetsHaveNodesToo) {
  Mesh mesh = block_mesh({1, 1, 1}, {1, 1, 1});
  const Index before = mesh.vertices.rows();
  mesh.vertices.conservativeResize(before + 2, 3);
  mesh.vertices.bottomRows(2) << 3, 0, 0, 3, 1, 0;
  mesh.triangles = {{0, 1, before}, {1, before + 1, before}};
  const Mesh raised = elevated(mesh);
  EXPECT_EQ(raised.sheet_edges.size(), 4u);
  const EdgeTable table(raised);
  for (const Triangle& t : mesh.triangles) {
    const std::array<Index, 3> nodes = table.of(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 middle = (vertex_at(mesh.vertices, t[k]) + vertex_at(mesh.vertices, t[(k + 1) % 3])) / 2;
      ASSERT_GE(nodes[k], before + 2);
      EXPECT_LT((vertex_at(raised.vertices, nodes[k]) - middle).norm(), 1e-15);
    }
  }
  EXPECT_EQ(quadratic_triangles(raised).size(), 2u);
  Mesh both = raised;
  append(both, raised);
  EXPECT_EQ(both.sheet_edges[4][2], raised.sheet_edges[0][2] + raised.vertices.rows());
  EXPECT_TRUE(lowered(raised).sheet_edges.empty());
  mesh.tetrahedra.clear();  // a sheet alone
  EXPECT_EQ(order_of(elevated(mesh)), 2);
  EXPECT_EQ(elevated(mesh).sheet_edges.size(), 5u);
}

TEST(MeshOrder, Refusals) {
  EXPECT_THROW((void)elevated(block_mesh({1, 1, 1}, {1, 1, 1}, Split::prisms)), InvalidInput);
  EXPECT_THROW((void)elevated(quadratic_block({1, 1, 1}, {1, 1, 1})), InvalidInput);
}

TEST(MeshOrder, EdgeNodesAreNoUnreferencedVertices) {
  Mesh mesh = quadratic_block({2, 1, 1}, {2, 1, 1});
  EXPECT_TRUE(check_mesh(mesh).unreferenced.empty());
  ASSERT_EQ(check_mesh(mesh).parts.size(), 1u);
  EXPECT_EQ(check_mesh(mesh).parts[0].size(), static_cast<std::size_t>(mesh.vertices.rows()));
  mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
  mesh.vertices.bottomRows(1) << 5, 5, 5;
  EXPECT_EQ(check_mesh(mesh).unreferenced, (std::vector<Index>{static_cast<Index>(mesh.vertices.rows() - 1)}));
}

}  // namespace
