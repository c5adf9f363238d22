#pragma once

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <softkin/model/robot_spec.hpp>
#include <vector>

namespace softkin::testing {

/// One incompressible element under tension, by the branch equations as tensors and the classical Runge-Kutta method in
/// many small steps: nothing of the code that it judges.
class BranchEquations {
 public:
  /// law  nominal stress [MPa] by the stretch [-]
  BranchEquations(std::function<double(double)> law, std::vector<ViscousBranch> branches)
      : law_(std::move(law)), branches_(std::move(branches)), viscous_(branches_.size(), Eigen::Matrix3d::Identity()) {}

  /// Nominal stress [MPa] at a stretch now.
  [[nodiscard]] double stress(double l) const {
    double sum = law_(l);
    const Eigen::Matrix3d f = Eigen::Vector3d(l, 1 / std::sqrt(l), 1 / std::sqrt(l)).asDiagonal();
    for (std::size_t b = 0; b < branches_.size(); ++b) {
      const Eigen::Matrix3d elastic = f * viscous_[b].inverse() * f.transpose();
      sum += branches_[b].modulus_MPa * (elastic(0, 0) - elastic(1, 1)) / l;
    }
    return sum;
  }

  /// On by dt, the stretch changing evenly.
  void stretch(double dt, double begin, double end, int steps) {
    const double h = dt / steps;
    for (int i = 0; i < steps; ++i) {
      const auto at = [&](double fraction) { return begin + (end - begin) * (i + fraction) / steps; };
      for (std::size_t b = 0; b < branches_.size(); ++b) {
        Eigen::Matrix3d& c = viscous_[b];
        const Eigen::Matrix3d k1 = rate(b, c, at(0)), k2 = rate(b, c + h / 2 * k1, at(0.5)),
                              k3 = rate(b, c + h / 2 * k2, at(0.5)), k4 = rate(b, c + h * k3, at(1));
        c += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      }
    }
  }

  /// Returns the current stretch under a stress [MPa], by bisection.
  [[nodiscard]] double bearing(double stress_MPa, double high) const {
    double low = 0.2;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (stress(middle) < stress_MPa ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  /// On by dt under a stress that changes evenly; returns the stretch at the end. Of second order: steps must be small.
  double creep(double dt, double begin, double end, int steps, double high) {
    double l = bearing(begin, high);
    for (int i = 0; i < steps; ++i) {
      const double stress_MPa = begin + (end - begin) * (i + 1) / steps;
      const std::vector<Eigen::Matrix3d> before = viscous_;
      stretch(dt / steps, l, l, 1);
      const double guess = bearing(stress_MPa, high);
      viscous_ = before;
      stretch(dt / steps, l, guess, 1);
      l = bearing(stress_MPa, high);
    }
    return l;
  }

 private:
  [[nodiscard]] Eigen::Matrix3d rate(std::size_t b, const Eigen::Matrix3d& viscous, double l) const {
    const Eigen::Matrix3d c = Eigen::Vector3d(l * l, 1 / l, 1 / l).asDiagonal();
    return (c - (c * viscous.inverse()).trace() / 3 * viscous) / branches_[b].time_s;
  }

  std::function<double(double)> law_;
  std::vector<ViscousBranch> branches_;
  std::vector<Eigen::Matrix3d> viscous_;  // C_v
};

}  // namespace softkin::testing
