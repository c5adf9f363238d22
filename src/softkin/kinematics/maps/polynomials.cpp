#include <algorithm>
#include <array>
#include <queue>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/maps/polynomials.hpp>
#include <utility>

namespace softkin::maps {

namespace {

using Degrees = std::vector<std::uint8_t>;

/// T_0 ... T_n and their slopes. Those are n U_(n-1).
void chebyshev(double x, int highest, double* values, double* slopes) {
  values[0] = 1;
  slopes[0] = 0;
  if (highest == 0) return;
  values[1] = x;
  slopes[1] = 1;
  double before = 1, second = 2 * x;  // U_0, U_1
  for (int n = 2; n <= highest; ++n) {
    values[n] = 2 * x * values[n - 1] - values[n - 2];
    slopes[n] = n * second;
    before = std::exchange(second, 2 * x * second - before);
  }
}

struct Table {
  std::array<std::array<double, highest_degree + 1>, most_variables> values, slopes;

  Table(const double* x, const std::vector<int>& highest) {
    for (std::size_t j = 0; j < highest.size(); ++j) chebyshev(x[j], highest[j], values[j].data(), slopes[j].data());
  }
};

std::vector<int> highest_degrees(const Terms& terms) {
  std::vector<int> highest(static_cast<std::size_t>(terms.cols()), 0);
  for (Index t = 0; t < terms.rows(); ++t)
    for (Index j = 0; j < terms.cols(); ++j)
      highest[static_cast<std::size_t>(j)] = std::max<int>(highest[static_cast<std::size_t>(j)], terms(t, j));
  return highest;
}

}  // namespace

Terms least_terms(const Eigen::VectorXd& decay, Index count) {
  using Entry = std::pair<double, Degrees>;
  const auto variables = static_cast<std::size_t>(decay.size());
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  std::set<Degrees> seen, chosen;
  next.push({0, Degrees(variables, 0)});
  while (!next.empty() && static_cast<Index>(chosen.size()) < count) {
    const auto [sum, degrees] = next.top();
    next.pop();
    chosen.insert(degrees);
    for (std::size_t j = 0; j < variables; ++j) {
      Degrees above = degrees;
      if (++above[j] > highest_degree || !seen.insert(above).second) continue;
      next.push({sum + decay[static_cast<Index>(j)], above});
    }
  }
  Terms terms(static_cast<Index>(chosen.size()), decay.size());
  Index t = 0;
  for (const Degrees& degrees : chosen) {
    for (std::size_t j = 0; j < variables; ++j) terms(t, static_cast<Index>(j)) = degrees[j];
    ++t;
  }
  return terms;
}

void evaluate_terms(const Terms& terms, const Eigen::VectorXd& x, Eigen::VectorXd& values, RowMatrix* slopes) {
  const Index variables = terms.cols();
  const Table table(x.data(), highest_degrees(terms));
  values.resize(terms.rows());
  if (slopes) slopes->resize(variables, terms.rows());
  for (Index t = 0; t < terms.rows(); ++t) {
    const auto product = [&](Index sloped) {
      double value = 1;
      for (Index j = 0; j < variables; ++j) {
        const auto place = static_cast<std::size_t>(j);
        value *= (j == sloped ? table.slopes : table.values)[place][terms(t, j)];
      }
      return value;
    };
    values[t] = product(-1);
    for (Index j = 0; slopes && j < variables; ++j) (*slopes)(j, t) = product(j);
  }
}

Polynomials::Polynomials(Terms terms, RowMatrix coefficients)
    : terms_(std::move(terms)), coefficients_(std::move(coefficients)), highest_(highest_degrees(terms_)) {
  const Index last = variables() - 1;
  const bool fits = variables() <= most_variables && coefficients_.rows() == terms_.rows() &&
                    std::all_of(highest_.begin(), highest_.end(), [](int degree) { return degree <= highest_degree; });
  if (!fits) throw InvalidInput("sums of polynomials have too many variables or degrees, or other coefficients");
  for (Index t = 0; t < terms_.rows(); ++t) {
    if (last < 0 || terms_(t, last) == 0) {
      runs_.push_back({t, 0});
    } else if (t == 0 || terms_(t, last) != terms_(t - 1, last) + 1 ||
               terms_.row(t).head(last) != terms_.row(t - 1).head(last)) {
      throw InvalidInput("terms are not in the order of their degrees");
    }
    ++runs_.back().count;
  }
}

/// Sums run by run over the last variable, then those over the others.
void Polynomials::evaluate(const double* x, double* values, double* slopes) const {
  const Index size = count(), last = variables() - 1;
  std::fill_n(values, size, 0.0);
  if (slopes) std::fill_n(slopes, size * variables(), 0.0);
  if (last < 0) {
    std::copy_n(coefficients_.data(), size, values);
    return;
  }
  const Table table(x, highest_);
  const double* of_last = table.values[static_cast<std::size_t>(last)].data();
  const double* slopes_of_last = table.slopes[static_cast<std::size_t>(last)].data();
  constexpr Index block = 32;
  std::array<double, block> sum, sloped;
  std::array<double, most_variables> weights{};
  for (const Run& run : runs_) {
    double weight = 1;
    for (Index j = 0; j < last; ++j) weight *= table.values[static_cast<std::size_t>(j)][terms_(run.begin, j)];
    for (Index j = 0; slopes && j < last; ++j) {
      weights[static_cast<std::size_t>(j)] = 1;
      for (Index k = 0; k < last; ++k)
        weights[static_cast<std::size_t>(j)] *=
            (k == j ? table.slopes : table.values)[static_cast<std::size_t>(k)][terms_(run.begin, k)];
    }
    for (Index begin = 0; begin < size; begin += block) {
      const Index width = std::min(block, size - begin);
      std::fill_n(sum.begin(), width, 0.0);
      std::fill_n(sloped.begin(), width, 0.0);
      for (Index k = 0; k < run.count; ++k) {
        const double* row = coefficients_.data() + (run.begin + k) * size + begin;
        const double value = of_last[k], slope = slopes_of_last[k];
        for (Index q = 0; q < width; ++q) sum[static_cast<std::size_t>(q)] += value * row[q];
        if (slopes)
          for (Index q = 0; q < width; ++q) sloped[static_cast<std::size_t>(q)] += slope * row[q];
      }
      for (Index q = 0; q < width; ++q) values[begin + q] += weight * sum[static_cast<std::size_t>(q)];
      if (!slopes) continue;
      for (Index j = 0; j < last; ++j)
        for (Index q = 0; q < width; ++q)
          slopes[j * size + begin + q] += weights[static_cast<std::size_t>(j)] * sum[static_cast<std::size_t>(q)];
      for (Index q = 0; q < width; ++q) slopes[last * size + begin + q] += weight * sloped[static_cast<std::size_t>(q)];
    }
  }
}

}  // namespace softkin::maps
