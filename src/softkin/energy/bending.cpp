#include <softkin/energy/bending.hpp>

namespace softkin::energy {

namespace {

/// Column `number` of a shape whose first one is variable number `first`.
template <class Number, class Shape>
Vector3Of<Number> column(const Shape& shape, int number, int first) {
  Vector3Of<Number> out;
  for (int i = 0; i < 3; ++i) {
    if constexpr (std::is_same_v<Number, double>)
      out[i] = shape(i, number);
    else
      out[i] = Number::variable(shape(i, number), 3 * (first + number) + i);
  }
  return out;
}

template <class Number>
std::array<Number, 3> curvature(const SheetShape& shape) {
  const auto at = [&](int i) { return column<Number>(shape, i, 0); };
  const Vector3Of<Number> normal = normalized(cross(at(0), at(1)));
  return {dot(normal, at(2)), dot(normal, at(3)), 2.0 * dot(normal, at(4))};
}

template <class Number>
Number place_energy(const BendingPlace& place, const SheetShape& shape) {
  std::array<Number, 3> bent = curvature<Number>(shape);
  for (int i = 0; i < 3; ++i) bent[i] = bent[i] - place.rest[i];
  Number energy = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) energy = energy + (place.stiffness(i, j) / 2) * (bent[i] * bent[j]);
  return energy;
}

/// The jump of the slope, and the moments of both sides.
template <class Number>
struct Jump {
  Number angle;
  std::array<Number, 2> moment;

  Jump(const BendingJoint& joint, const SideShape& first, const SideShape& second) {
    const std::array<const SideShape*, 2> sides{&first, &second};
    std::array<Vector3Of<Number>, 2> normal;
    for (std::size_t s = 0; s < 2; ++s) {
      const auto at = [&](int i) { return column<Number>(*sides[s], i, static_cast<int>(3 * s)); };
      normal[s] = scaled(Number(joint.upwards[s]), normalized(cross(at(0), at(1))));
      moment[s] = dot(normal[s], at(2));
    }
    Vector3Of<Number> edge;
    const auto one = column<Number>(first, 0, 0), two = column<Number>(first, 1, 0);
    for (std::size_t i = 0; i < 3; ++i) edge[i] = joint.along[0] * one[i] + joint.along[1] * two[i];
    angle = angle_of(dot(cross(normal[1], normal[0]), normalized(edge)), dot(normal[0], normal[1]));
  }
};

template <class Number>
Number joint_energy(const BendingJoint& joint, const SideShape& first, const SideShape& second) {
  const Jump<Number> jump(joint, first, second);
  const Number angle = jump.angle - joint.angle;
  Number moment = (joint.penalty / 2) * angle;
  for (std::size_t s = 0; s < 2; ++s) moment = moment + joint.fraction[s] * (jump.moment[s] - joint.moment[s]);
  return joint.length * (moment * angle);
}

template <int N, class Energy>
BendingResponse<N> differentiated(bool second, const Energy& energy) {
  BendingResponse<N> out;
  if (second) {
    const auto found = energy(Jet<N, 2>());
    out.energy = found.value;
    out.gradient = found.gradient;
    out.hessian = found.hessian;
  } else {
    const auto found = energy(Jet<N, 1>());
    out.energy = found.value;
    out.gradient = found.gradient;
  }
  return out;
}

}  // namespace

Vec3 curvature_of(const SheetShape& shape) {
  const std::array<double, 3> found = curvature<double>(shape);
  return {found[0], found[1], found[2]};
}

BendingResponse<15> bend(const BendingPlace& place, const SheetShape& shape, bool second) {
  return differentiated<15>(second,
                            [&](const auto& kind) { return place_energy<std::decay_t<decltype(kind)>>(place, shape); });
}

double joint_angle(const BendingJoint& joint, const SideShape& first, const SideShape& second) {
  return Jump<double>(joint, first, second).angle;
}

BendingResponse<18> bend(const BendingJoint& joint, const SideShape& first, const SideShape& second,
                         bool second_order) {
  return differentiated<18>(
      second_order, [&](const auto& kind) { return joint_energy<std::decay_t<decltype(kind)>>(joint, first, second); });
}

}  // namespace softkin::energy
