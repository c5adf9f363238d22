#pragma once

#include <softkin/kinematics/maps/fit.hpp>
#include <softkin/kinematics/maps/piece_solver.hpp>
#include <utility>

namespace softkin::maps {

/// What a fit is to reach.
struct Wanted {
  Eigen::VectorXd accuracy;   // per output, in its unit; 0: any will do
  std::vector<Index> probes;  // vertices that stand for the shape
  double shape_mm = 0;        // of them; 0: any will do
  Index most = 0;             // equilibria of a piece, >= 1
};

/// Refines a piece of a map until it predicts new equilibria as well as is wanted: adds points at which its polynomials
/// are known worst; halves boxes in which that does not help, or parts of which have no equilibrium.
class PieceFit {
 public:
  /// All must outlive the object; data: inputs and outputs
  PieceFit(const MapData& data, const Wanted& wanted, MapPiece& piece);

  /// Commands of the equilibria to be solved next, a row each; none: there is nothing left to do.
  [[nodiscard]] RowMatrix next();

  /// What was found at them, in their order.
  void take(std::vector<Sample> samples);

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] std::vector<Sample> take_samples() { return std::move(samples_); }
  /// The nearest good one to commands, over the ranges; null: there is none.
  [[nodiscard]] const Sample* nearest(const Eigen::VectorXd& commands) const;
  /// Largest error of a prediction over what is wanted, of the last points anywhere.
  [[nodiscard]] double error() const { return error_; }
  /// Were all equilibria used up before it was accurate?
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
    double width = 1;              // share of the piece's box
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
