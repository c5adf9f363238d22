#include <softkin/energy/kernels/target_shape_parts.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

template <int K>
void finish(const Pack& weight, ElementPull<K>& out) {
  Pack squares = pack(0);
  for (int i = 0; i < K; ++i) {
    squares += dot(out.pull[i], out.pull[i]);
    out.pull[i] = weight * out.pull[i];
  }
  out.energy = weight * squares;
}

Pack mean_area(const Shape<6>& p) {
  return 0.25 * (norm(cross(p[1] - p[0], p[2] - p[0])) + norm(cross(p[4] - p[3], p[5] - p[3])));
}

Pack measure(const Shape<3>& current) {
  return norm(current[1] - current[0]);
}
Pack measure(const Shape<4>& current) {
  return volume(current);
}
Pack measure(const Shape<6>& current) {
  return mean_area(current);
}

}  // namespace

void volume_of_blocks(const energy::Shape<4>& current, double* kept) {
  keep(volume(wide(current)), kept);
}
void volume_of_blocks(const energy::Shape<6>& current, double* kept) {
  keep(volume(wide(current)), kept);
}

template <int K>
void current_ratio(const energy::ActuationBlock<K>& block_kept, const energy::Shape<K>& current_kept, double* kept) {
  const ActuationBlock<K>& block = wide(block_kept);
  const Shape<K>& current = wide(current_kept);
  keep(measure(current) / block.measure, kept);
}

template <int K>
void pull_of_body(const energy::BodyBlock<K>& block_kept, energy::Shape<K>& current_kept,
                  energy::PackRotation& rotation_kept, energy::ElementPull<K>& out_kept) {
  const BodyBlock<K>& block = wide(block_kept);
  Shape<K>& current = wide(current_kept);
  PackRotation& rotation = wide(rotation_kept);
  ElementPull<K>& out = wide(out_kept);
  center<K>(current);
  best_rotation(correlation<K>(current, block.rest), rotation);
  const Pack33 turned = to_matrix(rotation);
  if (!block.blended) {
    for (int i = 0; i < K; ++i) out.pull[i] = turned * block.rest[i] - current[i];
  } else {
    Pack scaled, rigid;
    soft_target(volume(current) / block.volume, scaled, rigid);
    const Pack soft = 1 - block.shape_ratio;
    const Pack of_rest = block.shape_ratio + soft * rigid, of_current = soft * scaled - 1;
    for (int i = 0; i < K; ++i) out.pull[i] = of_rest * (turned * block.rest[i]) + of_current * current[i];
  }
  finish<K>(block.weight, out);
}

template <int K>
void pull_of_actuation(const energy::ActuationBlock<K>& block_kept, const energy::Pack& ratio_kept,
                       energy::Shape<K>& current_kept, energy::PackRotation& rotation_kept,
                       energy::ElementPull<K>& out_kept) {
  const ActuationBlock<K>& block = wide(block_kept);
  const Pack& ratio = wide(ratio_kept);
  Shape<K>& current = wide(current_kept);
  PackRotation& rotation = wide(rotation_kept);
  ElementPull<K>& out = wide(out_kept);
  Pack grown, thinned;
  growth(block, ratio, grown, thinned);
  Shape<K> target;
  for (int i = 0; i < K; ++i) target[i] = block.constant[i] + grown * block.grown[i] + thinned * block.thinned[i];
  center<K>(current);
  best_rotation(correlation<K>(current, target), rotation);
  const Pack33 turned = to_matrix(rotation);
  for (int i = 0; i < K; ++i) out.pull[i] = turned * target[i] - current[i];
  finish<K>(block.weight, out);
}

template void current_ratio(const energy::ActuationBlock<3>&, const energy::Shape<3>&, double* kept);
template void current_ratio(const energy::ActuationBlock<4>&, const energy::Shape<4>&, double* kept);
template void current_ratio(const energy::ActuationBlock<6>&, const energy::Shape<6>&, double* kept);
template void pull_of_body(const energy::BodyBlock<4>&, energy::Shape<4>&, energy::PackRotation&,
                           energy::ElementPull<4>&);
template void pull_of_body(const energy::BodyBlock<6>&, energy::Shape<6>&, energy::PackRotation&,
                           energy::ElementPull<6>&);
template void pull_of_actuation(const energy::ActuationBlock<3>&, const energy::Pack&, energy::Shape<3>&,
                                energy::PackRotation&, energy::ElementPull<3>&);
template void pull_of_actuation(const energy::ActuationBlock<4>&, const energy::Pack&, energy::Shape<4>&,
                                energy::PackRotation&, energy::ElementPull<4>&);
template void pull_of_actuation(const energy::ActuationBlock<6>&, const energy::Pack&, energy::Shape<6>&,
                                energy::PackRotation&, energy::ElementPull<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
