#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// K_ab of a law in the invariants, by nodes: with f_a = F slope_a, c_a = (dJ/dF) slope_a,
/// h_a = d(W_J)/d(I1, I2) : slope_a and s = slope_a . slope_b
///   (2 W_1 s + 2 W_2 (I1 s - f_a . f_b)) I - 2 W_2 s F F^T
///   + 4 (W_2 + W_11) f_a f_b^T - 2 W_2 f_b f_a^T + W_JJ c_a c_b^T + h_a c_b^T + c_a h_b^T + W_J [F (slope_b x
///   slope_a)]_x
template <Law law, int K>
class InvariantTangent {
 public:
  void set(const LawBlock& constants, const Pack3 (&slope)[K], const Pack& volume, const Shape<K>& current) {
    slope_ = slope;
    const Deformation d = deformation(deformation_gradient<K>(slope, current));
    const InvariantEnergy w = invariant_energy<law>(constants, d);
    of_identity_ = 2 * volume * w.by_first;
    if constexpr (uses_second<law>) {
      of_identity_ += 2 * volume * w.by_second * d.first;
      twice_second_ = 2 * volume * w.by_second;
      for (int i = 0; i < 3; ++i) left_.row[i] = twice_second_ * d.left.row[i];
    }
    if constexpr (uses_jacobian<law>) of_jacobian_ = volume * w.by_jacobian;
    gradient_ = d.gradient;
    set_nodes(d, w, volume);
  }

  void add(int a, int b, Pack33& k) const {
    const Pack s = dot(slope_[a], slope_[b]);
    Pack of_identity = of_identity_ * s;
    if constexpr (uses_second<law>) {
      of_identity -= twice_second_ * dot(turned_[a], turned_[b]);
      for (int i = 0; i < 3; ++i) k.row[i] = k.row[i] - s * left_.row[i];
      add_outer(k, turned_[b], -twice_second_ * turned_[a]);
    }
    if constexpr (uses_second<law> || curved_in_first<law>) add_outer(k, turned_[a], along_[b]);
    if constexpr (uses_jacobian<law>) {
      add_outer(k, swelling_[a], swelling_right_[b]);
      if (a != b) add_cross(k, of_jacobian_ * (gradient_ * cross(slope_[b], slope_[a])));
    }
    if constexpr (couples_jacobian<law>) add_outer(k, coupled_[a], swelling_[b]);
    add_to_diagonal(k, of_identity);
  }

 private:
  void set_nodes(const Deformation& d, const InvariantEnergy& w, const Pack& volume) {
    const Pack along = 4 * volume * (w.by_second + w.by_first_first);
    const Pack of_first = 2 * volume * (w.by_first_jacobian + w.by_second_jacobian * d.first);
    const Pack of_second = 2 * volume * w.by_second_jacobian;
    const Pack of_jacobian = volume * w.by_jacobian_jacobian;
    for (int a = 0; a < K; ++a) {
      turned_[a] = d.gradient * slope_[a];
      along_[a] = along * turned_[a];
      if constexpr (uses_jacobian<law>) {
        swelling_[a] = d.cofactor * slope_[a];
        swelling_right_[a] = of_jacobian * swelling_[a];
      }
      if constexpr (couples_jacobian<law>) {
        coupled_[a] = of_first * turned_[a];
        if constexpr (uses_second<law>) coupled_[a] = coupled_[a] - of_second * (d.left * turned_[a]);
        swelling_right_[a] = swelling_right_[a] + coupled_[a];
      }
    }
  }

  static void add_cross(Pack33& k, const Pack3& w) {
    k.row[0].y -= w.z, k.row[0].z += w.y;
    k.row[1].x += w.z, k.row[1].z -= w.x;
    k.row[2].x -= w.y, k.row[2].y += w.x;
  }

  const Pack3* slope_;
  Pack of_identity_, twice_second_, of_jacobian_;
  Pack33 gradient_, left_;
  Pack3 turned_[K], along_[K], swelling_[K], swelling_right_[K], coupled_[K];
};

/// K_ab of the corotational law: 2 mu slope_a . slope_b I + lambda h_a h_b^T + (lambda tr(S - I) - 2 mu) [h_a]_x^T G
/// [h_b]_x with h_a = R slope_a and G = R (tr(S) I - S)^-1 R^T, from dR = R [w]_x.
template <int K>
class CorotationalTangent {
 public:
  void set(const LawBlock& constants, const Pack3 (&slope)[K], const Pack& volume, const Shape<K>& current) {
    slope_ = slope;
    const Polar p = polar(deformation_gradient<K>(slope, current));
    twice_mu_ = 2 * volume * constants.mu;
    lambda_ = volume * constants.lambda;
    const Pack of_turn = lambda_ * (trace(p.stretch) - 3) - twice_mu_;
    turn_ = times(times(p.rotation, polar_turn_compliance(p.stretch)), transposed(p.rotation));
    for (Pack3& row : turn_.row) row = of_turn * row;
    for (int a = 0; a < K; ++a) turned_[a] = p.rotation * slope[a];
  }

  void add(int a, int b, Pack33& k) const {
    const Pack3 &ha = turned_[a], &hb = turned_[b];
    add_outer(k, lambda_ * ha, hb);
    add_to_diagonal(k, twice_mu_ * dot(slope_[a], slope_[b]));
    Pack33 turn;  // G [h_b]_x: a row r of G becomes r x h_b
    for (int i = 0; i < 3; ++i) turn.row[i] = cross(turn_.row[i], hb);
    // [h_a]_x^T = -[h_a]_x
    k.row[0] = k.row[0] + (ha.z * turn.row[1] - ha.y * turn.row[2]);
    k.row[1] = k.row[1] + (ha.x * turn.row[2] - ha.z * turn.row[0]);
    k.row[2] = k.row[2] + (ha.y * turn.row[0] - ha.x * turn.row[1]);
  }

 private:
  const Pack3* slope_;
  Pack twice_mu_, lambda_;
  Pack33 turn_;
  Pack3 turned_[K];
};

template <Law law, int K>
struct TangentOf {
  using type = InvariantTangent<law, K>;
};
template <int K>
struct TangentOf<Law::corotational, K> {
  using type = CorotationalTangent<K>;
};

template <Law law, int K, int Q>
void nodal_stiffness(const ElasticBlock<K, Q>& block, const Shape<K>& current, ElasticStiffness<K>& out) {
  typename TangentOf<law, K>::type tangent[Q];
  for (int q = 0; q < Q; ++q) tangent[q].set(block.law, block.slope[q], block.volume[q], current);
  for (int a = 0, ab = 0; a < K; ++a)
    for (int b = 0; b <= a; ++b, ++ab) {
      Pack33 k{};
      for (int q = 0; q < Q; ++q) tangent[q].add(a, b, k);
      out.block[ab] = k;
    }
}

}  // namespace

template <int K, int Q>
void elastic_stiffness(const energy::ElasticBlock<K, Q>& block, const energy::Shape<K>& current, bool projected,
                       energy::ElasticStiffness<K>& out) {
  if (projected) {
    projected_stiffness<K, Q>(wide(block), wide(current), wide(out));
  } else {
    dispatch(block.law.law, [&]<Law law>() {
      if constexpr (law_traits(law).form == LawForm::stretches)
        stretch_stiffness<law, K, Q>(wide(block), wide(current), wide(out));
      else
        nodal_stiffness<law, K, Q>(wide(block), wide(current), wide(out));
    });
  }
}

template void elastic_stiffness(const energy::ElasticBlock<4, 1>&, const energy::Shape<4>&, bool,
                                energy::ElasticStiffness<4>&);
template void elastic_stiffness(const energy::ElasticBlock<10, 4>&, const energy::Shape<10>&, bool,
                                energy::ElasticStiffness<10>&);
template void elastic_stiffness(const energy::ElasticBlock<6, 6>&, const energy::Shape<6>&, bool,
                                energy::ElasticStiffness<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
