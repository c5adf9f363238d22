#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::maps {

/// Degrees of a term in each variable, a row per term.
using Terms = Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int max_variables = 8, highest_degree = 60;

/// The terms with the least sums of decay times degree over the variables, sorted by their degrees, the last variable
/// fastest: with each term all that have lower degrees.
///
/// decay  d values > 0, d <= max_variables
/// count  how many, >= 1; fewer where no degree is above highest_degree
[[nodiscard]] Terms min_terms(const Eigen::VectorXd& decay, Index count);

/// Products of Chebyshev polynomials in d variables from -1 to 1, one per term.
///
/// slopes  returns d by #terms; null: not requested
void evaluate_terms(const Terms& terms, const Eigen::VectorXd& x, Eigen::VectorXd& values, RowMatrix* slopes);

/// p sums of such products.
class Polynomials {
 public:
  Polynomials() = default;
  /// terms         sorted as those of min_terms()
  /// coefficients  #terms by p
  /// throws        InvalidInput on terms in another order or beyond the limits above
  Polynomials(Terms terms, RowMatrix coefficients);

  [[nodiscard]] Index variables() const { return terms_.cols(); }
  [[nodiscard]] Index count() const { return coefficients_.cols(); }
  [[nodiscard]] const Terms& terms() const { return terms_; }
  [[nodiscard]] const RowMatrix& coefficients() const { return coefficients_; }

  /// x       d values from -1 to 1
  /// values  p
  /// slopes  d by p, by rows; null: not requested
  void evaluate(const double* x, double* values, double* slopes = nullptr) const;

 private:
  /// Terms that differ in the last variable alone, whose degree is 0, 1, ...
  struct Run {
    Index begin = 0, count = 0;  // terms
  };

  template <int width, bool sloped>
  void add_up(const double* x, double* values, double* slopes) const;

  Terms terms_;
  RowMatrix coefficients_;
  std::vector<Run> runs_;
  std::vector<int> highest_;  // degree per variable
  // sums go together in blocks that fill whole registers, of 8, 16 or 32; those that are missing are zero
  int block_ = 8;
  std::vector<double> blocks_;  // coefficients, block by block
};

/// The number whose bits they are, the first the lowest.
[[nodiscard]] inline Index bits_of(const std::vector<bool>& flags) {
  Index number = 0;
  for (std::size_t i = 0; i < flags.size(); ++i) number |= static_cast<Index>(flags[i]) << i;
  return number;
}

}  // namespace softkin::maps
