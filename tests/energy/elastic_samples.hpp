#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/energy/elastic.hpp>
#include <vector>

namespace softkin::energy {

template <int K>
using Nodes = Eigen::Matrix<double, K, 3>;

/// An element kind: K nodes, Q quadrature points.
template <int K_, int Q_>
struct Kind {
  static constexpr int K = K_, Q = Q_;
};

/// Constants with the same Lame constants mu = 0.7, lambda = 1.9 MPa at rest for every law.
inline constexpr double sample_mu = 0.7, sample_lambda = 1.9;
inline ElasticLaw sample_law(Law law) {
  ElasticLaw e;
  e.law = law;
  if (law == Law::gent) {
    e.mu = sample_mu;
    e.bulk = sample_lambda + 2 * sample_mu / 3;
    e.jm = 9;
  } else if (law == Law::ogden) {
    e.bulk = sample_lambda + 2 * sample_mu / 3;
    e.ogden[0] = {0.3, 2.6};
    e.ogden[1] = {-0.15, -1.7};
    e.ogden[2] = {(2 * sample_mu - 0.3 * 2.6 - 0.15 * 1.7) / 5, 5};
  } else if (forbids_inversion(law)) {
    e.bulk = sample_lambda + 2 * sample_mu / 3;
    e.c01 = law == Law::mooney_rivlin ? 0.11 : 0;
    e.c10 = sample_mu / 2 - e.c01;
    if (law == Law::yeoh) e.c20 = 0.05, e.c30 = 0.013;
  } else {
    e.mu = sample_mu;
    e.lambda = sample_lambda;
  }
  return e;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double normal() { return normal_(engine_); }
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  template <class Matrix>
  Matrix matrix() {
    return Matrix::NullaryExpr([&] { return normal(); });
  }
  Mat3 rotation() { return Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().toRotationMatrix(); }
  /// Returns three unequal stretches of 0.6 to 1.7 in random directions. mirrored: the last one is negative
  Mat3 deformation(bool mirrored) {
    const Vec3 s(between(1.3, 1.7), between(0.9, 1.2), between(0.6, 0.8) * (mirrored ? -1 : 1));
    return rotation() * s.asDiagonal() * rotation();
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

template <int K>
Nodes<K> sample_rest(Random& random, double distortion = 0.1) {
  Nodes<K> p;
  if constexpr (K == 6) {
    p << 0, 0, 0, 3, 0, 0, 0, 2, 0, 0.1, 0, 1.5, 3, 0.2, 1.4, 0, 2, 1.6;
  } else {
    p.template topRows<4>() << 1, 0.5, 0, 3, 0.4, 0.2, 1, 2, -0.1, 1.5, 1, 2;
  }
  if constexpr (K == 10) {
    constexpr int edge[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
    for (int e = 0; e < 6; ++e) p.row(4 + e) = 0.5 * (p.row(edge[e][0]) + p.row(edge[e][1]));
  }
  return p + distortion * random.matrix<Nodes<K>>();
}

inline void set_lane(Pack3& pack3, int lane, const Vec3& value) {
  pack3.x[lane] = value.x();
  pack3.y[lane] = value.y();
  pack3.z[lane] = value.z();
}

inline Vec3 get_lane(const Pack3& pack3, int lane) {
  return {pack3.x[lane], pack3.y[lane], pack3.z[lane]};
}

template <int K, int Q>
void set_lane(ElasticBlock<K, Q>& block, int lane, const ElasticRest<K, Q>& rest) {
  for (int q = 0; q < Q; ++q) {
    block.volume[q][lane] = rest.volume[q];
    for (int a = 0; a < K; ++a) set_lane(block.slope[q][a], lane, rest.slope[q].row(a).transpose());
  }
}

inline void set_law(LawBlock& block, const ElasticLaw& law) {
  for (int lane = 0; lane < lanes; ++lane) set_law(block, lane, law);
}

/// Eight elements at rest and the shapes that they now have.
template <int K, int Q>
struct Sample {
  ElasticBlock<K, Q> block;
  std::vector<Nodes<K>> rest{lanes}, current{lanes};

  void set(int lane, const Nodes<K>& rest_nodes, const Nodes<K>& nodes) {
    rest[lane] = rest_nodes;
    current[lane] = nodes;
    set_lane(block, lane, elastic_rest(rest_nodes));
  }
};

/// Random elements with large random stretches and some noise. mirrored: every second lane is inverted
template <int K, int Q>
Sample<K, Q> random_sample(Law law, Random& random, bool mirrored = false, double noise = 0.05) {
  Sample<K, Q> sample;
  set_law(sample.block.law, sample_law(law));
  for (int l = 0; l < lanes; ++l) {
    const Nodes<K> rest = sample_rest<K>(random, K == 10 ? 0.04 : 0.1);
    const Nodes<K> moved = rest * random.deformation(mirrored && l % 2).transpose();
    const Nodes<K> shaken = moved + noise * random.matrix<Nodes<K>>();
    sample.set(l, rest, shaken.rowwise() + 10 * random.matrix<Eigen::RowVector3d>());
  }
  return sample;
}

template <int K>
void pack_nodes(const std::vector<Nodes<K>>& nodes, Shape<K>& shape) {
  for (int l = 0; l < lanes; ++l)
    for (int a = 0; a < K; ++a) set_lane(shape[a], l, nodes[l].row(a).transpose());
}

template <int K, int Q>
ElasticForce<K> force_of(const ElasticBlock<K, Q>& block, const std::vector<Nodes<K>>& current) {
  Shape<K> shape;
  pack_nodes<K>(current, shape);
  ElasticForce<K> out;
  elastic_force(block, shape, out);
  return out;
}

template <int K>
Nodes<K> gradient_of(const ElasticForce<K>& force, int lane) {
  Nodes<K> g;
  for (int a = 0; a < K; ++a) g.row(a) = get_lane(force.gradient[a], lane).transpose();
  return g;
}

/// Full matrices, node by node, of all lanes.
template <int K, int Q>
std::vector<Eigen::MatrixXd> stiffness_of(const ElasticBlock<K, Q>& block, const std::vector<Nodes<K>>& current,
                                          bool projected = false) {
  Shape<K> shape;
  pack_nodes<K>(current, shape);
  ElasticStiffness<K> out;
  elastic_stiffness(block, shape, projected, out);
  std::vector<Eigen::MatrixXd> k(lanes, Eigen::MatrixXd::Zero(3 * K, 3 * K));
  for (int l = 0; l < lanes; ++l)
    for (int a = 0, ab = 0; a < K; ++a)
      for (int b = 0; b <= a; ++b, ++ab) {
        Mat3 part;
        for (int i = 0; i < 3; ++i) part.row(i) = get_lane(out.block[ab].row[i], l).transpose();
        k[l].block<3, 3>(3 * b, 3 * a) = part.transpose();
        k[l].block<3, 3>(3 * a, 3 * b) = part;
      }
  return k;
}

}  // namespace softkin::energy
