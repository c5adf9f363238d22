#include <Eigen/Geometry>
#include <softkin/energy/target_shape_parts.hpp>

namespace softkin::energy {

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

Pack six_volumes(const Pack3& a, const Pack3& b, const Pack3& c) {
  return dot(a, cross(b, c));
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

Pack volume(const Shape<4>& p) {
  return six_volumes(p[1] - p[0], p[2] - p[0], p[3] - p[0]) / 6;
}

Pack volume(const Shape<6>& v) {
  Shape<6> p;
  for (int i = 0; i < 6; ++i) p[i] = v[i] - v[0];
  Pack six = six_volumes(p[0], p[2], p[1]) + six_volumes(p[3], p[4], p[5]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    six += 0.5 * (six_volumes(p[i], p[j], p[j + 3]) + six_volumes(p[i], p[j + 3], p[i + 3]) +
                  six_volumes(p[i], p[j], p[i + 3]) + six_volumes(p[j], p[j + 3], p[i + 3]));
  }
  return six / 6;
}

template <int K>
Pack current_ratio(const ActuationBlock<K>& block, const Shape<K>& current) {
  return measure(current) / block.measure;
}

template <int K>
void pull_of_body(const BodyBlock<K>& block, Shape<K>& current, PackRotation& rotation, ElementPull<K>& out) {
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
void pull_of_actuation(const ActuationBlock<K>& block, const Pack& ratio, Shape<K>& current, PackRotation& rotation,
                       ElementPull<K>& out) {
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

template Pack current_ratio(const ActuationBlock<3>&, const Shape<3>&);
template Pack current_ratio(const ActuationBlock<4>&, const Shape<4>&);
template Pack current_ratio(const ActuationBlock<6>&, const Shape<6>&);
template void pull_of_body(const BodyBlock<4>&, Shape<4>&, PackRotation&, ElementPull<4>&);
template void pull_of_body(const BodyBlock<6>&, Shape<6>&, PackRotation&, ElementPull<6>&);
template void pull_of_actuation(const ActuationBlock<3>&, const Pack&, Shape<3>&, PackRotation&, ElementPull<3>&);
template void pull_of_actuation(const ActuationBlock<4>&, const Pack&, Shape<4>&, PackRotation&, ElementPull<4>&);
template void pull_of_actuation(const ActuationBlock<6>&, const Pack&, Shape<6>&, PackRotation&, ElementPull<6>&);

TargetSplit<3> split_cable(const Eigen::Matrix<double, 3, 3>& rest) {
  const Eigen::Matrix<double, 3, 3> centred = rest.rowwise() - rest.colwise().mean();
  const Vec3 along = (rest.row(1) - rest.row(0)).normalized().transpose();
  TargetSplit<3> split;
  split.grown = centred * along * along.transpose();
  split.constant = centred - split.grown;
  split.thinned.setZero();
  return split;
}

TargetSplit<4> split_pneumatic(const Eigen::Matrix<double, 4, 3>& rest) {
  TargetSplit<4> split;
  split.grown = rest.rowwise() - rest.colwise().mean();
  split.constant.setZero();
  split.thinned.setZero();
  return split;
}

TargetSplit<6> split_dea(const Eigen::Matrix<double, 6, 3>& rest) {
  const Eigen::RowVector3d middle = rest.colwise().mean();
  TargetSplit<6> split;
  Vec3 normal = Vec3::Zero();
  for (int t = 0; t < 6; t += 3)
    normal += (rest.row(t + 1) - rest.row(t)).cross(rest.row(t + 2) - rest.row(t)).transpose();
  normal.normalize();
  for (int t = 0; t < 6; t += 3) {
    const Eigen::RowVector3d center = rest.middleRows<3>(t).colwise().mean();
    const Eigen::RowVector3d thickness = (center - middle).dot(normal) * normal.transpose();
    for (int i = t; i < t + 3; ++i) {
      split.grown.row(i) = rest.row(i) - center;
      split.thinned.row(i) = thickness;
      split.constant.row(i) = center - middle - thickness;
    }
  }
  return split;
}

}  // namespace softkin::energy
