#include <softkin/energy/kernels/elastic_law_point.hpp>
#include <softkin/energy/kernels/elastic_polar.hpp>
#include <softkin/energy/kernels/rotation_wide.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

namespace {

/// Rate w at which the rotation R of F = R S turns, in space: R^T w = (tr(S) I - S)^-1 axial(R^T F' - F'^T R).
Pack3 spin(const Polar& polar, const Pack33& rate) {
  const Pack33 q = transpose_times(polar.rotation, rate);
  const Pack3 axial{q.row[2].y - q.row[1].z, q.row[0].z - q.row[2].x, q.row[1].x - q.row[0].y};
  const Pack3 w = polar.rotation * (polar_turn_compliance(polar.stretch) * axial);
  // more than two turns: the rotation was not unique, and has no rate
  return select(norm(w) < 12, pack(1), pack(0)) * w;
}

PackRotation exponential(const Pack3& turn) {
  const Pack square = dot(turn, turn);
  PackRotation q;
  Pack scale;
  if (!any(square > 0.04)) {  // series, to rounding
    q.w = 1 - square * (1.0 / 8 - square * (1.0 / 384 - square * (1.0 / 46080 - square * (1.0 / 10321920))));
    scale = 0.5 - square * (1.0 / 48 - square * (1.0 / 3840 - square * (1.0 / 645120 - square * (1.0 / 185794560))));
    q.x = scale * turn.x;
    q.y = scale * turn.y;
    q.z = scale * turn.z;
    return q;
  }
  const Pack angle = sqrt(square);
  for (int l = 0; l < lanes; ++l) {
    q.w[l] = __builtin_cos(0.5 * angle[l]);
    scale[l] = angle[l] > 1e-8 ? __builtin_sin(0.5 * angle[l]) / angle[l] : 0.5;
  }
  q.x = scale * turn.x;
  q.y = scale * turn.y;
  q.z = scale * turn.z;
  return q;
}

}  // namespace

template <int K, int Q>
void turning_pull(const energy::ElasticBlock<K, Q>& elements, const energy::Shape<K>& shape,
                  const energy::Shape<K>& moves, energy::Shape<K>& out) {
  const ElasticBlock<K, Q>& block = wide(elements);
  const Shape<K>&current = wide(shape), &step = wide(moves);
  Shape<K>& pull = wide(out);
  for (int a = 0; a < K; ++a) pull[a] = Pack3{pack(0), pack(0), pack(0)};
  for (int q = 0; q < Q; ++q) {
    const Pack33 gradient = deformation_gradient<K>(block.slope[q], current);
    const Pack33 rate = deformation_gradient<K>(block.slope[q], step);
    const Pack3 w = spin(polar(gradient), rate);
    Pack33 ahead, still;
    for (int i = 0; i < 3; ++i) ahead.row[i] = gradient.row[i] + rate.row[i];
    still.row[0] = ahead.row[0] - (w.y * gradient.row[2] - w.z * gradient.row[1]);
    still.row[1] = ahead.row[1] - (w.z * gradient.row[0] - w.x * gradient.row[2]);
    still.row[2] = ahead.row[2] - (w.x * gradient.row[1] - w.y * gradient.row[0]);
    const Pack33 turned = times(to_matrix(exponential(w)), still);
    for (int a = 0; a < K; ++a) {
      const Pack3 slope = block.volume[q] * block.slope[q][a];
      pull[a].x += dot(turned.row[0] - ahead.row[0], slope);
      pull[a].y += dot(turned.row[1] - ahead.row[1], slope);
      pull[a].z += dot(turned.row[2] - ahead.row[2], slope);
    }
  }
}

template void turning_pull<4, 1>(const energy::ElasticBlock<4, 1>&, const energy::Shape<4>&, const energy::Shape<4>&,
                                 energy::Shape<4>&);
template void turning_pull<10, 4>(const energy::ElasticBlock<10, 4>&, const energy::Shape<10>&,
                                  const energy::Shape<10>&, energy::Shape<10>&);
template void turning_pull<6, 6>(const energy::ElasticBlock<6, 6>&, const energy::Shape<6>&, const energy::Shape<6>&,
                                 energy::Shape<6>&);

}  // namespace softkin::energy::SOFTKIN_TARGET
