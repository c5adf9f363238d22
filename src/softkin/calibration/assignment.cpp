#include <limits>
#include <softkin/calibration/assignment.hpp>

namespace softkin::calibration {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Rows that have columns, and what keeps these pairs the cheapest. Row and column 0 are none.
class Pairs {
 public:
  explicit Pairs(const Eigen::MatrixXd& costs)
      : costs_(costs), of_row_(size(costs.rows())), of_column_(size(costs.cols())), row_at_(of_column_.size()) {}

  /// Adds a pair for one more row: along the cheapest augmenting path to a free column.
  void add(std::size_t row) {
    const std::size_t columns = row_at_.size();
    std::vector<double> least(columns, infinite);
    std::vector<std::size_t> before(columns);
    std::vector<bool> used(columns);
    row_at_[0] = row;
    std::size_t at = 0;
    do {
      used[at] = true;
      std::size_t next = 0;
      double step = infinite;
      for (std::size_t c = 1; c < columns; ++c) {
        if (used[c]) continue;
        if (const double cost = reduced(row_at_[at], c); cost < least[c]) least[c] = cost, before[c] = at;
        if (least[c] < step) step = least[c], next = c;
      }
      for (std::size_t c = 0; c < columns; ++c)
        if (used[c])
          of_row_[row_at_[c]] += step, of_column_[c] -= step;
        else
          least[c] -= step;
      at = next;
    } while (row_at_[at] != 0);
    for (; at != 0; at = before[at]) row_at_[at] = row_at_[before[at]];
  }

  /// Of a column; 0: none.
  [[nodiscard]] std::size_t row_at(std::size_t column) const { return row_at_[column]; }

 private:
  static std::size_t size(Eigen::Index count) { return static_cast<std::size_t>(count) + 1; }

  [[nodiscard]] double reduced(std::size_t row, std::size_t column) const {
    return costs_(static_cast<Eigen::Index>(row) - 1, static_cast<Eigen::Index>(column) - 1) - of_row_[row] -
           of_column_[column];
  }

  const Eigen::MatrixXd& costs_;
  std::vector<double> of_row_, of_column_;
  std::vector<std::size_t> row_at_;  // per column
};

}  // namespace

std::vector<Index> min_assignment(const Eigen::MatrixXd& costs, double alone) {
  const Eigen::Index rows = costs.rows(), columns = costs.cols();
  Eigen::MatrixXd all(rows, columns + rows);  // a column for each row that has no other
  all.leftCols(columns) = costs.cwiseMin(2 * alone + 1);
  all.rightCols(rows).setConstant(alone);
  Pairs pairs(all);
  for (Eigen::Index row = 0; row < rows; ++row) pairs.add(row + 1);
  std::vector<Index> of_row(rows, -1);
  for (Eigen::Index c = 0; c < columns; ++c)
    if (const std::size_t row = pairs.row_at(c + 1); row > 0) of_row[row - 1] = c;
  return of_row;
}

}  // namespace softkin::calibration
