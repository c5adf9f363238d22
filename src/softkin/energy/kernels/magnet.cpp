#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>
#include <softkin/energy/kernels/magnet.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

template <int K, int Q>
using MagnetBlock = MagnetBlockOf<Pack, K, Q>;
template <int Q>
using FluxBlock = FluxBlockOf<Pack, Q>;

/// [v]_x a
Pack33 crossed(const Pack3& v, const Pack33& a) {
  return {{v.y * a.row[2] - v.z * a.row[1], v.z * a.row[0] - v.x * a.row[2], v.x * a.row[1] - v.y * a.row[0]}};
}

/// a [v]_x
Pack33 crossed(const Pack33& a, const Pack3& v) {
  return {{cross(a.row[0], v), cross(a.row[1], v), cross(a.row[2], v)}};
}

Pack33 scaled(const Pack& scale, const Pack33& a) {
  return {{scale * a.row[0], scale * a.row[1], scale * a.row[2]}};
}

void add(Pack33& sum, const Pack& scale, const Pack33& a) {
  for (int i = 0; i < 3; ++i) sum.row[i] = sum.row[i] + scale * a.row[i];
}

/// (a + a^T) / 2
Pack33 symmetric(const Pack33& a) {
  Pack33 sum = transposed(a);
  for (int i = 0; i < 3; ++i) sum.row[i] = pack(0.5) * (sum.row[i] + a.row[i]);
  return sum;
}

/// polar(), in half its time where no lane is inverted or nearly flat.
///
/// source  Newton's iteration X <- (X + X^-T) / 2 from F, which converges quadratically to R; Higham 1986, "Computing
///         the polar decomposition, with applications"
Polar quick_polar(const Pack33& gradient) {
  constexpr int most = 8;
  constexpr double flat = 0.01, arrived = 1e-15;  // the square of a step, which leaves half of it
  Pack33 x = gradient;
  for (int i = 0; i < most; ++i) {
    const Pack33 turned = cofactor(x);
    const Pack determinant = dot(x.row[0], turned.row[0]);
    if (any(~(determinant > flat))) break;
    const Pack inverse = 0.5 / determinant;
    Pack square{};
    for (int r = 0; r < 3; ++r) {
      const Pack3 step = inverse * turned.row[r] - pack(0.5) * x.row[r];
      square += dot(step, step);
      x.row[r] = x.row[r] + step;
    }
    if (any(~(square < arrived))) continue;
    return {x, symmetric(transpose_times(x, gradient))};
  }
  return polar(gradient);
}

/// A quadrature point, in space: F = R S, R' = [w]_x R with G w = axial(F' R^T - R F'^T).
struct MagnetPoint {
  Pack33 rotation;    // R
  Pack33 compliance;  // G^-1, G = tr(S) I - R S R^T
  Pack3 moment;       // R m
  Pack3 twist;        // h = G^-1 (R m x b): a node is pulled by h x R slope
};

template <int K>
MagnetPoint magnet_point(const Pack3 (&slope)[K], const Pack3& moment, const Pack3& flux, const Shape<K>& current,
                         Pack33* stiffness = nullptr) {
  const Polar p = quick_polar(deformation_gradient<K>(slope, current));
  const auto in_space = [&](const Pack33& a) { return times(times(p.rotation, a), transposed(p.rotation)); };
  MagnetPoint point{p.rotation, in_space(polar_turn_compliance(p.stretch)), p.rotation * moment, {}};
  point.twist = point.compliance * cross(point.moment, flux);
  if (stiffness) {
    *stiffness = in_space(scaled(pack(-1), p.stretch));
    add_to_diagonal(*stiffness, trace(p.stretch));
  }
  return point;
}

/// What a turn alone does to the energy's second derivative by w: (R m . b) I - sym(b (R m)^T).
Pack33 by_turn(const MagnetPoint& p, const Pack3& flux) {
  Pack33 turn{};
  add_outer(turn, pack(-1) * flux, p.moment);
  turn = symmetric(turn);
  add_to_diagonal(turn, dot(p.moment, flux));
  return turn;
}

/// -R m . d^2b/dx^2
Pack33 by_place(const MagnetPoint& p, const Pack33 (&second)[3]) {
  Pack33 sum{};
  add(sum, -p.moment.x, second[0]);
  add(sum, -p.moment.y, second[1]);
  add(sum, -p.moment.z, second[2]);
  return sum;
}

/// K_ab by nodes. With s_a = R slope_a, Y_b = G^-1 [s_b]_x and N the shape functions,
///   [s_a] T_b + s_a (Y_b^T h)^T - (h . s_a) Y_b + N_a E_b,
///   T_b = -(G^-1 A G^-1 - sym(G^-1 [h])) [s_b] - Y_b [h] + N_b G^-1 [R m] grad b,
///   E_b = (grad b)^T [R m] Y_b - N_b R m . d^2b/dx^2,   A = by_turn()
template <int K>
class ExactMagnet {
 public:
  template <int Q>
  void set(const MagnetBlock<K, Q>& block, const FluxBlock<Q>& flux, int q, const Shape<K>& current) {
    const MagnetPoint p = magnet_point<K>(block.slope[q], block.moment[q], flux.point[q].value, current);
    const Pack33& g = p.compliance;
    Pack33 turn = times(times(g, by_turn(p, flux.point[q].value)), g);
    add(turn, pack(-1), symmetric(crossed(g, p.twist)));
    shape_ = flux.in_space ? block.shape[q] : nullptr;
    Pack33 of_moment, moved, place;
    if (shape_) {
      of_moment = crossed(p.moment, flux.point[q].slope);
      moved = times(g, of_moment);
      place = by_place(p, flux.point[q].second);
    }
    for (int a = 0; a < K; ++a) {
      slope_[a] = p.rotation * block.slope[q][a];
      along_[a] = dot(p.twist, slope_[a]);
      turned_[a] = crossed(g, slope_[a]);
      twisted_[a] = transposed(turned_[a]) * p.twist;
      right_[a] = scaled(pack(-1), crossed(turn, slope_[a]));
      add(right_[a], pack(-1), crossed(turned_[a], p.twist));
      if (!shape_) continue;
      add(right_[a], pack(shape_[a]), moved);
      placed_[a] = scaled(pack(-1), transpose_times(of_moment, turned_[a]));  // [R m]^T = -[R m]
      add(placed_[a], pack(shape_[a]), place);
    }
  }

  void add_to(int a, int b, Pack33& k) const {
    add(k, pack(1), crossed(slope_[a], right_[b]));
    add(k, -along_[a], turned_[b]);
    add_outer(k, slope_[a], twisted_[b]);
    if (shape_) add(k, pack(shape_[a]), placed_[b]);
  }

 private:
  const double* shape_ = nullptr;  // none: the field is the same everywhere
  Pack along_[K];
  Pack3 slope_[K], twisted_[K];
  Pack33 turned_[K], right_[K], placed_[K];
};

/// The second derivative is w^T A w + 2 w . v, with A = by_turn() - sym([h] G) and v = sum_a s_a x (h x x_a'), and
/// where the field changes in space 2 w . C x' + x' . D x' more. With v measured by |h| the 6 x 6 matrix of (w, v)
/// splits by the eigenvectors of A; 2 w . C x' is less than the square of w + C x' in any unit of length; D is
/// projected.
template <int K>
class PositiveMagnet {
 public:
  template <int Q>
  void set(const MagnetBlock<K, Q>& block, const FluxBlock<Q>& flux, int q, const Shape<K>& current) {
    Pack33 stiffness;
    const MagnetPoint p = magnet_point<K>(block.slope[q], block.moment[q], flux.point[q].value, current, &stiffness);
    for (int a = 0; a < K; ++a) slope_[a] = p.rotation * block.slope[q][a];
    Pack33 turn = by_turn(p, flux.point[q].value);
    add(turn, pack(-1), symmetric(crossed(p.twist, stiffness)));
    const Principal modes = principal(turn);
    const Pack33 axes = transposed(modes.axes);
    const Pack square = dot(p.twist, p.twist);
    for (int i = 0; i < 3; ++i) {
      const Pack &value = modes.value[i], root = sqrt(value * value + 4 * square);
      // the larger root of x^2 - value x - square, without cancellation
      const Pack larger = select(value > 0, 0.5 * (value + root), 2 * square / (root - value + smallest));
      weight_[i] = larger / (larger * larger + square + smallest);
      const Pack3 turned = larger * (p.compliance * axes.row[i]);
      for (int a = 0; a < K; ++a) row_[i][a] = cross(turned, slope_[a]) + cross(p.twist, cross(slope_[a], axes.row[i]));
    }
    in_space_ = flux.in_space;
    if (in_space_) set_in_space(block, flux, q, p);
  }

  void add_to(int a, int b, Pack33& k) const {
    for (int i = 0; i < (in_space_ ? 6 : 3); ++i) add_outer(k, weight_[i] * row_[i][a], row_[i][b]);
    if (in_space_) add(k, pack(shape_[a] * shape_[b]), place_);
  }

 private:
  static constexpr double smallest = 1e-200;

  template <int Q>
  void set_in_space(const MagnetBlock<K, Q>& block, const FluxBlock<Q>& flux, int q, const MagnetPoint& p) {
    shape_ = block.shape[q];
    Pack per_length{};
    for (int a = 0; a < K; ++a) per_length += norm(slope_[a]);
    const Pack33 mixed = scaled(pack(-1), crossed(p.moment, flux.point[q].slope));
    const Pack weight = sqrt(inner(mixed, mixed)) / per_length, inverse = 1 / (weight + smallest);
    for (int i = 0; i < 3; ++i) {
      weight_[3 + i] = weight;
      for (int a = 0; a < K; ++a)
        row_[3 + i][a] = cross(p.compliance.row[i], slope_[a]) + (shape_[a] * inverse) * mixed.row[i];
    }
    const Principal modes = principal(symmetric(by_place(p, flux.point[q].second)));
    const Pack33 axes = transposed(modes.axes);
    place_ = Pack33{};
    for (int i = 0; i < 3; ++i) add_outer(place_, max(modes.value[i], pack(0)) * axes.row[i], axes.row[i]);
  }

  const double* shape_ = nullptr;
  bool in_space_ = false;
  Pack weight_[6];
  Pack3 slope_[K], row_[6][K];
  Pack33 place_;
};

template <class Tangent, int K, int Q>
void stiffness_of(const MagnetBlock<K, Q>& block, const FluxBlock<Q>& flux, const Shape<K>& current,
                  ElasticStiffness<K>& out) {
  Tangent tangent[Q];
  for (int q = 0; q < Q; ++q) tangent[q].set(block, flux, q, current);
  for (int a = 0, ab = 0; a < K; ++a)
    for (int b = 0; b <= a; ++b, ++ab) {
      Pack33 k{};
      for (int q = 0; q < Q; ++q) tangent[q].add_to(a, b, k);
      out.block[ab] = k;
    }
}

}  // namespace

template <int K, int Q>
void magnet_force(const energy::MagnetBlock<K, Q>& magnets, const energy::FluxBlock<Q>& field,
                  const energy::Shape<K>& shape, energy::Shape<K>& pulls, energy::Pack& potential) {
  const MagnetBlock<K, Q>& block = wide(magnets);
  const FluxBlock<Q>& flux = wide(field);
  const Shape<K>& current = wide(shape);
  Shape<K>& gradient = wide(pulls);
  Pack energy{};
  for (int a = 0; a < K; ++a) gradient[a] = Pack3{pack(0), pack(0), pack(0)};
  for (int q = 0; q < Q; ++q) {
    const MagnetPoint p = magnet_point<K>(block.slope[q], block.moment[q], flux.point[q].value, current);
    energy -= dot(p.moment, flux.point[q].value);
    for (int a = 0; a < K; ++a) gradient[a] = gradient[a] - cross(p.twist, p.rotation * block.slope[q][a]);
    if (!flux.in_space) continue;
    const Pack3 pull = transposed(flux.point[q].slope) * p.moment;
    for (int a = 0; a < K; ++a) gradient[a] = gradient[a] - pack(block.shape[q][a]) * pull;
  }
  keep(energy, &potential[0]);
}

template <int K, int Q>
void magnet_stiffness(const energy::MagnetBlock<K, Q>& magnets, const energy::FluxBlock<Q>& field,
                      const energy::Shape<K>& shape, bool projected, energy::ElasticStiffness<K>& out) {
  const MagnetBlock<K, Q>& block = wide(magnets);
  const FluxBlock<Q>& flux = wide(field);
  if (projected)
    stiffness_of<PositiveMagnet<K>, K, Q>(block, flux, wide(shape), wide(out));
  else
    stiffness_of<ExactMagnet<K>, K, Q>(block, flux, wide(shape), wide(out));
}

#define SOFTKIN_MAGNETS(K, Q)                                                                                        \
  template void magnet_force(const energy::MagnetBlock<K, Q>&, const energy::FluxBlock<Q>&, const energy::Shape<K>&, \
                             energy::Shape<K>&, energy::Pack&);                                                      \
  template void magnet_stiffness(const energy::MagnetBlock<K, Q>&, const energy::FluxBlock<Q>&,                      \
                                 const energy::Shape<K>&, bool, energy::ElasticStiffness<K>&);
SOFTKIN_MAGNETS(4, 1)
SOFTKIN_MAGNETS(10, 4)
SOFTKIN_MAGNETS(6, 6)
#undef SOFTKIN_MAGNETS

}  // namespace softkin::energy::SOFTKIN_TARGET
