#pragma once

#include <softkin/kinematics/maps/fit.hpp>
#include <softkin/kinematics/maps/piece_solver.hpp>
#include <utility>

namespace softkin::maps {

/// The accuracy that a fit is to reach, and its maximum number of equilibria.
struct Wanted {
  Eigen::VectorXd accuracy;   // per output, in its unit; 0: none is requested
  std::vector<Index> probes;  // vertices that stand for the shape
  double shape_mm = 0;        // of them; 0: none is requested
  Index most = 0;             // equilibria of a piece, >= 1
};

/// Refines a piece of a map until it predicts new equilibria with the requested accuracy: it adds points at which the
/// variance of its polynomials is largest, and halves boxes in which that does not help or which have parts without an
/// equilibrium.
class PieceFit {
 public:
  /// All must outlive the object; data: inputs and outputs
  PieceFit(const MapData& data, const Wanted& wanted, MapPiece& piece);

  /// Returns the commands of the equilibria to be solved next, a row each; none: the piece is finished.
  [[nodiscard]] RowMatrix next();

  /// Takes the samples at these commands, in their order.
  void take(std::vector<Sample> samples);

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] std::vector<Sample> take_samples() { return std::move(samples_); }
  /// Returns the good sample nearest to commands, scaled by the ranges; null: there is none.
  [[nodiscard]] const Sample* nearest(const Eigen::VectorXd& commands) const;
  /// Returns the largest error of a prediction over the requested accuracy, of the last points in all boxes.
  [[nodiscard]] double error() const { return error_; }
  /// Was the maximum number of equilibria reached before it was accurate?
  [[nodiscard]] bool gave_up() const { return gave_up_; }

  /// Amplitudes of the modes of the shape, for every cell; the samples keep their order.
  void fit_modes(const MapShape& shape);

 private:
  struct Chart {
    Eigen::VectorXd low, high;
    Index node = 0;
    std::vector<Index> samples{};
    Polynomials polynomials{};
    Eigen::VectorXd decay{};
    std::vector<double> errors{};  // of each batch when it was new
    double width = 1;              // fraction of the piece's box
  };

  [[nodiscard]] Eigen::VectorXd scaled(const Chart& chart, const Eigen::VectorXd& commands) const;
  [[nodiscard]] Observation observation(const Chart& chart, const Sample& sample) const;
  [[nodiscard]] Index batch_of(const Chart& chart) const;
  [[nodiscard]] Terms terms_of(const Chart& chart, Index samples) const;
  [[nodiscard]] double error_of(const Chart& chart, const Sample& sample) const;
  [[nodiscard]] bool stagnates(const Chart& chart) const;
  [[nodiscard]] Index side_of(const Chart& chart) const;
  void fit_chart(Chart& chart) const;
  void halve(Chart chart);
  void keep(Chart chart);

  const MapData& data_;
  const Wanted& wanted_;
  MapPiece& piece_;
  Index variables_;
  std::vector<Sample> samples_;
  Eigen::VectorXd low_, high_;      // of the ranges
  std::vector<Chart> open_, done_;  // of done_ the places are those of the piece's cells
  double error_;
  bool gave_up_ = false;
};

}  // namespace softkin::maps
