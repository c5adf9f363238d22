#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin {

namespace {

struct RulePoint {
  Barycentric at;
  double weight;  // the weights sum to 1
};

// The points that give one corner the coordinate 1 - 3 a and the others a.
std::array<Barycentric, 4> around_corners(double a) {
  std::array<Barycentric, 4> points;
  for (int i = 0; i < 4; ++i) points[i] = Barycentric::Constant(a) + (1 - 4 * a) * Barycentric::Unit(i);
  return points;
}

std::array<RulePoint, 14> make_rule() {
  std::array<RulePoint, 14> rule;
  int count = 0;
  for (const Barycentric& at : around_corners(0.31088591926330060980)) rule[count++] = {at, 0.11268792571801585080};
  for (const Barycentric& at : around_corners(0.09273525031089122640)) rule[count++] = {at, 0.07349304311636194954};
  constexpr double a = 0.04550370412564964949;
  for (const auto& [i, j] : tetrahedron_edges)
    rule[count++] = {Barycentric::Constant(a) + (0.5 - 2 * a) * (Barycentric::Unit(i) + Barycentric::Unit(j)),
                     0.04254602077708146644};
  return rule;
}

const std::array<RulePoint, 14>& rule_of_degree_5() {
  static const std::array<RulePoint, 14> rule = make_rule();
  return rule;
}

double jacobian(const TetrahedronNodes& nodes, const Barycentric& l) {
  const Eigen::Matrix<double, 3, 4> along = nodes.transpose() * quadratic_slope(l);
  return (along.rightCols<3>().colwise() - along.col(0)).determinant();
}

std::array<TrianglePoint, 6> make_triangle_rule() {
  constexpr double a = 0.44594849091596488632, of_a = 0.22338158967801146570 / 2;
  constexpr double b = 0.09157621350977074346, of_b = 0.10995174365532186764 / 2;
  return {triangle_point(a, a, of_a), triangle_point(1 - 2 * a, a, of_a), triangle_point(a, 1 - 2 * a, of_a),
          triangle_point(b, b, of_b), triangle_point(1 - 2 * b, b, of_b), triangle_point(b, 1 - 2 * b, of_b)};
}

}  // namespace

TrianglePoint triangle_point(double u, double v, double weight) {
  const double t = 1 - u - v;
  TrianglePoint point;
  point.shape << t * (2 * t - 1), u * (2 * u - 1), v * (2 * v - 1), 4 * t * u, 4 * u * v, 4 * v * t;
  point.along_u << 1 - 4 * t, 4 * u - 1, 0, 4 * (t - u), 4 * v, -4 * v;
  point.along_v << 1 - 4 * t, 0, 4 * v - 1, -4 * u, 4 * u, 4 * (t - v);
  point.weight = weight;
  return point;
}

TetrahedronNodes nodes_of(const Points& vertices, const Tetrahedron& element, const EdgeNodes& edge_nodes) {
  TetrahedronNodes nodes;
  for (int i = 0; i < 4; ++i) nodes.row(i) = vertices.row(element[i]);
  for (int i = 0; i < 6; ++i) nodes.row(i + 4) = vertices.row(edge_nodes[i]);
  return nodes;
}

TetrahedronWeights quadratic_shape(const Barycentric& l) {
  TetrahedronWeights shape;
  for (int i = 0; i < 4; ++i) shape[i] = l[i] * (2 * l[i] - 1);
  for (int e = 0; e < 6; ++e) shape[e + 4] = 4 * l[tetrahedron_edges[e][0]] * l[tetrahedron_edges[e][1]];
  return shape;
}

Eigen::Matrix<double, 10, 4> quadratic_slope(const Barycentric& l) {
  Eigen::Matrix<double, 10, 4> slope = Eigen::Matrix<double, 10, 4>::Zero();
  for (int i = 0; i < 4; ++i) slope(i, i) = 4 * l[i] - 1;
  for (int e = 0; e < 6; ++e) {
    const auto& [i, j] = tetrahedron_edges[e];
    slope(e + 4, i) = 4 * l[j];
    slope(e + 4, j) = 4 * l[i];
  }
  return slope;
}

TetrahedronWeights shape_integrals(const TetrahedronNodes& nodes) {
  TetrahedronWeights integrals = TetrahedronWeights::Zero();
  for (const RulePoint& point : rule_of_degree_5())
    integrals += point.weight / 6 * jacobian(nodes, point.at) * quadratic_shape(point.at);
  return integrals;
}

double min_jacobian(const TetrahedronNodes& nodes) {
  constexpr double degree_2 = 0.13819660112501051518;  // (5 - sqrt 5) / 20
  double least = std::numeric_limits<double>::infinity();
  const auto visit = [&](const Barycentric& l) { least = std::min(least, jacobian(nodes, l)); };
  for (const Barycentric& corner : around_corners(0)) visit(corner);
  for (const Barycentric& point : around_corners(degree_2)) visit(point);
  for (const RulePoint& point : rule_of_degree_5()) visit(point.at);
  return least;
}

double min_jacobian_bound(const TetrahedronNodes& nodes) {
  Mat3 at[4];  // the derivatives are linear: these at the corners say all of them
  for (int i = 0; i < 4; ++i) {
    const Eigen::Matrix<double, 3, 4> along = nodes.transpose() * quadratic_slope(Barycentric::Unit(i));
    at[i] = along.rightCols<3>().colwise() - along.col(0);
  }
  const auto mixed = [&](int i, int j, int k) { return at[i].col(0).dot(at[j].col(1).cross(at[k].col(2))); };
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i)
    for (int j = i; j < 4; ++j)
      for (int k = j; k < 4; ++k)
        least = std::min(
            least,
            (mixed(i, j, k) + mixed(i, k, j) + mixed(j, i, k) + mixed(j, k, i) + mixed(k, i, j) + mixed(k, j, i)) / 6);
  return least;
}

const std::array<TrianglePoint, 6>& triangle_rule() {
  static const std::array<TrianglePoint, 6> rule = make_triangle_rule();
  return rule;
}

Eigen::Matrix<double, 6, 1> shape_integrals(const TriangleNodes& nodes) {
  Eigen::Matrix<double, 6, 1> integrals = Eigen::Matrix<double, 6, 1>::Zero();
  for (const TrianglePoint& point : triangle_rule()) {
    const Vec3 u = nodes.transpose() * point.along_u, v = nodes.transpose() * point.along_v;
    integrals += point.weight * u.cross(v).norm() * point.shape;
  }
  return integrals;
}

}  // namespace softkin
