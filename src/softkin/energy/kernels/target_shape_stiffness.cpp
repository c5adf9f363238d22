#include <softkin/energy/kernels/target_shape_parts.hpp>
#include <softkin/energy/kernels/turn_response_wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

template <int K>
void turned(const PackRotation& rotation, const Shape<K>& shape, Shape<K>& out) {
  const Pack33 matrix = to_matrix(rotation);
  for (int i = 0; i < K; ++i) out[i] = matrix * shape[i];
}

template <int K>
Pack inner(const Shape<K>& a, const Shape<K>& b) {
  Pack total = pack(0);
  for (int i = 0; i < K; ++i) total += dot(a[i], b[i]);
  return total;
}

/// sum_i a_i x b_i
template <int K>
Pack3 moment(const Shape<K>& a, const Shape<K>& b) {
  Pack3 total{};
  for (int i = 0; i < K; ++i) total = total + cross(a[i], b[i]);
  return total;
}

/// tr(S) I - S, S = sum_i x_i q_i^T: the work that a turn of the target costs.
template <int K>
Pack33 turn_stiffness(const Shape<K>& current, const Shape<K>& target) {
  const Pack33 s = correlation<K>(current, target);
  const Pack &xx = s.row[0].x, &yy = s.row[1].y, &zz = s.row[2].z;
  const Pack xy = -0.5 * (s.row[0].y + s.row[1].x), xz = -0.5 * (s.row[0].z + s.row[2].x),
             yz = -0.5 * (s.row[1].z + s.row[2].y);
  return {{{yy + zz, xy, xz}, {xy, xx + zz, yz}, {xz, yz, xx + yy}}};
}

/// a and b of the pull w (a R T + b X), and their derivatives by the volume ratio.
struct BodyFractions {
  Pack of_rest, of_current, of_rest_slope, of_current_slope;
};

template <int K>
BodyFractions fractions(const BodyBlock<K>& block, const Shape<K>& current) {
  if (!block.blended) return {pack(1), pack(-1), pack(0), pack(0)};
  const Pack ratio = volume(current) / block.volume, soft = 1 - block.shape_ratio;
  Pack scaled, rigid, scaled_slope, rigid_slope;
  soft_target(ratio, scaled, rigid);
  soft_target_slope(ratio, scaled_slope, rigid_slope);
  return {block.shape_ratio + soft * rigid, soft * scaled - 1, soft * rigid_slope, soft * scaled_slope};
}

/// The target at a ratio, turned, and its derivative by the ratio without the turn.
template <int K>
void actuation_target(const ActuationBlock<K>& block, const Pack& ratio, const PackRotation& rotation, Shape<K>& target,
                      Shape<K>& slope) {
  Pack grown, thinned, grown_slope, thinned_slope;
  growth(block, ratio, grown, thinned);
  growth_slope(block, ratio, grown_slope, thinned_slope);
  const Pack33 matrix = to_matrix(rotation);
  for (int i = 0; i < K; ++i) {
    target[i] = matrix * (block.constant[i] + grown * block.grown[i] + thinned * block.thinned[i]);
    slope[i] = matrix * (grown_slope * block.grown[i] + thinned_slope * block.thinned[i]);
  }
}

/// Adds the derivative of scale p_a . (p_b x p_c).
void add_triple(const Shape<6>& p, int a, int b, int c, double scale, Shape<6>& out) {
  out[a] = out[a] + pack(scale) * cross(p[b], p[c]);
  out[b] = out[b] + pack(scale) * cross(p[c], p[a]);
  out[c] = out[c] + pack(scale) * cross(p[a], p[b]);
}

/// Adds the derivative of scale |(p_1 - p_0) x (p_2 - p_0)| of the triangle that begins at `first`.
void add_area_slope(const Shape<6>& p, int first, double scale, Shape<6>& out) {
  const Pack3 u = p[first + 1] - p[first], v = p[first + 2] - p[first], twice = cross(u, v);
  const Pack size = norm(twice);
  const Pack3 normal = select(size > 0, scale / size, pack(0)) * twice;
  const Pack3 second = cross(v, normal), third = cross(normal, u);
  out[first] = out[first] - second - third;
  out[first + 1] = out[first + 1] + second;
  out[first + 2] = out[first + 2] + third;
}

void volume_slope(const Shape<4>& p, Shape<4>& out) {
  const Pack3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
  const Pack sixth = pack(1.0 / 6);
  out[1] = sixth * cross(b, c);
  out[2] = sixth * cross(c, a);
  out[3] = sixth * cross(a, b);
  out[0] = pack(-1) * (out[1] + out[2] + out[3]);
}

void volume_slope(const Shape<6>& v, Shape<6>& out) {
  Shape<6> p;
  for (int i = 0; i < 6; ++i) p[i] = v[i] - v[0];
  for (Pack3& point : out) point = Pack3{};
  add_triple(p, 0, 2, 1, 1.0 / 6, out);
  add_triple(p, 3, 4, 5, 1.0 / 6, out);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    add_triple(p, i, j, j + 3, 1.0 / 12, out);
    add_triple(p, i, j + 3, i + 3, 1.0 / 12, out);
    add_triple(p, i, j, i + 3, 1.0 / 12, out);
    add_triple(p, j, j + 3, i + 3, 1.0 / 12, out);
  }
}

void measure_slope(const Shape<3>& current, Shape<3>& out) {
  const Pack3 along = current[1] - current[0];
  const Pack length = norm(along);
  out[1] = select(length > 0, 1 / length, pack(0)) * along;
  out[0] = pack(-1) * out[1];
  out[2] = Pack3{};
}
void measure_slope(const Shape<4>& current, Shape<4>& out) {
  volume_slope(current, out);
}
void measure_slope(const Shape<6>& current, Shape<6>& out) {
  for (Pack3& point : out) point = Pack3{};
  add_area_slope(current, 0, 0.25, out);
  add_area_slope(current, 3, 0.25, out);
}

/// a b^T
Pack33 outer(const Pack3& a, const Pack3& b) {
  return {{a.x * b, a.y * b, a.z * b}};
}

/// [q_i]x C [q_j]x for a symmetric C: C's row times [q]x is the row x q.
Pack33 between_turns(const Pack3& a, const Pack33& c, const Pack3& b) {
  const Pack3 x = cross(c.row[0], b), y = cross(c.row[1], b), z = cross(c.row[2], b);
  return {{a.y * z - a.z * y, a.z * x - a.x * z, a.x * y - a.y * x}};
}

Pack33 operator+(const Pack33& a, const Pack33& b) {
  return {{a.row[0] + b.row[0], a.row[1] + b.row[1], a.row[2] + b.row[2]}};
}

Pack33 operator*(const Pack& s, const Pack33& a) {
  return {{s * a.row[0], s * a.row[1], s * a.row[2]}};
}

/// weight (straight N (x) I - G^T compliance G + signed_square mode mode^T), block by block.
template <int K>
void assemble(const Pack& weight, const Pack& straight, const Shape<K>& target, const Pack33& compliance,
              const Pack& signed_square, const Shape<K>& mode, TargetStiffness<K>& out) {
  const Pack33 turning = weight * compliance;
  for (int i = 0, at = 0; i < K; ++i)
    for (int j = 0; j <= i; ++j, ++at) {
      Pack33& block = out.block[at];
      block = between_turns(target[i], turning, target[j]) + outer((weight * signed_square) * mode[i], mode[j]);
      const Pack diagonal = ((i == j ? 1.0 : 0.0) - 1.0 / K) * weight * straight;
      block.row[0].x += diagonal;
      block.row[1].y += diagonal;
      block.row[2].z += diagonal;
    }
}

template <int K>
void turned_move(const Pack& weight, const Shape<K>& current, const Shape<K>& target, const Shape<K>& change,
                 Shape<K>& out) {
  for (int i = 0; i < K; ++i) out[i] = change[i];
  center<K>(out);
  const Pack3 turn = turn_response(turn_stiffness<K>(current, target)) * moment<K>(target, out);
  // Cayley's map: agrees with exp to second order, and never turns by more than half a circle
  const Pack3 half = pack(0.5) * turn;
  const Pack scale = 1 / sqrt(1 + dot(half, half));
  const Pack33 matrix = to_matrix({scale, scale * half.x, scale * half.y, scale * half.z});
  for (int i = 0; i < K; ++i) out[i] = weight * (matrix * (current[i] + out[i] - cross(turn, current[i])) - current[i]);
}

/// The least eigenvalue of the turn stiffness, in the metric of the target, that keeps the exact matrix finite.
constexpr double min_turn = 1e-6;

}  // namespace

void volume_slope_of_blocks(const energy::Shape<4>& current, energy::Shape<4>& out) {
  volume_slope(wide(current), wide(out));
}
void volume_slope_of_blocks(const energy::Shape<6>& current, energy::Shape<6>& out) {
  volume_slope(wide(current), wide(out));
}

template <int K>
void pull_change_of_body(const energy::BodyBlock<K>& block_kept, const energy::Shape<K>& current_kept,
                         const energy::PackRotation& rotation_kept, const energy::Shape<K>& change_kept,
                         energy::Shape<K>& out_kept) {
  const BodyBlock<K>& block = wide(block_kept);
  const Shape<K>& current = wide(current_kept);
  const PackRotation& rotation = wide(rotation_kept);
  const Shape<K>& change = wide(change_kept);
  Shape<K>& out = wide(out_kept);
  const BodyFractions fraction = fractions(block, current);
  Shape<K> target, moved;
  turned<K>(rotation, block.rest, target);
  for (int i = 0; i < K; ++i) moved[i] = change[i];
  center<K>(moved);
  const Pack3 turn = turn_response(turn_stiffness<K>(current, target)) * moment<K>(target, moved);
  Pack growth = pack(0);
  if (block.blended) {
    Shape<K> slope;
    volume_slope(current, slope);
    growth = inner<K>(slope, moved) / block.volume;
  }
  const Pack along_rest = growth * fraction.of_rest_slope, along_current = growth * fraction.of_current_slope;
  for (int i = 0; i < K; ++i)
    out[i] = block.weight * (fraction.of_rest * cross(turn, target[i]) + fraction.of_current * moved[i] +
                             along_rest * target[i] + along_current * current[i]);
}

namespace {

template <int K>
void actuation_change(const ActuationBlock<K>& block, const Pack& ratio, const Pack& ratio_change,
                      const Shape<K>& current, const PackRotation& rotation, const Shape<K>& change, Shape<K>& out) {
  Shape<K> target, slope, moved;
  actuation_target<K>(block, ratio, rotation, target, slope);
  for (int i = 0; i < K; ++i) moved[i] = change[i];
  center<K>(moved);
  const Pack3 torque = moment<K>(target, moved) + ratio_change * moment<K>(slope, current);
  const Pack3 turn = turn_response(turn_stiffness<K>(current, target)) * torque;
  for (int i = 0; i < K; ++i) out[i] = block.weight * (cross(turn, target[i]) + ratio_change * slope[i] - moved[i]);
}

}  // namespace

template <int K>
void pull_change_of_actuation(const energy::ActuationBlock<K>& block_kept, const energy::Pack& ratio_kept,
                              const energy::Pack& ratio_change_kept, const energy::Shape<K>& current_kept,
                              const energy::PackRotation& rotation_kept, const energy::Shape<K>& change_kept,
                              energy::Shape<K>& out_kept) {
  actuation_change<K>(wide(block_kept), wide(ratio_kept), wide(ratio_change_kept), wide(current_kept),
                      wide(rotation_kept), wide(change_kept), wide(out_kept));
}

template <int K>
void turned_move_of_body(const energy::BodyBlock<K>& block_kept, const energy::Shape<K>& current_kept,
                         const energy::PackRotation& rotation_kept, const energy::Shape<K>& change_kept,
                         energy::Shape<K>& out_kept) {
  const BodyBlock<K>& block = wide(block_kept);
  const Shape<K>& current = wide(current_kept);
  const PackRotation& rotation = wide(rotation_kept);
  const Shape<K>& change = wide(change_kept);
  Shape<K>& out = wide(out_kept);
  Shape<K> target;
  turned<K>(rotation, block.rest, target);
  turned_move<K>(block.weight, current, target, change, out);
}

template <int K>
void turned_move_of_actuation(const energy::ActuationBlock<K>& block_kept, const energy::Pack& ratio_kept,
                              const energy::Shape<K>& current_kept, const energy::PackRotation& rotation_kept,
                              const energy::Shape<K>& change_kept, energy::Shape<K>& out_kept) {
  const ActuationBlock<K>& block = wide(block_kept);
  const Pack& ratio = wide(ratio_kept);
  const Shape<K>& current = wide(current_kept);
  const PackRotation& rotation = wide(rotation_kept);
  const Shape<K>& change = wide(change_kept);
  Shape<K>& out = wide(out_kept);
  Shape<K> target, slope;
  actuation_target<K>(block, ratio, rotation, target, slope);
  turned_move<K>(block.weight, current, target, change, out);
}

template <int K>
void ratio_change(const energy::ActuationBlock<K>& block_kept, const energy::Shape<K>& current_kept,
                  const energy::Shape<K>& change_kept, double* kept) {
  const ActuationBlock<K>& block = wide(block_kept);
  const Shape<K>& current = wide(current_kept);
  const Shape<K>& change = wide(change_kept);
  Shape<K> slope;
  measure_slope(current, slope);
  keep(inner<K>(slope, change) / block.measure, kept);
}

template <int K>
void ratio_coupling(const energy::ActuationBlock<K>& block_kept, const energy::Pack& ratio_kept,
                    const energy::Shape<K>& current_kept, const energy::PackRotation& rotation_kept,
                    energy::RatioCoupling<K>& out_kept) {
  const ActuationBlock<K>& block = wide(block_kept);
  const Pack& ratio = wide(ratio_kept);
  const Shape<K>& current = wide(current_kept);
  const PackRotation& rotation = wide(rotation_kept);
  RatioCoupling<K>& out = wide(out_kept);
  Shape<K> still;
  for (Pack3& point : still) point = Pack3{};
  actuation_change<K>(block, ratio, pack(1), current, rotation, still, out.pull_slope);
  measure_slope(current, out.ratio_slope);
  for (Pack3& point : out.ratio_slope) point = (1 / block.measure) * point;
}

template <int K>
void stiffness_of_body(const energy::BodyBlock<K>& block_kept, const energy::Shape<K>& current_kept,
                       const energy::PackRotation& rotation_kept, bool projected,
                       energy::TargetStiffness<K>& out_kept) {
  const BodyBlock<K>& block = wide(block_kept);
  const Shape<K>& current = wide(current_kept);
  const PackRotation& rotation = wide(rotation_kept);
  TargetStiffness<K>& out = wide(out_kept);
  Shape<K> target, mode;
  turned<K>(rotation, block.rest, target);
  const Pack33 stiffness = turn_stiffness<K>(current, target);
  for (Pack3& point : mode) point = Pack3{};
  if (!block.blended) {
    const Pack33 compliance =
        projected ? turn_response(stiffness, turn_stiffness<K>(target, target), pack(1)) : turn_response(stiffness);
    assemble<K>(block.weight, pack(1), target, compliance, pack(0), mode, out);
    return;
  }
  const BodyFractions fraction = fractions(block, current);
  const Pack straight = max(-fraction.of_current, pack(0));
  volume_slope(current, mode);
  Shape<K> answer;  // minus the pull's derivative by the volume ratio
  for (int i = 0; i < K; ++i)
    answer[i] = pack(-1) * (fraction.of_rest_slope * target[i] + fraction.of_current_slope * current[i]);
  const Pack slopes = inner<K>(mode, mode);
  const Pack trace = max(inner<K>(answer, mode) / block.volume, pack(0));
  const Pack square = select(slopes > 0, trace / slopes, pack(0));
  // lanes that are not blended are exact unless projected
  const PackMask bounded = block.shape_ratio < (projected ? 2 : 1);
  const Pack least = select(bounded, fraction.of_rest / max(straight, pack(1e-12)), pack(min_turn));
  const Pack33 compliance =
      fraction.of_rest * turn_response(stiffness, turn_stiffness<K>(target, target), max(least, pack(min_turn)));
  assemble<K>(block.weight, straight, target, compliance, square, mode, out);
}

template <int K>
void stiffness_of_actuation(const energy::ActuationBlock<K>& block_kept, const energy::Pack& ratio_kept,
                            bool redistributed, const energy::Shape<K>& current_kept,
                            const energy::PackRotation& rotation_kept, bool projected,
                            energy::TargetStiffness<K>& out_kept) {
  const ActuationBlock<K>& block = wide(block_kept);
  const Pack& ratio = wide(ratio_kept);
  const Shape<K>& current = wide(current_kept);
  const PackRotation& rotation = wide(rotation_kept);
  TargetStiffness<K>& out = wide(out_kept);
  Shape<K> target, mode;
  actuation_target<K>(block, ratio, rotation, target, mode);
  const Pack33 stiffness = turn_stiffness<K>(current, target), inertia = turn_stiffness<K>(target, target);
  const Pack33 compliance =
      projected || redistributed ? turn_response(stiffness, inertia, pack(1)) : turn_response(stiffness);
  Pack square = pack(0);
  if (redistributed) {
    Shape<K> slope;
    measure_slope(current, slope);
    // without its turn, so that the mode and the turns of the target do not add up
    const Pack3 turn = turn_response(inertia) * moment<K>(target, mode);
    for (int i = 0; i < K; ++i) mode[i] = mode[i] - cross(turn, target[i]);
    const Pack size = inner<K>(mode, mode), answer = inner<K>(mode, slope) / block.measure;
    square = select(size > 0, -max(pack(0), min(pack(1), answer)) / size, pack(0));
  }
  assemble<K>(block.weight, pack(1), target, compliance, square, mode, out);
}

template void pull_change_of_body(const energy::BodyBlock<4>&, const energy::Shape<4>&, const energy::PackRotation&,
                                  const energy::Shape<4>&, energy::Shape<4>&);
template void pull_change_of_body(const energy::BodyBlock<6>&, const energy::Shape<6>&, const energy::PackRotation&,
                                  const energy::Shape<6>&, energy::Shape<6>&);
template void pull_change_of_actuation(const energy::ActuationBlock<3>&, const energy::Pack&, const energy::Pack&,
                                       const energy::Shape<3>&, const energy::PackRotation&, const energy::Shape<3>&,
                                       energy::Shape<3>&);
template void pull_change_of_actuation(const energy::ActuationBlock<4>&, const energy::Pack&, const energy::Pack&,
                                       const energy::Shape<4>&, const energy::PackRotation&, const energy::Shape<4>&,
                                       energy::Shape<4>&);
template void pull_change_of_actuation(const energy::ActuationBlock<6>&, const energy::Pack&, const energy::Pack&,
                                       const energy::Shape<6>&, const energy::PackRotation&, const energy::Shape<6>&,
                                       energy::Shape<6>&);
template void turned_move_of_body(const energy::BodyBlock<4>&, const energy::Shape<4>&, const energy::PackRotation&,
                                  const energy::Shape<4>&, energy::Shape<4>&);
template void turned_move_of_body(const energy::BodyBlock<6>&, const energy::Shape<6>&, const energy::PackRotation&,
                                  const energy::Shape<6>&, energy::Shape<6>&);
template void turned_move_of_actuation(const energy::ActuationBlock<3>&, const energy::Pack&, const energy::Shape<3>&,
                                       const energy::PackRotation&, const energy::Shape<3>&, energy::Shape<3>&);
template void turned_move_of_actuation(const energy::ActuationBlock<4>&, const energy::Pack&, const energy::Shape<4>&,
                                       const energy::PackRotation&, const energy::Shape<4>&, energy::Shape<4>&);
template void turned_move_of_actuation(const energy::ActuationBlock<6>&, const energy::Pack&, const energy::Shape<6>&,
                                       const energy::PackRotation&, const energy::Shape<6>&, energy::Shape<6>&);
template void ratio_change(const energy::ActuationBlock<3>&, const energy::Shape<3>&, const energy::Shape<3>&,
                           double* kept);
template void ratio_change(const energy::ActuationBlock<4>&, const energy::Shape<4>&, const energy::Shape<4>&,
                           double* kept);
template void ratio_change(const energy::ActuationBlock<6>&, const energy::Shape<6>&, const energy::Shape<6>&,
                           double* kept);
template void ratio_coupling(const energy::ActuationBlock<3>&, const energy::Pack&, const energy::Shape<3>&,
                             const energy::PackRotation&, energy::RatioCoupling<3>&);
template void ratio_coupling(const energy::ActuationBlock<4>&, const energy::Pack&, const energy::Shape<4>&,
                             const energy::PackRotation&, energy::RatioCoupling<4>&);
template void ratio_coupling(const energy::ActuationBlock<6>&, const energy::Pack&, const energy::Shape<6>&,
                             const energy::PackRotation&, energy::RatioCoupling<6>&);
template void stiffness_of_body(const energy::BodyBlock<4>&, const energy::Shape<4>&, const energy::PackRotation&, bool,
                                energy::TargetStiffness<4>&);
template void stiffness_of_body(const energy::BodyBlock<6>&, const energy::Shape<6>&, const energy::PackRotation&, bool,
                                energy::TargetStiffness<6>&);
template void stiffness_of_actuation(const energy::ActuationBlock<3>&, const energy::Pack&, bool,
                                     const energy::Shape<3>&, const energy::PackRotation&, bool,
                                     energy::TargetStiffness<3>&);
template void stiffness_of_actuation(const energy::ActuationBlock<4>&, const energy::Pack&, bool,
                                     const energy::Shape<4>&, const energy::PackRotation&, bool,
                                     energy::TargetStiffness<4>&);
template void stiffness_of_actuation(const energy::ActuationBlock<6>&, const energy::Pack&, bool,
                                     const energy::Shape<6>&, const energy::PackRotation&, bool,
                                     energy::TargetStiffness<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
