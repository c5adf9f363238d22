#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numeric>
#include <random>
#include <softkin/model/compile/embedding.hpp>
#include <softkin/model/compile/regions.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"
#include "model/quadratic_mesh.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

const Vec3 cube(3, 3, 3);

/// 3 mm cube of 27 cells of order 2; region "chamber" is the middle one.
Mesh quadratic_hollow() {
  Mesh mesh = quadratic_block({3, 3, 3}, cube);
  add_volume_region(mesh, "chamber", [](const Vec3& p) { return (p - 0.5 * cube).cwiseAbs().maxCoeff() < 0.5; });
  return mesh;
}

TEST(Order2, CompileElevates) {
  RobotSpec spec = physical_robot(block_mesh({3, 2, 2}, {30, 20, 10}));
  spec.mesh_options.quadratic = true;
  const Model model = compile(spec);
  const Mesh raised = elevated(spec.mesh);
  EXPECT_EQ(model.rest, raised.vertices);
  EXPECT_EQ(model.elements.edge_nodes, raised.edge_nodes);
  EXPECT_NEAR(sum(model.elements.tetrahedron_volumes), 6000, 1e-9);
  EXPECT_TRUE(std::all_of(model.elements.used.begin(), model.elements.used.end(), [](bool used) { return used; }));
  EXPECT_TRUE(model.notes.empty());
  spec.mesh_options.quadratic = false;
  EXPECT_TRUE(compile(spec).elements.edge_nodes.empty());
  spec.mesh = raised;  // of order 2 in its file
  EXPECT_EQ(compile(spec).elements.edge_nodes, raised.edge_nodes);
}

TEST(Order2, EverythingThatIsFixedHoldsItsEdgeNodes) {
  RobotSpec spec = physical_robot(block_mesh({2, 2, 2}, {2, 2, 2}));
  spec.mesh_options.quadratic = true;
  std::vector<Index> face;
  for (Index v = 0; v < spec.mesh.vertices.rows(); ++v)
    if (spec.mesh.vertices(v, 0) == 0) face.push_back(v);
  add_vertex_region(spec.mesh, "nodes", face);
  add_volume_region(spec.mesh, "half", [](const Vec3& p) { return p[0] < 1; });
  const std::vector<std::pair<RegionRef, double>> places{{named("x_low"), 0},
                                                         {named("nodes"), 0},
                                                         {shaped(VertexList{face}), 0},
                                                         {shaped(Box{{0, 0, 0}, {0, 2, 2}}), 0},
                                                         {shaped(Halfspace{{0.5, 0, 0}, {-1, 0, 0}}), 0.5},
                                                         {named("half"), 1}};
  for (const auto& [where, depth] : places) {
    spec.fixed = {{where, {true, true, true}}};
    const Model model = compile(spec);
    for (Index v = 0; v < model.rest.rows(); ++v)
      EXPECT_EQ(model.held.fixed[v][0], model.rest(v, 0) <= depth) << label(where) << " " << model.rest.row(v);
  }
}

TEST(Order2, AnEdgeNodeHoldsItsPart) {
  RobotSpec spec = physical_robot(block_mesh({2, 1, 1}, {2, 1, 1}));
  spec.mesh_options.quadratic = true;
  spec.fixed = {{shaped(Box{{0.4, 0, 0}, {0.6, 1, 1}}), {true, true, true}}};
  EXPECT_EQ(refusal(spec), "");
  spec.fixed[0].where = shaped(Box{{0.4, 0, 0}, {0.6, 0.1, 0.1}});  // one node
  EXPECT_NE(refusal(spec).find("can turn about x, y and z"), std::string::npos);
}

TEST(Order2, ReorderedElementsKeepTheirEdges) {
  RobotSpec spec = physical_robot(bent(quadratic_hollow()));
  spec.actuators = {chamber("chamber")};
  const Model good = compile(spec);
  const EdgeTable table(spec.mesh);
  std::mt19937 engine(5);
  std::size_t odd = 0;
  for (std::size_t t = 0; t < spec.mesh.tetrahedra.size(); ++t) {
    std::shuffle(spec.mesh.tetrahedra[t].begin(), spec.mesh.tetrahedra[t].end(), engine);
    const Tetrahedron& corners = spec.mesh.tetrahedra[t];
    for (int e = 0; e < 6; ++e)
      spec.mesh.edge_nodes[t][e] = table.find(corners[tetrahedron_edges[e][0]], corners[tetrahedron_edges[e][1]]);
    odd += signed_volume(spec.mesh.vertices, corners) < 0;
  }
  const Model model = compile(spec);
  EXPECT_TRUE(has_note(model, std::to_string(odd) + " elements were reordered"));
  ASSERT_EQ(model.elements.tetrahedra.size(), good.elements.tetrahedra.size());
  for (std::size_t t = 0; t < model.elements.tetrahedra.size(); ++t) {
    EXPECT_GT(signed_volume(model.rest, model.elements.tetrahedra[t]), 0);
    EXPECT_NEAR(model.elements.tetrahedron_volumes[t], good.elements.tetrahedron_volumes[t], 1e-15);
    for (int e = 0; e < 6; ++e)
      EXPECT_EQ(model.elements.edge_nodes[t][e], table.find(model.elements.tetrahedra[t][tetrahedron_edges[e][0]],
                                                            model.elements.tetrahedra[t][tetrahedron_edges[e][1]]));
  }
  EXPECT_NEAR(model.actuators[0].rest_measure, good.actuators[0].rest_measure, 1e-13);
}

TEST(Order2, CurvedElementsAndCavitiesHaveTheirVolume) {
  RobotSpec spec = physical_robot(bent(quadratic_hollow()));
  spec.actuators = {chamber("chamber")};
  const Model model = compile(spec);
  const double hole = Bend{}.moments({1, 1, 1}, {2, 2, 2}).first;
  EXPECT_NEAR(sum(model.elements.tetrahedron_volumes), Bend{}.moments(Vec3::Zero(), cube).first - hole, 1e-12);
  EXPECT_NEAR(model.actuators[0].rest_measure, hole, 1e-14);
  const EdgeTable table(spec.mesh);
  ASSERT_EQ(model.actuators[0].as<ChamberDrive>()->cavity.size(), 12u);
  for (const CavityFace& face : model.actuators[0].as<ChamberDrive>()->cavity)
    EXPECT_EQ(face.edges, table.of(face.corners));
  // the node inside the chamber belongs to no element, and nobody misses it
  EXPECT_TRUE(model.notes.empty());
  EXPECT_EQ(std::count(model.elements.used.begin(), model.elements.used.end(), false), 1);
}

TEST(Order2, WeighsABentBlock) {
  RobotSpec spec = physical_robot(bent(quadratic_block({3, 3, 3}, cube)));
  spec.materials[0].density = 1100;
  spec.loads.gravity = {0, 3, -9.81};
  const Model model = compile(spec);
  const auto [volume, first] = Bend{}.moments(Vec3::Zero(), cube);
  const Vec3 unit = 1100e-9 * spec.loads.gravity;
  EXPECT_LT((model.loads.dead.colwise().sum().transpose() - volume * unit).norm(), 1e-17);
  EXPECT_LT((model.rest.transpose() * model.loads.dead - first * unit.transpose()).norm(), 1e-17);

  RobotSpec straight = physical_robot(block_mesh({1, 1, 1}, {1, 1, 1}));
  straight.mesh_options.quadratic = true;
  straight.materials[0].density = 1;
  straight.loads.gravity = {0, 0, -1e9};
  const Model one = compile(straight);
  // the cube's first corner is one of six elements of 1/6 mm^3 each
  EXPECT_NEAR(one.loads.dead(0, 2), 6 * (1 / 6.0) / 20, 1e-15);
}

TEST(Order2, MarkersFollowQuadraticDeformations) {
  RobotSpec spec = physical_robot(block_mesh({3, 3, 3}, cube));
  spec.mesh_options.quadratic = true;
  spec.markers = {{"a", at(1.3, 0.4, 2.2)}, {"b", at(2.95, 1.5, 0.1)}, {"face", mean("x_high")}, {"all", mean("body")}};
  const Model model = compile(spec);
  Points moved = model.rest;
  for (Index v = 0; v < moved.rows(); ++v) moved.row(v) = Bend{}(moved.row(v).transpose()).transpose();
  for (const std::size_t i : {0u, 1u}) {
    const Vec3 place = std::get<Vec3>(spec.markers[i].at.point);
    EXPECT_LT((model.markers[i].point.at(model.rest) - place).norm(), 1e-13);
    EXPECT_LT((model.markers[i].point.at(moved) - Bend{}(place)).norm(), 1e-13);
  }
  // means of x + a x y, ... over the face x = 3, and over the cube
  const Bend bend;
  const Vec3 face(3 + bend.a * 4.5, 1.5 + bend.b * 2.25, 1.5 + bend.c * 4.5);
  const Vec3 all = Vec3::Constant(1.5) + 2.25 * Vec3(bend.a, bend.b, bend.c);
  EXPECT_LT((model.markers[2].point.at(moved) - face).norm(), 1e-13);
  EXPECT_LT((model.markers[3].point.at(moved) - all).norm(), 1e-13);
  const EdgeTable table(elevated(spec.mesh));
  for (const Index v : model.markers[2].point.vertices) EXPECT_GE(v, 64) << "corners of a straight face weigh nothing";
}

TEST(Order2, MeansOfCurvedRegions) {
  const Mesh mesh = bent(quadratic_hollow());
  RobotSpec spec = physical_robot(mesh);
  // reversed corners count all the same
  std::swap(spec.mesh.tetrahedra[7][2], spec.mesh.tetrahedra[7][3]);
  exchange_corners_2_and_3(spec.mesh.edge_nodes[7]);
  const RegionTable table(spec);
  const auto [volume, first] = Bend{}.moments(Vec3::Zero(), cube);
  EXPECT_LT((mean_of(table.find("body", {}), spec.mesh).at(mesh.vertices) - first / volume).norm(), 1e-13);
  // the face x = 3 is the image of (y, z): the mean by a fine midpoint rule
  constexpr int n = 300;
  double area = 0;
  Vec3 moment = Vec3::Zero();
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double h = 1.5 / n;
      const Vec3 p(3, (2 * i + 1) * h, (2 * j + 1) * h);
      const Vec3 u = Bend{}(p + h * Vec3::Unit(1)) - Bend{}(p - h * Vec3::Unit(1));
      const Vec3 v = Bend{}(p + h * Vec3::Unit(2)) - Bend{}(p - h * Vec3::Unit(2));
      area += u.cross(v).norm();
      moment += u.cross(v).norm() * Bend{}(p);
    }
  const EmbeddedPoint face = mean_of(table.find("x_high", {}), spec.mesh, table.edges());
  EXPECT_LT((face.at(mesh.vertices) - moment / area).norm(), 1e-5);
  EXPECT_NEAR(std::accumulate(face.weights.begin(), face.weights.end(), 0.0), 1, 1e-14);
}

TEST(Order2, ATriangleThatIsNoFaceHasNoMean) {
  RobotSpec spec = physical_robot(quadratic_block({2, 1, 1}, {2, 1, 1}));
  Region stray;
  stray.name = "stray";
  stray.dimension = 2;
  stray.triangles = {static_cast<Index>(spec.mesh.triangles.size())};
  spec.mesh.triangles.push_back({0, 2, 11});
  spec.mesh.regions.push_back(stray);
  EXPECT_EQ(refusal(spec), "");
  spec.markers = {{"tip", mean("stray")}};
  EXPECT_NE(refusal(spec).find("robot.yaml:6: marker 'tip': a triangle of the region is not a face of an element"),
            std::string::npos);
}

TEST(Order2, TargetShapesLeaveTheEdgeNodesOut) {
  RobotSpec spec = block_robot(quadratic_block({2, 1, 1}, {2, 1, 1}));
  const Model model = compile(spec);
  EXPECT_TRUE(model.elements.edge_nodes.empty());
  EXPECT_EQ(std::count(model.elements.used.begin(), model.elements.used.end(), true), 12);
  EXPECT_TRUE(has_note(model, "The mesh is of order 2: its edge nodes are left out"));
  RobotSpec linear = block_robot(block_mesh({2, 1, 1}, {2, 1, 1}));
  linear.mesh_options.quadratic = true;
  EXPECT_EQ(compile(linear).rest.rows(), 12);
  EXPECT_TRUE(has_note(compile(linear), "The elements stay linear"));
}

TEST(Order2, Refusals) {
  RobotSpec good = physical_robot(quadratic_block({2, 1, 1}, {2, 1, 1}));
  const auto move = [](int edge, const Vec3& by) {  // of the last element, over the edge's length
    return [=](RobotSpec& spec) {
      const Tetrahedron& t = spec.mesh.tetrahedra.back();
      const auto& ends = tetrahedron_edges[edge];
      const double length = (spec.mesh.vertices.row(t[ends[0]]) - spec.mesh.vertices.row(t[ends[1]])).norm();
      spec.mesh.vertices.row(spec.mesh.edge_nodes.back()[edge]) += length * by.transpose();
    };
  };
  expect_refused(
      good,
      {
          {"stray", move(0, {0, 0.26, 0}), "more than a quarter of its edge's length from the middle; the first is"},
          {"two nodes", [](RobotSpec& s) { s.mesh.edge_nodes[0][0] += 1; }, "(from 0) has two nodes, "},
          {"missing", [](RobotSpec& s) { s.mesh.edge_nodes.pop_back(); }, "needs edge nodes for every element"},
          {"index", [](RobotSpec& s) { s.mesh.edge_nodes[3][2] = 999; },
           "block: the edges of tetrahedron 3 names vertex 999"},
          {"prisms",
           [](RobotSpec& s) {
             s.mesh.prisms.push_back({0, 1, 3, 4, 6, 7});
           },
           "prisms have none"},
      });
  // two edges of a corner turned towards each other, each within a quarter of its length
  RobotSpec folded = physical_robot(quadratic_block({1, 1, 1}, {1, 1, 1}));
  folded.mesh.vertices.resize(10, 3);
  folded.mesh.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0, 0, 0, 0.5, 0.5, 0, 0.5,
      0, 0.5, 0.5;
  folded.mesh.tetrahedra = {{0, 1, 2, 3}};
  folded.mesh.edge_nodes = {{4, 5, 6, 7, 8, 9}};
  folded.mesh.triangles.clear();
  folded.mesh.regions.clear();
  folded.fixed = {{shaped(VertexList{{0, 1, 2}}), {true, true, true}}};
  EXPECT_EQ(refusal(folded), "");
  folded.mesh.vertices.row(4) += 0.24 * Eigen::RowVector3d(-0.8, 0.6, 0);
  folded.mesh.vertices.row(6) += 0.24 * Eigen::RowVector3d(0.6, -0.8, 0);
  EXPECT_NE(refusal(folded).find("1 tetrahedron folds over: the edge nodes make the Jacobian negative; the first is "
                                 "tetrahedron 0 (from 0)"),
            std::string::npos);

  RobotSpec shell = physical_robot(block_mesh({2, 2, 1}, {2, 2, 1}, Split::prisms));
  shell.mesh_options.quadratic = true;
  EXPECT_NE(refusal(shell).find("a mesh with prisms cannot be of order 2"), std::string::npos);
}

}  // namespace
