#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/contact/distance.hpp>

namespace softkin::contact {

namespace {

/// A point and an edge among the four: one case of closest boundaries of the features.
struct Side {
  int point, from, to;
  double sign;  // of the point's weight
};

constexpr std::array<Side, 3> triangle_sides{{{0, 1, 2, 1}, {0, 2, 3, 1}, {0, 3, 1, 1}}};
constexpr std::array<Side, 4> edge_sides{{{0, 2, 3, 1}, {1, 2, 3, 1}, {2, 0, 1, -1}, {3, 0, 1, -1}}};

constexpr double smallest = std::numeric_limits<double>::min();

std::uint8_t bit(int node) {
  return static_cast<std::uint8_t>(1u << node);
}

FreeWeight move(const FourPoints& x, int plus, int minus) {
  return {x.col(plus) - x.col(minus), static_cast<std::uint8_t>(plus), static_cast<std::uint8_t>(minus)};
}

struct SidePath {
  double squared = std::numeric_limits<double>::infinity(), fraction = 0;
  Vec3 motion = Vec3::Zero();  // to the side's point
  std::uint8_t nodes = 0;
};

SidePath path_to(const FourPoints& x, const Side& side) {
  const Vec3 edge = x.col(side.to) - x.col(side.from), reach = x.col(side.point) - x.col(side.from);
  const double length = edge.squaredNorm();
  SidePath out;
  out.fraction = length >= smallest ? std::clamp(edge.dot(reach) / length, 0.0, 1.0) : 0;
  // from the end itself, so that it is met exactly
  out.motion = out.fraction < 1 ? Vec3(reach - out.fraction * edge) : Vec3(x.col(side.point) - x.col(side.to));
  out.squared = out.motion.squaredNorm();
  out.nodes = bit(side.point);
  if (out.fraction < 1) out.nodes |= bit(side.from);
  if (out.fraction > 0) out.nodes |= bit(side.to);
  return out;
}

/// The closest of the sides; of several as close the first.
template <std::size_t N>
Separation closest_side(const FourPoints& x, const std::array<Side, N>& sides) {
  std::array<SidePath, N> motions;
  std::size_t closest = 0;
  for (std::size_t k = 0; k < N; ++k) {
    motions[k] = path_to(x, sides[k]);
    if (motions[k].squared < motions[closest].squared) closest = k;
  }
  // A side that is closest between its ends is closer than at them, though rounding may hide by how much: by its
  // square root the gradient would be wrong.
  const std::uint8_t nodes = motions[closest].nodes;
  for (std::size_t k = 0; k < N; ++k)
    if ((motions[k].nodes & nodes) == nodes && motions[k].nodes != nodes) closest = k;
  const Side& side = sides[closest];
  const SidePath& found = motions[closest];
  const double fraction = found.fraction;
  Separation out{found.squared, Eigen::Vector4d::Zero(), side.sign * found.motion, fraction > 0 && fraction < 1, {},
                 found.nodes};
  out.weights[side.point] = side.sign;
  out.weights[side.from] = -side.sign * (1 - fraction);
  out.weights[side.to] = -side.sign * fraction;
  if (out.free == 1) out.moves[0] = side.sign > 0 ? move(x, side.from, side.to) : move(x, side.to, side.from);
  return out;
}

/// Where start + a u + b v is shortest. Cross products instead of the matrix of u and v, whose determinant would lose
/// twice the digits.
struct Crossing {
  double a, b, squared;
  Vec3 vector;
  enum class Trust { none, some, full } trust;
};

Crossing crossing(const Vec3& start, const Vec3& u, const Vec3& v) {
  // squared sines of the angle: below the first rounding decides everything, below the second it is looked at twice
  constexpr double parallel = 1e-26, doubtful = 1e-12;
  const Vec3 normal = u.cross(v);
  const double size = normal.squaredNorm(), scale = u.squaredNorm() * v.squaredNorm();
  if (!(size > parallel * scale && size >= smallest)) return {0, 0, 0, Vec3::Zero(), Crossing::Trust::none};
  const double a = -start.cross(v).dot(normal) / size, b = -u.cross(start).dot(normal) / size;
  const Vec3 s = start + a * u + b * v;
  if (size < doubtful * scale) return {a, b, s.squaredNorm(), s, Crossing::Trust::some};
  const double height = normal.dot(s), fraction = height / size;
  return {a, b, height * fraction, fraction * normal, Crossing::Trust::full};
}

/// Both weights inside, unless a side is closer.
template <std::size_t N>
bool take_inside(const Crossing& inside, const FourPoints& x, const std::array<Side, N>& sides, Separation& out) {
  if (inside.trust == Crossing::Trust::full) return true;
  out = closest_side(x, sides);
  return inside.squared < out.squared;
}

}  // namespace

Separation vertex_triangle(const FourPoints& x) {
  const FreeWeight first = move(x, 1, 2), second = move(x, 1, 3);
  const Crossing at = crossing(x.col(0) - x.col(1), first.along, second.along);
  const bool inside = at.trust != Crossing::Trust::none && at.a > 0 && at.b > 0 && at.a + at.b < 1;
  Separation out;
  if (!inside) return closest_side(x, triangle_sides);
  if (!take_inside(at, x, triangle_sides, out)) return out;
  return {at.squared, {1, at.a + at.b - 1, -at.a, -at.b}, at.vector, 2, {first, second}, 15};
}

Separation vertex_side(const FourPoints& x, int side) {
  return closest_side(x, std::array<Side, 1>{triangle_sides[side]});
}

Separation vertex_corner(const FourPoints& x, int corner) {
  const Vec3 motion = x.col(0) - x.col(1 + corner);
  Separation out{motion.squaredNorm(), Eigen::Vector4d::UnitX(), motion, 0, {}, 0};
  out.weights[1 + corner] = -1;
  out.nodes = static_cast<std::uint8_t>(1 | bit(1 + corner));
  return out;
}

Separation edge_edge(const FourPoints& x) {
  const FreeWeight first = move(x, 1, 0), second = move(x, 2, 3);
  const Crossing at = crossing(x.col(0) - x.col(2), first.along, second.along);
  const bool inside = at.trust != Crossing::Trust::none && at.a > 0 && at.a < 1 && at.b > 0 && at.b < 1;
  Separation out;
  if (!inside) return closest_side(x, edge_sides);
  if (!take_inside(at, x, edge_sides, out)) return out;
  return {at.squared, {1 - at.a, at.a, at.b - 1, -at.b}, at.vector, 2, {first, second}, 15};
}

Gradient squared_gradient(const Separation& separation) {
  Gradient out;
  for (int i = 0; i < 4; ++i) out.segment<3>(3 * i) = 2 * separation.weights[i] * separation.vector;
  return out;
}

Relief relief(const Separation& separation) {
  Relief out = Relief::Zero();
  if (separation.free == 0) return out;
  const auto set = [&](int k, const Eigen::Vector4d& shift, const Vec3& along, double length) {
    const Eigen::Vector4d c = separation.weights / length, p = shift / length;
    for (int i = 0; i < 4; ++i) out.col(k).segment<3>(3 * i) = p[i] * separation.vector + c[i] * along;
  };
  const auto shift_of = [](const FreeWeight& weight) {
    Eigen::Vector4d shift = Eigen::Vector4d::Zero();
    shift[weight.plus] = 1;
    shift[weight.minus] = -1;
    return shift;
  };
  const FreeWeight &first = separation.moves[0], &second = separation.moves[1];
  const double squared = first.along.squaredNorm();
  const Eigen::Vector4d shift = shift_of(first);
  set(0, shift, first.along, std::sqrt(squared));
  if (separation.free == 1) return out;
  // what of the second is across the first; by the normal, as a difference would lose digits
  const Vec3 across = first.along.cross(second.along).cross(first.along) / squared;
  const double parallel = first.along.dot(second.along) / squared;
  set(1, shift_of(second) - parallel * shift, across, across.norm());
  return out;
}

void squared_hessian(const Separation& separation, Hessian& out) {
  const Relief z = relief(separation);
  const Eigen::Vector4d& c = separation.weights;
  for (int column = 0; column < 12; ++column)
    out.col(column) = (-2 * z(column, 0)) * z.col(0) + (-2 * z(column, 1)) * z.col(1);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) out.block<3, 3>(3 * i, 3 * j).diagonal().array() += 2 * c[i] * c[j];
}

double mollifier_threshold(const FourPoints& rest) {
  return 1e-3 * (rest.col(1) - rest.col(0)).squaredNorm() * (rest.col(3) - rest.col(2)).squaredNorm();
}

double mollifier(const FourPoints& x, double threshold) {
  const double size = (x.col(1) - x.col(0)).cross(x.col(3) - x.col(2)).squaredNorm();
  if (!(size < threshold)) return 1;
  const double q = size / threshold;
  return q * (2 - q);
}

double mollifier(const FourPoints& x, double threshold, Gradient& gradient, Hessian& hessian) {
  const Vec3 e = x.col(1) - x.col(0), f = x.col(3) - x.col(2), normal = e.cross(f);
  const double size = normal.squaredNorm();
  if (!(size < threshold)) {
    gradient.setZero();
    hessian.setZero();
    return 1;
  }
  const double q = size / threshold, slope = 2 * (1 - q) / threshold, bend = -2 / (threshold * threshold);
  Eigen::Matrix<double, 6, 1> g;  // of |e x f|^2 in e and f
  g << 2 * f.cross(normal), 2 * normal.cross(e);
  Eigen::Matrix<double, 6, 6> h;
  h.topLeftCorner<3, 3>() = 2 * (f.squaredNorm() * Mat3::Identity() - f * f.transpose());
  h.bottomRightCorner<3, 3>() = 2 * (e.squaredNorm() * Mat3::Identity() - e * e.transpose());
  h.topRightCorner<3, 3>() = 2 * (2 * e * f.transpose() - f * e.transpose() - e.dot(f) * Mat3::Identity());
  h.bottomLeftCorner<3, 3>() = h.topRightCorner<3, 3>().transpose();
  h = slope * h + bend * g * g.transpose();
  for (int i = 0; i < 4; ++i) {
    const double sign = i % 2 == 0 ? -1 : 1;
    gradient.segment<3>(3 * i) = sign * slope * g.segment<3>(3 * (i / 2));
    for (int j = 0; j < 4; ++j)
      hessian.block<3, 3>(3 * i, 3 * j) = (i % 2 == j % 2 ? 1 : -1) * h.block<3, 3>(3 * (i / 2), 3 * (j / 2));
  }
  return mollifier(x, threshold);
}

}  // namespace softkin::contact
