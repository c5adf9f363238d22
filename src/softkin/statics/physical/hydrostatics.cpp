#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/statics/physical/hydrostatics.hpp>
#include <span>
#include <utility>

namespace softkin::physical {

namespace {

using Parameter = Eigen::Vector2d;  // (u, v) of the triangle 0 <= u, v, u + v <= 1
using Nodes6 = Eigen::Matrix<double, 6, 1>;

/// source  D. A. Dunavant, High degree efficient symmetrical Gaussian quadrature rules for the triangle, 1985: degree 6
struct RulePoint {
  double a, b, weight;  // second and third barycentric coordinate; weights sum to 1
};
constexpr RulePoint degree_6[] = {{0.249286745170910, 0.249286745170910, 0.116786275726379},
                                  {0.501426509658180, 0.249286745170910, 0.116786275726379},
                                  {0.249286745170910, 0.501426509658180, 0.116786275726379},
                                  {0.063089014491502, 0.063089014491502, 0.050844906370207},
                                  {0.873821971016996, 0.063089014491502, 0.050844906370207},
                                  {0.063089014491502, 0.873821971016996, 0.050844906370207},
                                  {0.310352451033784, 0.636502499121399, 0.082851075618374},
                                  {0.636502499121399, 0.310352451033784, 0.082851075618374},
                                  {0.310352451033784, 0.053145049844817, 0.082851075618374},
                                  {0.053145049844817, 0.310352451033784, 0.082851075618374},
                                  {0.636502499121399, 0.053145049844817, 0.082851075618374},
                                  {0.053145049844817, 0.636502499121399, 0.082851075618374}};
/// The rule for flat faces: degree 2.
constexpr RulePoint degree_2[] = {
    {1.0 / 6, 1.0 / 6, 1.0 / 3}, {2.0 / 3, 1.0 / 6, 1.0 / 3}, {1.0 / 6, 2.0 / 3, 1.0 / 3}};

/// Sets the shape functions and their derivatives by u and v.
void set_shape(std::size_t nodes, const Parameter& at, Nodes6& shape, Nodes6& by_u, Nodes6& by_v) {
  const double u = at[0], v = at[1], t = 1 - u - v;
  if (nodes == 3) {
    shape << t, u, v, 0, 0, 0;
    by_u << -1, 1, 0, 0, 0, 0;
    by_v << -1, 0, 1, 0, 0, 0;
    return;
  }
  const TrianglePoint point = triangle_point(u, v, 0);
  shape = point.shape;
  by_u = point.along_u;
  by_v = point.along_v;
}

struct Corner {
  Parameter at;
  double pressure;
};

/// The part of a triangle of parameters where a pressure that is linear between its corners is above 0, as triangles.
template <class Visit>
void each_wet_part(const std::array<Corner, 3>& corners, const Visit& visit) {
  std::array<Parameter, 4> wet;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Corner &here = corners[i], &next = corners[(i + 1) % 3];
    if (here.pressure > 0) wet[count++] = here.at;
    if ((here.pressure > 0) != (next.pressure > 0))
      wet[count++] = here.at + here.pressure / (here.pressure - next.pressure) * (next.at - here.at);
  }
  for (std::size_t i = 2; i < count; ++i) visit(wet[0], wet[i - 1], wet[i]);
}

Mat3 cross_matrix(const Vec3& w) {
  Mat3 matrix;
  matrix << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return matrix;
}

}  // namespace

bool Hydrostatics::acts(const Model& model) {
  return std::any_of(model.loads.tractions.begin(), model.loads.tractions.end(),
                     [](const FollowingTraction& traction) { return !traction.deeper_MPa_mm.isZero(0); });
}

Hydrostatics::Hydrostatics(const Model& model) : model_(model) {
  for (const FollowingTraction& traction : model.loads.tractions)
    if (!traction.deeper_MPa_mm.isZero(0))
      for (const LoadedFace& loaded : traction.faces)
        faces_.push_back({nodes_of(loaded.face), loaded.fraction, traction.deeper_MPa_mm, traction.level_mm});
  find_rims();
}

/// Is the surface closed, except for edges that cannot move?
void Hydrostatics::find_rims() {
  std::map<std::pair<Index, Index>, double> passes;
  for (const Face& face : faces_)
    for (std::size_t i = 0; i < 3; ++i) {
      const Index a = face.nodes[i], b = face.nodes[(i + 1) % 3];
      passes[{std::min(a, b), std::max(a, b)}] += a < b ? face.fraction : -face.fraction;
    }
  const auto still = [&](Index v) {
    const auto& fixed = model_.held.fixed[v];
    return fixed[0] && fixed[1] && fixed[2];
  };
  closed_ = std::all_of(passes.begin(), passes.end(), [&](const auto& edge) {
    return edge.second == 0 || (model_.held.turns.empty() && still(edge.first.first) && still(edge.first.second));
  });
}

/// Pressures at the nodes of a face, and their bounds over all of the face [MPa].
struct Hydrostatics::Depths {
  std::array<double, 6> at{};
  double least = 0, most = 0;

  Depths(const Face& face, const Points& positions) {
    for (std::size_t i = 0; i < face.nodes.size(); ++i) {
      at[i] = face.deeper.dot(vertex_at(positions, face.nodes[i]) - face.level);
      // the bounds of a quadratic function are those of its Bezier coefficients
      const double bound = i < 3 ? at[i] : 2 * at[i] - 0.5 * (at[i - 3] + at[(i - 2) % 3]);
      least = i == 0 ? bound : std::min(least, bound);
      most = i == 0 ? bound : std::max(most, bound);
    }
  }
  [[nodiscard]] double of(const Nodes6& shape) const { return shape.dot(Eigen::Map<const Nodes6>(at.data())); }
};

template <class Visit>
void Hydrostatics::each_place(const Face& face, const Points& positions, const Visit& visit) {
  const std::size_t count = face.nodes.size();
  const Depths depths(face, positions);
  if (!(depths.most > 0)) return;
  const std::span<const RulePoint> rule = count == 3 ? std::span<const RulePoint>(degree_2) : degree_6;
  const auto visit_part = [&](const Parameter& a, const Parameter& b, const Parameter& c) {
    const Parameter along = b - a, across = c - a;
    const double doubled = std::abs(along[0] * across[1] - along[1] * across[0]);
    for (const RulePoint& point : rule) {
      Place place;
      set_shape(count, a + point.a * along + point.b * across, place.shape, place.along_u, place.along_v);
      place.weight = 0.5 * doubled * point.weight * face.fraction;
      place.pressure = std::max(0.0, depths.of(place.shape));
      for (std::size_t i = 0; i < count; ++i) {
        place.u += place.along_u[i] * vertex_at(positions, face.nodes[i]);
        place.v += place.along_v[i] * vertex_at(positions, face.nodes[i]);
      }
      visit(place, Vec3(place.weight * place.u.cross(place.v)));
    }
  };
  if (depths.least >= 0) return visit_part({0, 0}, {1, 0}, {0, 1});
  const int pieces = count == 3 ? 1 : 8;
  const auto corner = [&](int i, int j) {
    const Parameter at(static_cast<double>(i) / pieces, static_cast<double>(j) / pieces);
    Nodes6 shape, by_u, by_v;
    set_shape(count, at, shape, by_u, by_v);
    return Corner{at, depths.of(shape)};
  };
  for (int i = 0; i < pieces; ++i)
    for (int j = 0; i + j < pieces; ++j) {
      each_wet_part({corner(i, j), corner(i + 1, j), corner(i, j + 1)}, visit_part);
      if (i + j + 1 < pieces) each_wet_part({corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)}, visit_part);
    }
}

void Hydrostatics::evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                            Team& /*team*/) const {
  static_cast<Scratch&>(scratch).load_state = load_state;
  double energy = 0;
  for (const Face& face : faces_)
    each_place(face, at.positions, [&](const Place& place, const Vec3& area) {
      const Vec3 push = load_state.load_factor * place.pressure * area;
      for (std::size_t i = 0; i < face.nodes.size(); ++i)
        sum.gradient.row(face.nodes[i]) += place.shape[i] * push.transpose();
      energy += 0.5 * place.pressure * place.pressure * face.deeper.dot(area) / face.deeper.squaredNorm();
    });
  sum.energy += load_state.load_factor * energy;
}

Hydrostatics::Blocks Hydrostatics::slopes(std::size_t number, const Points& positions) const {
  const Face& face = faces_[number];
  Blocks blocks;
  for (auto& row : blocks) row.fill(Mat3::Zero());
  const std::size_t count = face.nodes.size();
  each_place(face, positions, [&](const Place& place, const Vec3& area) {
    const double push = place.weight * place.pressure;
    const Mat3 by_v = push * cross_matrix(place.u), by_u = push * cross_matrix(place.v),
               by_depth = area * face.deeper.transpose();
    for (std::size_t j = 0; j < count; ++j) {
      const Eigen::Index k = j;
      const Mat3 change = place.shape[k] * by_depth + place.along_v[k] * by_v - place.along_u[k] * by_u;
      for (std::size_t i = 0; i < count; ++i) blocks[i][j] += place.shape[i] * change;
    }
  });
  return blocks;
}

void Hydrostatics::add_change(const LoadState& from, const LoadState& to, const Points& positions,
                              Term::Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  const double change = to.load_factor - from.load_factor;
  if (change == 0) return;
  for (const Face& face : faces_)
    each_place(face, positions, [&](const Place& place, const Vec3& area) {
      const Vec3 push = change * place.pressure * area;
      for (std::size_t i = 0; i < face.nodes.size(); ++i) force.row(face.nodes[i]) += place.shape[i] * push.transpose();
    });
}

}  // namespace softkin::physical
