#include "rates.hpp"

#include <algorithm>
#include <softkin/linear/front_kernel.hpp>

#include "machine.hpp"

namespace softkin::bench {

namespace {

constexpr int runs = 5;

double dgemm_rate(Team& team) {
  constexpr Index size = 960;
  const Index count = team.size();
  std::vector<Eigen::MatrixXd> a(count), b(count), c(count);
  for (Index i = 0; i < count; ++i) {
    a[i] = Eigen::MatrixXd::Random(size, size);
    b[i] = Eigen::MatrixXd::Random(size, size);
    c[i] = Eigen::MatrixXd::Zero(size, size);
  }
  double best = 0;
  for (int run = 0; run < runs; ++run) {
    const double begin = now();
    team.each(count, [&](Index i) { c[i].noalias() = a[i] * b[i]; });
    best = std::max(best, 2.0 * size * size * size * count / (now() - begin));
  }
  return best;
}

double front_rate(Team& team) {
  constexpr Index size = 4000, stride = linear::front_stride(size);
  std::vector<double> front(static_cast<std::size_t>(size) * stride), diagonal(size);
  linear::FrontWork work;
  double best = 0;
  for (int run = 0; run < 3; ++run) {
    std::fill(front.begin(), front.end(), 0.01);
    for (Index i = 0; i < size; ++i) front[static_cast<std::size_t>(i) * stride + i] = size;
    const double begin = now();
    (void)linear::factor_front(front.data(), size, size, 1e-9, diagonal.data(), work, team);
    best = std::max(best, 1.0 / 3 * size * size * size / (now() - begin));
  }
  return best;
}

double triad_rate(Team& team) {
  constexpr Index size = 20'000'000;
  std::vector<double> a(size), b(size, 1.0), c(size, 2.0);
  double best = 0;
  for (int run = 0; run < runs; ++run) {
    const double begin = now();
    team.pieces(size, [&](Index from, Index to) {
      for (Index i = from; i < to; ++i) a[i] = b[i] + 3.0 * c[i];
    });
    best = std::max(best, 24.0 * size / (now() - begin));
  }
  return best;
}

}  // namespace

Rates measure_rates(Team& team) {
  return {dgemm_rate(team), front_rate(team), triad_rate(team)};
}

}  // namespace softkin::bench
