#include <algorithm>
#include <array>
#include <queue>
#include <set>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/maps/polynomials.hpp>
#include <type_traits>
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
  std::array<std::array<double, highest_degree + 1>, max_variables> values, slopes;

  Table(const double* x, const std::vector<int>& highest) {
    for (std::size_t j = 0; j < highest.size(); ++j) chebyshev(x[j], highest[j], values[j].data(), slopes[j].data());
  }

  /// Over the first variables; of one of them the slope.
  [[nodiscard]] double product(const std::uint8_t* degrees, std::size_t count, std::size_t sloped) const {
    double value = 1;
    for (std::size_t j = 0; j < count; ++j) value *= (j == sloped ? slopes : values)[j][degrees[j]];
    return value;
  }
};

std::vector<int> highest_degrees(const Terms& terms) {
  std::vector<int> highest(terms.cols(), 0);
  for (Index t = 0; t < terms.rows(); ++t)
    for (Index j = 0; j < terms.cols(); ++j) highest[j] = std::max<int>(highest[j], terms(t, j));
  return highest;
}

}  // namespace

Terms min_terms(const Eigen::VectorXd& decay, Index count) {
  using Entry = std::pair<double, Degrees>;
  const std::size_t variables = decay.size();
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  std::set<Degrees> seen, chosen;
  next.push({0, Degrees(variables, 0)});
  while (!next.empty() && std::ssize(chosen) < count) {
    const auto [sum, degrees] = next.top();
    next.pop();
    chosen.insert(degrees);
    for (std::size_t j = 0; j < variables; ++j) {
      Degrees above = degrees;
      if (++above[j] > highest_degree || !seen.insert(above).second) continue;
      next.push({sum + decay[j], above});
    }
  }
  Terms terms(chosen.size(), decay.size());
  Index t = 0;
  for (const Degrees& degrees : chosen) {
    for (std::size_t j = 0; j < variables; ++j) terms(t, j) = degrees[j];
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
    const auto product = [&](Index sloped) { return table.product(terms.data() + t * variables, variables, sloped); };
    values[t] = product(variables);
    for (Index j = 0; slopes && j < variables; ++j) (*slopes)(j, t) = product(j);
  }
}

Polynomials::Polynomials(Terms terms, RowMatrix coefficients)
    : terms_(std::move(terms)), coefficients_(std::move(coefficients)), highest_(highest_degrees(terms_)) {
  const Index last = variables() - 1;
  const bool fits = variables() <= max_variables && coefficients_.rows() == terms_.rows() &&
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
  block_ = count() <= 8 ? 8 : count() <= 16 ? 16 : 32;
  for (Index begin = 0; begin < count(); begin += block_)
    for (Index t = 0; t < terms_.rows(); ++t)
      for (Index q = begin; q < begin + block_; ++q) blocks_.push_back(q < count() ? coefficients_(t, q) : 0);
}

/// Sums run by run over the last variable, then those over the others.
template <int width, bool sloped>
void Polynomials::add_up(const double* x, double* values, double* slopes) const {
  using Block = std::array<double, width>;
  const Table table(x, highest_);
  const auto last = static_cast<std::size_t>(variables()) - 1;
  const auto& of_last = table.values[last];
  const auto& slopes_of_last = table.slopes[last];
  const double* row = blocks_.data();
  std::array<Block, max_variables> changes;  // of the sums, by each variable
  for (Index begin = 0; begin < count(); begin += width) {
    Block totals{};
    if constexpr (sloped) std::fill_n(changes.begin(), last + 1, Block{});
    for (const Run& run : runs_) {
      Block sum{}, change{};
      for (std::size_t k = 0; k < static_cast<std::size_t>(run.count); ++k, row += width)
        for (std::size_t q = 0; q < width; ++q) {
          sum[q] += of_last[k] * row[q];
          if constexpr (sloped) change[q] += slopes_of_last[k] * row[q];
        }
      const std::uint8_t* degrees = terms_.data() + run.begin * terms_.cols();
      const double weight = table.product(degrees, last, last);
      for (std::size_t q = 0; q < width; ++q) totals[q] += weight * sum[q];
      if constexpr (!sloped) continue;
      for (std::size_t q = 0; q < width; ++q) changes[last][q] += weight * change[q];
      for (std::size_t j = 0; j < last; ++j) {
        const double by = table.product(degrees, last, j);
        for (std::size_t q = 0; q < width; ++q) changes[j][q] += by * sum[q];
      }
    }
    const Index used = std::min<Index>(width, count() - begin);
    std::copy_n(totals.data(), used, values + begin);
    for (std::size_t j = 0; sloped && j <= last; ++j)
      std::copy_n(changes[j].data(), used, slopes + static_cast<Index>(j) * count() + begin);
  }
}

void Polynomials::evaluate(const double* x, double* values, double* slopes) const {
  if (variables() == 0) {
    std::copy_n(coefficients_.data(), count(), values);
    return;
  }
  const auto add = [&](auto width) {
    if (slopes)
      add_up<width, true>(x, values, slopes);
    else
      add_up<width, false>(x, values, nullptr);
  };
  if (block_ == 8) return add(std::integral_constant<int, 8>());
  if (block_ == 16) return add(std::integral_constant<int, 16>());
  add(std::integral_constant<int, 32>());
}

}  // namespace softkin::maps
