#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/spline_grid.hpp>

namespace softkin::physical {

namespace {

/// Values of B-splines that make up a cell, and their derivatives by the cell's own coordinate.
struct Weights {
  std::array<double, 4> value, slope, second;

  explicit Weights(double u) {
    const double v = 1 - u;
    value = {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6};
    slope = {-v * v / 2, (3 * u * u - 4 * u) / 2, (-3 * v * v + 4 * v) / 2, u * u / 2};
    second = {v, 3 * u - 2, 3 * v - 2, u};
  }
};

/// Returns the coefficients of the splines through `count` values, per value.
Eigen::MatrixXd coefficients_of(Index count) {
  const Index size = count + 2;
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(size, size), values = Eigen::MatrixXd::Zero(size, count);
  const std::array<double, 5> third{1, -4, 6, -4, 1};  // difference of third derivatives
  for (Index i = 0; i < 5; ++i) equations(0, i) = equations(size - 1, size - 1 - i) = third[i];
  for (Index i = 1; i <= count; ++i) {
    equations(i, i - 1) = equations(i, i + 1) = 1.0 / 6;
    equations(i, i) = 4.0 / 6;
    values(i, i - 1) = 1;
  }
  return inverse_of(equations) * values;
}

/// Replaces the values along one axis by spline coefficients.
void filter(int axis, std::array<Index, 3>& counts, std::vector<Vec3>& values) {
  const Eigen::MatrixXd of = coefficients_of(counts[axis]);
  std::array<Index, 3> wider = counts;
  wider[axis] += 2;
  const auto place = [](const std::array<Index, 3>& in, const std::array<Index, 3>& at) {
    return static_cast<std::size_t>(at[0]) +
           static_cast<std::size_t>(in[0]) *
               (static_cast<std::size_t>(at[1]) + static_cast<std::size_t>(in[1]) * static_cast<std::size_t>(at[2]));
  };
  std::vector<Vec3> filtered(values.size() / static_cast<std::size_t>(counts[axis]) *
                             static_cast<std::size_t>(wider[axis]));
  std::array<Index, 3> at{};
  for (at[2] = 0; at[2] < wider[2]; ++at[2])
    for (at[1] = 0; at[1] < wider[1]; ++at[1])
      for (at[0] = 0; at[0] < wider[0]; ++at[0]) {
        Vec3 sum = Vec3::Zero();
        std::array<Index, 3> from = at;
        for (from[axis] = 0; from[axis] < counts[axis]; ++from[axis])
          sum += of(at[axis], from[axis]) * values[place(counts, from)];
        filtered[place(wider, at)] = sum;
      }
  counts = wider;
  values = std::move(filtered);
}

}  // namespace

SplineGrid::SplineGrid(const GridField& grid)
    : low_(grid.low), step_(grid.step), counts_(grid.counts), coefficients_(grid.per_ampere) {
  std::array<Index, 3> counts = counts_;
  for (int axis = 0; axis < 3; ++axis) filter(axis, counts, coefficients_);
}

bool SplineGrid::add(const Vec3& place, double scale, Flux& out) const {
  constexpr double rounding = 1e-9;  // of a step
  std::array<std::size_t, 3> cell{};
  std::array<Weights, 3> w{Weights(0), Weights(0), Weights(0)};
  for (int axis = 0; axis < 3; ++axis) {
    const double at = (place[axis] - low_[axis]) / step_[axis], last = counts_[axis] - 1;
    if (!(at >= -rounding && at <= last + rounding)) return false;
    const double begin = std::clamp(std::floor(at), 0.0, last - 1);
    cell[axis] = static_cast<std::size_t>(begin);
    w[axis] = Weights(at - begin);
    for (int i = 0; i < 4; ++i) {
      w[axis].slope[i] /= step_[axis];
      w[axis].second[i] /= step_[axis] * step_[axis];
    }
  }
  const auto row = static_cast<std::size_t>(counts_[0] + 2), plane = row * static_cast<std::size_t>(counts_[1] + 2);
  const auto& [x, y, z] = w;
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 4; ++i) {
        const Vec3 c = scale * coefficients_[cell[0] + i + row * (cell[1] + j) + plane * (cell[2] + k)];
        const Vec3 first(x.slope[i] * y.value[j] * z.value[k], x.value[i] * y.slope[j] * z.value[k],
                         x.value[i] * y.value[j] * z.slope[k]);
        Mat3 second;
        second(0, 0) = x.second[i] * y.value[j] * z.value[k];
        second(1, 1) = x.value[i] * y.second[j] * z.value[k];
        second(2, 2) = x.value[i] * y.value[j] * z.second[k];
        second(0, 1) = second(1, 0) = x.slope[i] * y.slope[j] * z.value[k];
        second(0, 2) = second(2, 0) = x.slope[i] * y.value[j] * z.slope[k];
        second(1, 2) = second(2, 1) = x.value[i] * y.slope[j] * z.slope[k];
        out.value += x.value[i] * y.value[j] * z.value[k] * c;
        out.slope += c * first.transpose();
        for (int d = 0; d < 3; ++d) out.second[d] += c[d] * second;
      }
  return true;
}

}  // namespace softkin::physical
