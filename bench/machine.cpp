#include "machine.hpp"

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/linear/front_kernel.hpp>
#include <thread>

#include "kernels/dense_product.hpp"

namespace softkin::bench {

namespace {

std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "unknown processor";
}

constexpr int runs = 5;

template <class Number>
void multiply(const Number* a, const Number* b, Number* c, Index size) {
  SOFTKIN_RUN_KERNEL(multiply_dense(a, b, c, size));
}

double front_rate(Team& team) {
  constexpr Index size = 4000, stride = linear::front_stride<double>(size);
  std::vector<double> front(static_cast<std::size_t>(size) * stride), diagonal(size);
  linear::FrontWork<double> work;
  double best = 0;
  for (int run = 0; run < 3; ++run) {
    std::fill(front.begin(), front.end(), 0.01);
    for (Index i = 0; i < size; ++i) front[static_cast<std::size_t>(i) * stride + i] = size;
    const double begin = now();
    (void)linear::factor_front<double>({front.data(), nullptr, size, size}, 1e-9, diagonal.data(), work, team);
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

template <class Number>
double product_rate(Team& team) {
  constexpr Index size = 960;
  const Index count = team.size();
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  std::vector<Matrix> a(count), b(count), c(count);
  for (Index i = 0; i < count; ++i) {
    a[i] = Matrix::Random(size, size);
    b[i] = Matrix::Random(size, size);
    c[i] = Matrix::Zero(size, size);
  }
  double best = 0;
  for (int run = 0; run < runs; ++run) {
    const double begin = now();
    team.each(count, [&](Index i) { multiply(a[i].data(), b[i].data(), c[i].data(), size); });
    best = std::max(best, 2.0 * size * size * size * count / (now() - begin));
  }
  return best;
}

template double product_rate<double>(Team&);
template double product_rate<float>(Team&);

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  if (values.empty()) throw InvalidInput("the median of no values");
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double growth(const std::vector<double>& sizes, const std::vector<double>& times) {
  if (sizes.size() < 2 || sizes.size() != times.size()) throw InvalidInput("growth needs two sizes or more");
  const auto n = static_cast<double>(sizes.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double x = std::log(sizes[i]), y = std::log(times[i]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::string machine_text() {
  const double gibibytes =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1073741824.0;
  return processor() + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, " +
         std::to_string(std::lround(gibibytes)) + " GiB; instruction set " + name_of(target()) +
         "; compiler " __VERSION__ ", flags " SOFTKIN_BENCH_FLAGS;
}

Rates measure_rates(Team& team) {
  return {product_rate<double>(team), front_rate(team), triad_rate(team)};
}

}  // namespace softkin::bench
