#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <random>
#include <softkin/model/mesh/mesh_check.hpp>
#include <utility>
#include <vector>

namespace softkin {
namespace {

Points points(std::initializer_list<Vec3> list) {
  Points result(list.size(), 3);
  Index i = 0;
  for (const Vec3& p : list) result.row(i++) = p.transpose();
  return result;
}

void append(Mesh& mesh, const Points& more) {
  Points all(mesh.vertices.rows() + more.rows(), 3);
  all << mesh.vertices, more;
  mesh.vertices = all;
}

double det(const Points& p, const Tetrahedron& t) {
  const Vec3 a = p.row(t[1]) - p.row(t[0]), b = p.row(t[2]) - p.row(t[0]), c = p.row(t[3]) - p.row(t[0]);
  return a.dot(b.cross(c));
}

/// Six tetrahedra (one per order of the axes) over corners numbered x + 2 y + 4 z; `corner` gives the vertex.
template <class Corner>
void add_cube(Mesh& mesh, const Corner& corner) {
  int axes[3] = {1, 2, 4};
  do {
    Tetrahedron t = {corner(0), corner(axes[0]), corner(axes[0] + axes[1]), corner(7)};
    if (det(mesh.vertices, t) < 0) std::swap(t[2], t[3]);
    mesh.tetrahedra.push_back(t);
  } while (std::next_permutation(axes, axes + 3));
}

Points cube_corners(const Vec3& low) {
  Points p(8, 3);
  for (int i = 0; i < 8; ++i) p.row(i) = (low + Vec3(i & 1, i >> 1 & 1, i >> 2 & 1)).transpose();
  return p;
}

Mesh cube_of_six() {
  Mesh mesh;
  mesh.vertices = cube_corners(Vec3::Zero());
  add_cube(mesh, [](int i) { return i; });
  return mesh;
}

Mesh cube_of_five() {
  Mesh mesh;
  mesh.vertices = cube_corners(Vec3::Zero());
  mesh.tetrahedra = {{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}};
  for (Tetrahedron& t : mesh.tetrahedra)
    if (det(mesh.vertices, t) < 0) std::swap(t[2], t[3]);
  return mesh;
}

/// The unit cube and a second one at `offset`, sharing the corners that coincide.
Mesh two_cubes(const Vec3& offset) {
  Mesh mesh = cube_of_six();
  std::vector<Index> corner(8, -1);
  const Points second = cube_corners(offset);
  for (Index i = 0; i < 8; ++i)
    for (Index j = 0; j < 8; ++j)
      if ((second.row(i) - mesh.vertices.row(j)).norm() < 1e-12) corner[i] = j;
  for (Index i = 0; i < 8; ++i) {
    if (corner[i] >= 0) continue;
    corner[i] = mesh.vertices.rows();
    append(mesh, second.row(i));
  }
  add_cube(mesh, [&](int i) { return corner[i]; });
  return mesh;
}

Mesh regular_prism(double height) {
  Mesh mesh;
  const double y = std::sqrt(3.0) / 2;
  mesh.vertices = points({{0, 0, 0}, {1, 0, 0}, {0.5, y, 0}, {0, 0, height}, {1, 0, height}, {0.5, y, height}});
  mesh.prisms = {{0, 1, 2, 3, 4, 5}};
  return mesh;
}

/// Nothing is wrong but what the caller has looked at and cleared.
void expect_clean(const MeshCheck& check, std::size_t parts = 1) {
  EXPECT_TRUE(check.negative.empty());
  EXPECT_TRUE(check.degenerate.empty());
  EXPECT_TRUE(check.duplicate_elements.empty());
  EXPECT_TRUE(check.duplicate_vertices.empty());
  EXPECT_TRUE(check.unreferenced.empty());
  EXPECT_TRUE(check.overlapping.empty());
  EXPECT_TRUE(check.nonmanifold_faces.empty());
  EXPECT_TRUE(check.nonmanifold_quads.empty());
  EXPECT_TRUE(check.nonmanifold_edges.empty());
  EXPECT_TRUE(check.nonmanifold_vertices.empty());
  EXPECT_EQ(check.parts.size(), parts);
}

using Indices = std::vector<Index>;
using Edges = std::vector<std::array<Index, 2>>;

TEST(MeshCheck, SoundMeshesAreClean) {
  expect_clean(check_mesh(cube_of_five()));
  expect_clean(check_mesh(cube_of_six()));
  expect_clean(check_mesh(two_cubes({1, 0, 0})));
  expect_clean(check_mesh(regular_prism(2)));
  expect_clean(check_mesh(Mesh{}), 0);
}

TEST(MeshCheck, ScaleAndPlaceDoNotMatter) {
  for (const double scale : {1e-150, 1e-6, 1e6, 1e300}) {
    Mesh mesh = two_cubes({1, 0, 0});
    mesh.vertices *= scale;
    expect_clean(check_mesh(mesh));
  }
  Mesh mesh = cube_of_five();
  mesh.vertices.rowwise() += Eigen::RowVector3d(1e5, -1e5, 1e5);
  expect_clean(check_mesh(mesh));
}

TEST(MeshCheck, ReversedElements) {
  Mesh mesh = cube_of_six();
  std::swap(mesh.tetrahedra[2][0], mesh.tetrahedra[2][1]);
  std::swap(mesh.tetrahedra[5][1], mesh.tetrahedra[5][3]);
  MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.negative, (Indices{2, 5}));
  EXPECT_EQ(check.quality, check_mesh(cube_of_six()).quality);
  check.negative.clear();
  expect_clean(check);
}

TEST(MeshCheck, ReversedPrismCountsAfterTheTetrahedra) {
  Mesh mesh = cube_of_five();
  append(mesh, regular_prism(1).vertices.rowwise() + Eigen::RowVector3d(3, 0, 0));
  mesh.prisms = {{8, 9, 10, 11, 12, 13}, {11, 12, 13, 8, 9, 10}};
  MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.negative, (Indices{6}));
  EXPECT_EQ(check.duplicate_elements, (Indices{6}));
  check.negative.clear();
  check.duplicate_elements.clear();
  expect_clean(check, 2);
}

TEST(MeshCheck, Slivers) {
  // volume 1/6 * height over an edge of 1: the limit 1e-9 lies at a height of 6e-9
  for (const auto& [height, flat] : {std::pair{5e-9, true}, std::pair{-5e-9, true}, std::pair{2e-8, false}}) {
    Mesh mesh;
    mesh.vertices = points({{0, 0, 0}, {1, 0, 0}, {0.5, 0.8, 0}, {0.5, 0.3, height}});
    mesh.tetrahedra = {{0, 1, 2, 3}};
    const double limit = 1e-9 / (1.0 / 6 * 0.8);
    ASSERT_EQ(std::abs(height) < limit, flat);
    MeshCheck check = check_mesh(mesh);
    EXPECT_EQ(check.degenerate, flat ? Indices{0} : Indices{}) << height;
    EXPECT_LT(check.quality[0], 1e-6);
    check.degenerate.clear();
    expect_clean(check);
  }
}

TEST(MeshCheck, ElementWithARepeatedVertexIsDegenerate) {
  Mesh mesh = cube_of_five();
  mesh.tetrahedra.push_back({0, 1, 3, 3});
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.degenerate, (Indices{5}));
  EXPECT_EQ(check.quality[5], 0);
  mesh.tetrahedra.back() = {0, 0, 0, 0};
  EXPECT_EQ(check_mesh(mesh).degenerate, (Indices{5}));
}

TEST(MeshCheck, FoldedPrism) {
  Mesh mesh = regular_prism(1);
  mesh.vertices(3, 2) = -0.1;  // one upright edge points down; the volume stays positive
  ASSERT_GT(signed_volume(mesh.vertices, mesh.prisms[0]), 0.1);
  EXPECT_EQ(check_mesh(mesh).degenerate, (Indices{0}));
  EXPECT_EQ(check_mesh(mesh).quality[0], 0);
  std::swap(mesh.prisms[0][1], mesh.prisms[0][2]);
  std::swap(mesh.prisms[0][4], mesh.prisms[0][5]);
  const MeshCheck reversed = check_mesh(mesh);
  EXPECT_EQ(reversed.degenerate, (Indices{0}));
  EXPECT_TRUE(reversed.negative.empty());
  EXPECT_EQ(check_mesh(regular_prism(0)).degenerate, (Indices{0}));
}

TEST(MeshCheck, DuplicateElements) {
  Mesh mesh = cube_of_six();
  mesh.tetrahedra.push_back(mesh.tetrahedra[1]);
  std::rotate(mesh.tetrahedra[6].begin(), mesh.tetrahedra[6].begin() + 2, mesh.tetrahedra[6].end());
  mesh.tetrahedra.push_back(mesh.tetrahedra[1]);
  MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.duplicate_elements, (Indices{6, 7}));
  check.duplicate_elements.clear();
  expect_clean(check);
}

TEST(MeshCheck, DuplicatedLayerOfVertices) {
  // two cubes that should share a face, each with vertices of its own there
  Mesh mesh = cube_of_six();
  append(mesh, cube_corners({1, 0, 0}));
  add_cube(mesh, [](int i) { return i + 8; });
  MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.duplicate_vertices, (Indices{8, 10, 12, 14}));
  ASSERT_EQ(check.parts.size(), 2u);
  EXPECT_EQ(check.parts[0], (Indices{0, 1, 2, 3, 4, 5, 6, 7}));
  check.duplicate_vertices.clear();
  expect_clean(check, 2);
}

TEST(MeshCheck, DuplicateVerticesAgreeWithBruteForce) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1), direction(-1, 1);
  const Index count = 1500;
  Mesh mesh;
  mesh.vertices.resize(count, 3);
  for (Index i = 0; i < count; ++i) {
    const bool twin = i > 10 && uniform(random) < 0.5;
    const Index other = uniform(random) * i;
    const Vec3 shift = Vec3(direction(random), direction(random), direction(random)).normalized();
    // clearly within or clearly beyond 1e-9 of the diagonal sqrt(3)
    const double distance = uniform(random) < 0.5 ? 0.8e-9 * std::sqrt(3.0) : 3e-9 * std::sqrt(3.0);
    for (int axis = 0; axis < 3; ++axis)
      mesh.vertices(i, axis) = twin ? mesh.vertices(other, axis) + distance * shift[axis] : uniform(random);
  }
  mesh.vertices.row(0).setZero();
  mesh.vertices.row(1).setOnes();
  const Vec3 size = (mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff()).transpose();
  Indices expected;
  std::vector<bool> is_twin(count, false);
  for (Index i = 0; i < count; ++i)
    for (Index j = 0; j < i && !is_twin[i]; ++j)
      if (!is_twin[j] && (mesh.vertices.row(i) - mesh.vertices.row(j)).norm() < 1e-9 * size.norm()) {
        is_twin[i] = true;
        expected.push_back(i);
      }
  ASSERT_GT(expected.size(), 100u);
  EXPECT_EQ(check_mesh(mesh).duplicate_vertices, expected);
}

TEST(MeshCheck, UnreferencedVertices) {
  Mesh mesh = cube_of_five();
  append(mesh, points({{0.5, 0.5, 2}, {0.25, 0.5, 2}}));
  MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.unreferenced, (Indices{8, 9}));
  EXPECT_EQ(check.parts[0].size(), 8u);
  check.unreferenced.clear();
  expect_clean(check);
}

TEST(MeshCheck, FoldedPairOverlaps) {
  Mesh mesh;
  mesh.vertices = points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 1}, {0.3, 0.3, 0.7}});
  mesh.tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.overlapping, (Edges{{0, 1}}));
  EXPECT_TRUE(check.nonmanifold_faces.empty());
  mesh.vertices(4, 2) = -0.7;  // unfolded
  mesh.tetrahedra[1] = {0, 2, 1, 4};
  expect_clean(check_mesh(mesh));
}

TEST(MeshCheck, FoldedPrismPairOverlaps) {
  Mesh mesh = regular_prism(1);
  const Points base = mesh.vertices;
  append(mesh, points({{0.5, 0.5, 0}, {0.5, 0.5, 1}}));  // on the same side of the quad 0 1 4 3
  mesh.prisms.push_back({0, 1, 6, 3, 4, 7});
  EXPECT_EQ(check_mesh(mesh).overlapping, (Edges{{0, 1}}));
  mesh.vertices(6, 1) = mesh.vertices(7, 1) = -0.5;
  mesh.prisms[1] = {1, 0, 6, 4, 3, 7};
  expect_clean(check_mesh(mesh));
}

TEST(MeshCheck, FaceOfThreeElements) {
  Mesh mesh;
  mesh.vertices = points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 1}, {0.3, 0.3, 0.7}, {0.3, 0.3, -1}});
  mesh.tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 2, 1, 5}};
  const MeshCheck check = check_mesh(mesh);
  ASSERT_EQ(check.nonmanifold_faces.size(), 1u);
  Triangle face = check.nonmanifold_faces[0];
  std::sort(face.begin(), face.end());
  EXPECT_EQ(face, (Triangle{0, 1, 2}));
  EXPECT_EQ(check.overlapping, (Edges{{0, 1}}));
}

TEST(MeshCheck, QuadOfThreePrisms) {
  Mesh mesh = regular_prism(1);
  append(mesh, points({{0.5, 0.5, 0}, {0.5, 0.5, 1}, {0.5, -0.5, 0}, {0.5, -0.5, 1}}));
  mesh.prisms.push_back({0, 1, 6, 3, 4, 7});
  mesh.prisms.push_back({1, 0, 8, 4, 3, 9});
  const MeshCheck check = check_mesh(mesh);
  ASSERT_EQ(check.nonmanifold_quads.size(), 1u);
  Quad face = check.nonmanifold_quads[0];
  std::sort(face.begin(), face.end());
  EXPECT_EQ(face, (Quad{0, 1, 3, 4}));
}

TEST(MeshCheck, CubesThatTouchAtAnEdge) {
  MeshCheck check = check_mesh(two_cubes({1, 1, 0}));
  EXPECT_EQ(check.nonmanifold_edges, (Edges{{3, 7}}));
  check.nonmanifold_edges.clear();
  expect_clean(check);
}

TEST(MeshCheck, CubesThatTouchAtAVertex) {
  MeshCheck check = check_mesh(two_cubes({1, 1, 1}));
  EXPECT_EQ(check.nonmanifold_vertices, (Indices{7}));
  check.nonmanifold_vertices.clear();
  expect_clean(check);
}

TEST(MeshCheck, PartsLargestFirst) {
  Mesh mesh;
  mesh.vertices = points({{5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}});
  mesh.tetrahedra = {{0, 1, 2, 3}};
  append(mesh, cube_corners(Vec3::Zero()));
  add_cube(mesh, [](int i) { return i + 4; });
  MeshCheck check = check_mesh(mesh);
  ASSERT_EQ(check.parts.size(), 2u);
  EXPECT_EQ(check.parts[0], (Indices{4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(check.parts[1], (Indices{0, 1, 2, 3}));
  expect_clean(check, 2);
}

TEST(MeshCheck, QualityOfKnownShapes) {
  Mesh mesh;
  mesh.vertices =
      points({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, {10, 0, 0}, {11, 0, 0}, {10, 1, 0}, {10, 0, 1}});
  mesh.tetrahedra = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const MeshCheck check = check_mesh(mesh);
  EXPECT_NEAR(check.quality[0], 1, 1e-12);
  // unit corner: inradius 1 / (3 + sqrt 3), circumradius sqrt(3) / 2
  EXPECT_NEAR(check.quality[1], std::sqrt(3.0) - 1, 1e-12);
}

TEST(MeshCheck, QualityOfPrisms) {
  EXPECT_NEAR(check_mesh(regular_prism(0.1)).quality[0], 1, 1e-12);
  EXPECT_NEAR(check_mesh(regular_prism(7)).quality[0], 1, 1e-12);
  Mesh right = regular_prism(1);
  right.vertices = points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
  EXPECT_NEAR(check_mesh(right).quality[0], std::sqrt(2.0 / 3), 1e-12);  // sin 45 / sin 60
  Mesh sheared = regular_prism(1);
  for (Index i = 3; i < 6; ++i) sheared.vertices(i, 1) += 1;  // upright edges lean by 45 degrees
  EXPECT_NEAR(check_mesh(sheared).quality[0], std::sqrt(0.5), 1e-12);
}

}  // namespace
}  // namespace softkin
