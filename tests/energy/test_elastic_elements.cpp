#include <gtest/gtest.h>

#include <array>
#include <softkin/core/error.hpp>
#include <string>

#include "elastic_samples.hpp"

namespace softkin::energy {

namespace {

constexpr int tetrahedron_edge[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

template <class ElementKind>
class ElasticElements : public ::testing::Test {};
using Kinds = testing::Types<Kind<4, 1>, Kind<10, 4>, Kind<6, 6>>;
TYPED_TEST_SUITE(ElasticElements, Kinds);

/// Forces at all nodes of a mesh [N].
template <int K, int Q>
Eigen::MatrixX3d assemble(const ElasticLaw& law, const Eigen::MatrixX3d& rest, const Eigen::MatrixX3d& current,
                          const std::vector<std::array<int, K>>& elements) {
  Eigen::MatrixX3d total = Eigen::MatrixX3d::Zero(rest.rows(), 3);
  for (const std::array<int, K>& element : elements) {
    Sample<K, Q> sample;
    set_law(sample.block.law, law);
    for (int l = 0; l < lanes; ++l) sample.set(l, rest(element, Eigen::all), current(element, Eigen::all));
    const Nodes<K> gradient = gradient_of(force_of(sample.block, sample.current), 5);
    for (int a = 0; a < K; ++a) total.row(element[a]) += gradient.row(a);
  }
  return total;
}

/// A stretched, sheared and turned copy.
Eigen::MatrixX3d stretched(const Eigen::MatrixX3d& rest, Random& random) {
  return (rest * random.deformation(false).transpose()).rowwise() + Eigen::RowVector3d(7, 8, -9);
}

/// A tetrahedron (nodes 0 to 3) divided at an inner point (node 4).
Eigen::MatrixX3d divided_tetrahedron(Random& random, std::vector<std::array<int, 4>>& elements) {
  Eigen::MatrixX3d nodes(5, 3);
  nodes.topRows(4) = sample_rest<4>(random);
  nodes.row(4) = Eigen::RowVector4d(0.3, 0.2, 0.4, 0.1) * nodes.topRows(4);
  elements = {{4, 1, 2, 3}, {0, 4, 2, 3}, {0, 1, 4, 3}, {0, 1, 2, 4}};
  return nodes;
}

template <int K, int Q>
void expect_no_force_inside(const Eigen::MatrixX3d& rest, const std::vector<std::array<int, K>>& elements,
                            const std::vector<int>& inside, Random& random) {
  for (const Law law : all_laws) {
    const Eigen::MatrixX3d current = stretched(rest, random);
    const Eigen::MatrixX3d force = assemble<K, Q>(sample_law(law), rest, current, elements);
    EXPECT_GT(force.norm(), 0.1);
    for (const int node : inside) EXPECT_LT(force.row(node).norm(), 1e-13 * force.norm()) << node;
  }
}

}  // namespace

TYPED_TEST(ElasticElements, SlopesReproduceLinearFieldsAndVolumesAreScaledBySize) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    const Nodes<K> rest = sample_rest<K>(random, K == 10 ? 0.04 : 0.1);
    const ElasticRest<K, Q> element = elastic_rest(rest), twice = elastic_rest(Nodes<K>(2 * rest));
    for (int q = 0; q < Q; ++q) {
      const Mat3 identity = rest.transpose() * element.slope[q];
      EXPECT_LT((identity - Mat3::Identity()).norm(), 1e-13);
      EXPECT_LT(element.slope[q].colwise().sum().norm(), 1e-13);
      EXPECT_NEAR(twice.volume[q], 8 * element.volume[q], 1e-12);
    }
  }
}

TEST(ElasticRest, VolumesAddUpToTheElements) {
  Random random(2);
  const Nodes<4> t = sample_rest<4>(random);
  const double expected = Mat3(t.bottomRows<3>().rowwise() - t.row(0)).determinant() / 6;
  EXPECT_NEAR(elastic_rest(t).volume[0], expected, 1e-13);

  const Nodes<10> straight = sample_rest<10>(random, 0);
  const auto quadratic = elastic_rest(straight);
  const double corners = Mat3(straight.middleRows<3>(1).rowwise() - straight.row(0)).determinant() / 6;
  for (const double v : quadratic.volume) EXPECT_NEAR(v, corners / 4, 1e-13);

  // a prism with bilinear sides: the divergence theorem with the exact flux of the sides, by both diagonals
  const Nodes<6> p = sample_rest<6>(random);
  const auto six = [&](int a, int b, int c) {
    return p.row(a).transpose().dot(p.row(b).transpose().cross(p.row(c).transpose()));
  };
  double flux = six(0, 2, 1) + six(3, 4, 5);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    flux += (six(i, j, j + 3) + six(i, j + 3, i + 3) + six(i, j, i + 3) + six(j, j + 3, i + 3)) / 2;
  }
  double sum = 0;
  for (const double v : elastic_rest(p).volume) sum += v;
  EXPECT_NEAR(sum, flux / 6, 1e-12);
}

/// F of a quadratic displacement is exact at the points of a tetrahedron with straight edges.
TEST(ElasticRest, QuadraticTetrahedronReproducesQuadraticFields) {
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    Nodes<10> rest = sample_rest<10>(random, 0);
    rest = rest * random.deformation(false);  // not mirrored: volumes stay positive
    for (int e = 0; e < 6; ++e)
      rest.row(4 + e) = 0.5 * (rest.row(tetrahedron_edge[e][0]) + rest.row(tetrahedron_edge[e][1]));
    const Mat3 linear = random.matrix<Mat3>();
    Mat3 quadratic[3];  // x_i = linear_i X + X^T quadratic_i X
    for (Mat3& m : quadratic) {
      const Mat3 any = random.matrix<Mat3>();
      m = any + any.transpose();
    }
    Nodes<10> current = rest * linear.transpose();
    for (int a = 0; a < 10; ++a)
      for (int i = 0; i < 3; ++i) current(a, i) += rest.row(a).dot(rest.row(a) * quadratic[i]);
    const auto element = elastic_rest(rest);
    for (int q = 0; q < 4; ++q) {
      // 0.58541020 and 0.13819660: the rule of C3D10
      Eigen::RowVector4d l = Eigen::RowVector4d::Constant((5 - std::sqrt(5.0)) / 20);
      l[q] = (5 + 3 * std::sqrt(5.0)) / 20;
      const Vec3 x = (l * rest.topRows<4>()).transpose();
      Mat3 expected = linear;
      for (int i = 0; i < 3; ++i) expected.row(i) += (2 * quadratic[i] * x).transpose();
      EXPECT_LT((current.transpose() * element.slope[q] - expected).norm(), 1e-12 * expected.norm());
    }
  }
}

/// The energy density of a small quadratic displacement is quadratic in place: the element's rule is exact, and so is
/// the other one that it is compared with.
TEST(ElasticRest, EnergyOfASmallQuadraticDisplacementIsIntegratedExactly) {
  Random random(4);
  Nodes<10> rest = sample_rest<10>(random, 0);
  Mat3 quadratic[3];
  for (Mat3& m : quadratic) {
    const Mat3 any = random.matrix<Mat3>();
    m = any + any.transpose();
  }
  const double small = 1e-7;
  Nodes<10> current = rest;
  for (int a = 0; a < 10; ++a)
    for (int i = 0; i < 3; ++i) current(a, i) += small * rest.row(a).dot(rest.row(a) * quadratic[i]);
  // linear elastic energy density at barycentric coordinates l
  const auto density = [&](const Eigen::RowVector4d& l) {
    const Vec3 x = (l * rest.topRows<4>()).transpose();
    Mat3 h;
    for (int i = 0; i < 3; ++i) h.row(i) = (2 * small * quadratic[i] * x).transpose();
    const Mat3 strain = 0.5 * (h + h.transpose());
    return sample_mu * strain.squaredNorm() + sample_lambda / 2 * strain.trace() * strain.trace();
  };
  // exact for quadratic polynomials: vertices -1/20, middles of the edges 1/5
  double mean = 0;
  for (int i = 0; i < 4; ++i) mean -= density(Eigen::RowVector4d::Unit(i)) / 20;
  for (const auto& [i, j] : tetrahedron_edge)
    mean += density(0.5 * (Eigen::RowVector4d::Unit(i) + Eigen::RowVector4d::Unit(j))) / 5;
  const double volume = Mat3(rest.middleRows<3>(1).rowwise() - rest.row(0)).determinant() / 6;
  Sample<10, 4> sample;
  set_law(sample.block.law, sample_law(Law::st_venant_kirchhoff));
  for (int l = 0; l < lanes; ++l) sample.set(l, rest, current);
  const double energy = force_of(sample.block, sample.current).energy[0];
  EXPECT_NEAR(energy / (volume * mean), 1, 1e-5);  // small is not zero
  EXPECT_GT(energy, 0);
}

TEST(ElasticPatch, LinearTetrahedra) {
  Random random(5);
  std::vector<std::array<int, 4>> elements;
  const Eigen::MatrixX3d rest = divided_tetrahedron(random, elements);
  expect_no_force_inside<4, 1>(rest, elements, {4}, random);
}

TEST(ElasticPatch, QuadraticTetrahedra) {
  Random random(6);
  std::vector<std::array<int, 4>> corners;
  Eigen::MatrixX3d nodes = divided_tetrahedron(random, corners);
  Eigen::MatrixXi middle = Eigen::MatrixXi::Constant(5, 5, -1);
  std::vector<std::array<int, 10>> elements;
  std::vector<int> inside{4};
  for (const auto& c : corners) {
    std::array<int, 10> element;
    std::copy(c.begin(), c.end(), element.begin());
    for (int e = 0; e < 6; ++e) {
      const int i = std::min(c[tetrahedron_edge[e][0]], c[tetrahedron_edge[e][1]]);
      const int j = std::max(c[tetrahedron_edge[e][0]], c[tetrahedron_edge[e][1]]);
      if (middle(i, j) < 0) {
        middle(i, j) = static_cast<int>(nodes.rows());
        nodes.conservativeResize(nodes.rows() + 1, 3);
        nodes.bottomRows(1) = 0.5 * (nodes.row(i) + nodes.row(j));
        if (j == 4) inside.push_back(middle(i, j));
      }
      element[4 + e] = middle(i, j);
    }
    elements.push_back(element);
  }
  ASSERT_EQ(inside.size(), 5u);
  expect_no_force_inside<10, 4>(nodes, elements, inside, random);
}

TEST(ElasticPatch, TwoLayersOfPrismsAboutAnInnerNode) {
  Random random(7);
  Eigen::MatrixX3d nodes(12, 3);  // three levels of a triangle and its inner point
  for (int level = 0; level < 3; ++level) {
    nodes.middleRows(4 * level, 4) << 0, 0, level, 3, 0, level, 0, 2, level, 0.9, 0.7, level;
  }
  nodes += 0.1 * random.matrix<Eigen::Matrix<double, 12, 3>>();
  std::vector<std::array<int, 6>> elements;
  for (const int base : {0, 4})
    for (const auto& [i, j] : {std::array{0, 1}, std::array{1, 2}, std::array{2, 0}})
      elements.push_back({base + i, base + j, base + 3, base + 4 + i, base + 4 + j, base + 7});
  expect_no_force_inside<6, 6>(nodes, elements, {7}, random);
}

TEST(ElasticRest, ElementsWithoutVolumeAreRefusedByName) {
  Nodes<4> flat;
  flat << 1, 2, 3, 2, 2, 3, 1, 3, 3, 5, 5, 3;
  Nodes<4> mirrored;
  mirrored << 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1;
  Nodes<6> layer;
  layer << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0;
  Random random(8);
  Nodes<10> folded = sample_rest<10>(random, 0);
  folded.row(4) += 3 * (folded.row(3) - folded.row(0));
  EXPECT_THROW((void)elastic_rest(mirrored), InvalidInput);
  EXPECT_THROW((void)elastic_rest(layer), InvalidInput);
  EXPECT_THROW((void)elastic_rest(folded), InvalidInput);
  EXPECT_THROW((void)elastic_rest(Nodes<4>(mirrored * std::nan(""))), InvalidInput);
  EXPECT_THROW((void)layer_frame(Nodes<6>(Nodes<6>::Zero())), InvalidInput);
  try {
    (void)elastic_rest(flat);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("(1.000000, 2.000000, 3.000000)"), std::string::npos) << error.what();
  }
}

TEST(LayerFrame, ThirdAxisIsTheCommonNormalFromBottomToTop) {
  Random random(9);
  Nodes<6> layer;
  layer << 0, 0, 0, 2, 0, 0, 0, 1, 0, 0.1, 0.2, 0.3, 2.1, 0.2, 0.3, 0.1, 1.2, 0.3;
  for (int round = 0; round < 10; ++round) {
    const Mat3 r = random.rotation();
    const Mat3 frame = layer_frame(Nodes<6>(layer * r.transpose()));
    EXPECT_LT((frame.transpose() * frame - Mat3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(frame.determinant(), 1, 1e-14);
    EXPECT_LT((frame.col(2) - r.col(2)).norm(), 1e-14);
  }
  Nodes<6> wedge = layer;  // the mean of both normals
  wedge.bottomRows<3>() << 0, 0, 1, 2, 0, 1, 0, 1, 1.5;
  const Vec3 expected = (Vec3(0, 0, 2) + Vec3(0, -1, 2)).normalized();
  EXPECT_LT((layer_frame(wedge).col(2) - expected).norm(), 1e-14);
}

/// F = F_e F_a with F_a in the slopes: the stretched shape F_a X is free of stress.
TYPED_TEST(ElasticElements, ActiveStretchInTheSlopesMovesTheRestState) {
  constexpr int K = TypeParam::K, Q = TypeParam::Q;
  Random random(10);
  const Mat3 active = Vec3(1.3, 1.3, 1 / 1.69).asDiagonal();
  for (const Law law : all_laws) {
    auto sample = random_sample<K, Q>(law, random);
    for (int l = 0; l < lanes; ++l) {
      ElasticRest<K, Q> element = elastic_rest(sample.rest[l]);
      for (auto& slope : element.slope) slope = (slope * active.inverse()).eval();
      set_lane(sample.block, l, element);
      sample.current[l] = sample.rest[l] * active * random.rotation();
    }
    const ElasticForce<K> force = force_of(sample.block, sample.current);
    for (int l = 0; l < lanes; ++l) {
      EXPECT_NEAR(force.energy[l], 0, 1e-13);
      EXPECT_LT(gradient_of(force, l).norm(), 1e-13);
    }
  }
}

}  // namespace softkin::energy
