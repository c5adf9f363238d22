#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/coupled_curves.hpp>

namespace softkin {

namespace {

constexpr double inside_cell = 1e-9;  // of its sides
constexpr double same_answer = 1e-6;  // of the grid: neighbouring cells have common faces
constexpr int max_iterations = 50;

/// The ratios within a cell of the grid, linear along each side.
class GridCell {
 public:
  GridCell(const CoupledCurves& curves, std::vector<std::size_t> low) : curves_(curves), low_(std::move(low)) {
    const std::size_t corners = std::size_t{1} << low_.size();
    for (std::size_t c = 0; c < corners; ++c) {
      std::vector<std::size_t> places = low_;
      for (std::size_t k = 0; k < places.size(); ++k) places[k] += c >> k & 1;
      corners_.push_back(&curves.ratios[curves.node(places)]);
    }
  }

  /// Can the cell contain these ratios? Not where all its corners are below or above one of them.
  [[nodiscard]] bool may_hold(const Eigen::VectorXd& requested) const {
    Eigen::VectorXd least = *corners_.front(), most = least;
    for (const Eigen::VectorXd* corner : corners_) {
      least = least.cwiseMin(*corner);
      most = most.cwiseMax(*corner);
    }
    const double slack = inside_cell * requested.cwiseAbs().maxCoeff();
    return ((requested - least).array() >= -slack).all() && ((most - requested).array() >= -slack).all();
  }

  /// t: fractions of the sides; slopes: by these, a column each; nullptr: not requested.
  [[nodiscard]] Eigen::VectorXd value(const Eigen::VectorXd& t, Eigen::MatrixXd* slopes) const {
    const Index n = t.size();
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
    if (slopes != nullptr) slopes->setZero(n, n);
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      double weight = 1;
      for (Index k = 0; k < n; ++k) weight *= fraction(c, k, t);
      sum += weight * *corners_[c];
      for (Index k = 0; slopes != nullptr && k < n; ++k) {
        double others = (c >> k & 1) != 0 ? 1 : -1;
        for (Index j = 0; j < n; ++j)
          if (j != k) others *= fraction(c, j, t);
        slopes->col(k) += others * *corners_[c];
      }
    }
    return sum;
  }

  /// By Newton's method from the middle.
  [[nodiscard]] std::optional<Eigen::VectorXd> solve(const Eigen::VectorXd& requested) const {
    const Index n = requested.size();
    Eigen::VectorXd t = Eigen::VectorXd::Constant(n, 0.5);
    Eigen::MatrixXd slopes;
    for (int i = 0; i < max_iterations; ++i) {
      const Eigen::VectorXd missing = requested - value(t, &slopes);
      const Eigen::VectorXd step = slopes.fullPivLu().solve(missing);
      if (!step.allFinite()) return std::nullopt;
      t += step;
      if (step.cwiseAbs().maxCoeff() > inside_cell) continue;
      const bool inside = t.minCoeff() >= -inside_cell && t.maxCoeff() <= 1 + inside_cell;
      return inside ? std::optional(t) : std::nullopt;
    }
    return std::nullopt;
  }

  [[nodiscard]] Eigen::VectorXd pressures(const Eigen::VectorXd& t) const {
    Eigen::VectorXd result(t.size());
    for (std::size_t k = 0; k < low_.size(); ++k) {
      const double low = curves_.pressures_kPa[k][low_[k]], high = curves_.pressures_kPa[k][low_[k] + 1];
      const double t_k = t[k];
      // what is measured itself is found to the last digit
      result[k] = t_k < inside_cell ? low : t_k > 1 - inside_cell ? high : low + t_k * (high - low);
    }
    return result;
  }

 private:
  static double fraction(std::size_t corner, Index side, const Eigen::VectorXd& t) {
    return (corner >> side & 1) != 0 ? t[side] : 1 - t[side];
  }

  const CoupledCurves& curves_;
  std::vector<std::size_t> low_;
  std::vector<const Eigen::VectorXd*> corners_;
};

/// The next cell of the grid; false after the last.
bool next_cell(const CoupledCurves& curves, std::vector<std::size_t>& low) {
  for (std::size_t k = low.size(); k-- > 0;) {
    if (++low[k] + 1 < curves.pressures_kPa[k].size()) return true;
    low[k] = 0;
  }
  return false;
}

bool is_new(const CoupledCurves& curves, const std::vector<Eigen::VectorXd>& found, const Eigen::VectorXd& answer) {
  return std::none_of(found.begin(), found.end(), [&](const Eigen::VectorXd& other) {
    for (Index k = 0; k < answer.size(); ++k) {
      const std::vector<double>& axis = curves.pressures_kPa[k];
      if (std::abs(answer[k] - other[k]) > same_answer * (axis.back() - axis.front())) return false;
    }
    return true;
  });
}

}  // namespace

std::size_t CoupledCurves::node(const std::vector<std::size_t>& places) const {
  std::size_t index = 0;
  for (std::size_t k = 0; k < places.size(); ++k) index = index * pressures_kPa[k].size() + places[k];
  return index;
}

Eigen::VectorXd CoupledCurves::ratios_at(const Eigen::VectorXd& kPa) const {
  std::vector<std::size_t> low;
  Eigen::VectorXd t(kPa.size());
  for (std::size_t k = 0; k < pressures_kPa.size(); ++k) {
    const std::vector<double>& axis = pressures_kPa[k];
    const double p = kPa[k];
    if (!(p >= axis.front() && p <= axis.back()))
      throw InvalidInput({file}, "a pressure of " + number(p, 6) + " kPa is outside of what was measured, " +
                                     number(axis.front(), 6) + " to " + number(axis.back(), 6) + " kPa");
    const auto above = std::upper_bound(axis.begin(), axis.end() - 1, p) - axis.begin();
    low.push_back(static_cast<std::size_t>(std::max<std::ptrdiff_t>(above, 1)) - 1);
    t[k] = (p - axis[low[k]]) / (axis[low[k] + 1] - axis[low[k]]);
  }
  return GridCell(*this, low).value(t, nullptr);
}

std::vector<Eigen::VectorXd> CoupledCurves::pressures_for(const Eigen::VectorXd& requested) const {
  std::vector<Eigen::VectorXd> found;
  std::vector<std::size_t> low(pressures_kPa.size(), 0);
  do {
    const GridCell cell(*this, low);
    if (!cell.may_hold(requested)) continue;
    const std::optional<Eigen::VectorXd> t = cell.solve(requested);
    if (t && is_new(*this, found, cell.pressures(*t))) found.push_back(cell.pressures(*t));
  } while (next_cell(*this, low));
  return found;
}

}  // namespace softkin
