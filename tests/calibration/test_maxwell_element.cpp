#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <softkin/calibration/maxwell_element.hpp>

#include "calibration/branch_equations.hpp"

namespace softkin {
namespace {

using calibration::History;
using calibration::MaxwellElement;

// VHB 4910 as published: relaxed shear modulus 15.36 kPa, limit stretch 5.85
const calibration::IncompressibleLaw vhb_law{Law::gent, 0.01536 / 2, 0, 0, 0, 3 * (5.85 * 5.85 - 1)};
const std::vector<ViscousBranch> vhb_branches{{0.02606, 0.61}, {0.02653, 6.56}, {0.01083, 61.25}};

testing::BranchEquations vhb_equations() {
  return {[](double l) {
            const double jm = 3 * (5.85 * 5.85 - 1);
            return 0.01536 * (l - 1 / (l * l)) / (1 - (l * l + 2 / l - 3) / jm);
          },
          vhb_branches};
}

/// Loads to a stretch and back at a constant rate [1/s], in two cycles of `rows` equal time steps each.
History cycles(double most, double rate, int rows) {
  History history{Eigen::VectorXd(2 * rows + 1), Eigen::VectorXd(2 * rows + 1)};
  for (int i = 0; i <= 2 * rows; ++i) {
    const double phase = 2.0 * (i % rows) / rows;
    history.time_s[i] = 2 * (most - 1) / rate * i / rows;
    history.value[i] = 1 + (most - 1) * (phase <= 1 ? phase : 2 - phase);
  }
  return history;
}

TEST(MaxwellElement, CyclesAgreeWithTheBranchEquations) {
  for (const double rate : {0.01, 0.05, 1.0}) {
    const History history = cycles(4, rate, 24);
    const Eigen::VectorXd found = calibration::stress_under({vhb_law, vhb_branches}, history);
    testing::BranchEquations equations = vhb_equations();
    for (Index i = 0; i < found.size(); ++i) {
      if (i > 0) {
        const double dt = history.time_s[i] - history.time_s[i - 1];
        equations.stretch(dt, history.value[i - 1], history.value[i], 20 + static_cast<int>(dt / 0.02));
      }
      EXPECT_NEAR(found[i], equations.stress(history.value[i]), 1e-7) << rate << " " << i;
    }
  }
}

TEST(MaxwellElement, HeldSmallStrainRelaxesByExponentials) {
  constexpr double strain = 1e-6;
  const MaxwellElement element{{Law::neo_hookean, 0.05, 0, 0, 0}, vhb_branches};
  History history{Eigen::VectorXd(5), Eigen::VectorXd::Constant(5, 1 + strain)};
  history.time_s << 0, 0.3, 2, 30, 3000;
  const Eigen::VectorXd found = calibration::stress_under(element, history);
  for (Index i = 0; i < 5; ++i) {
    double modulus = 0.1;
    for (const ViscousBranch& b : vhb_branches) modulus += b.modulus_MPa * std::exp(-history.time_s[i] / b.time_s);
    EXPECT_NEAR(found[i] / strain, 3 * modulus, 1e-5 * modulus);
  }
}

TEST(MaxwellElement, SmallStrainThatGrowsEvenlyIsExactInOneLongStep) {
  // stress of a branch under a constant rate r: 3 G r tau (1 - exp(-t / tau)), however long the step
  constexpr double rate = 1e-8, time_s = 0.5;
  for (const double t : {1e-4, 0.3, 40.0, 2000.0}) {
    History history{Eigen::Vector2d(0, t), Eigen::Vector2d(1, 1 + rate * t)};
    const double expected = 3 * rate * time_s * -std::expm1(-t / time_s);
    EXPECT_NEAR(calibration::unit_branch(history, time_s).stress[1], expected, 1e-4 * expected + 1e-14) << t;
  }
}

TEST(MaxwellElement, SlopeByTheRelaxationTimeIsThatOfDifferences) {
  const History history = cycles(3, 0.2, 20);
  for (const double time_s : {0.02, 0.61, 6.56, 500.0}) {
    constexpr double step = 1e-4;
    const auto slope = calibration::unit_branch(history, time_s).by_log_time;
    const Eigen::VectorXd up = calibration::unit_branch(history, time_s * std::exp(step), 1e-11).stress;
    const Eigen::VectorXd down = calibration::unit_branch(history, time_s * std::exp(-step), 1e-11).stress;
    EXPECT_LT((slope - (up - down) / (2 * step)).cwiseAbs().maxCoeff(), 1e-6 + 1e-5 * slope.cwiseAbs().maxCoeff());
  }
}

TEST(MaxwellElement, CreepAgreesWithTheBranchEquations) {
  // a load at once, held, taken off evenly
  History history{Eigen::VectorXd(6), Eigen::VectorXd(6)};
  history.time_s << 0, 0.5, 5, 40, 45, 60;
  history.value << 0.05, 0.05, 0.05, 0.05, 0, 0;
  const auto found = calibration::stretch_under({vhb_law, vhb_branches}, history);
  ASSERT_TRUE(found);
  testing::BranchEquations equations = vhb_equations();
  EXPECT_NEAR(found->stretch[0], equations.bearing(0.05, 5.8), 1e-9);
  for (Index i = 1; i < 6; ++i) {
    const double dt = history.time_s[i] - history.time_s[i - 1];
    const double l = equations.creep(dt, history.value[i - 1], history.value[i], static_cast<int>(400 * dt), 5.8);
    EXPECT_NEAR(found->stretch[i], l, 3e-5) << i;
  }
}

TEST(MaxwellElement, CreepUndoesRelaxation) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> step(-0.3, 0.4), wait(0.01, 20);
  History stretches{Eigen::VectorXd(30), Eigen::VectorXd(30)};
  double l = 1, t = 0;
  for (Index i = 0; i < 30; ++i) {
    stretches.time_s[i] = t += wait(engine);
    stretches.value[i] = l = std::clamp(l + step(engine), 0.8, 4.0);
  }
  // stresses between the rows are not even there: finer rows
  History fine{Eigen::VectorXd(29 * 200 + 1), Eigen::VectorXd(29 * 200 + 1)};
  for (Index i = 0; i < fine.time_s.size(); ++i) {
    const Index at = std::min<Index>(i / 200, 28);
    const double fraction = static_cast<double>(i - 200 * at) / 200;
    fine.time_s[i] = stretches.time_s[at] + fraction * (stretches.time_s[at + 1] - stretches.time_s[at]);
    fine.value[i] = stretches.value[at] + fraction * (stretches.value[at + 1] - stretches.value[at]);
  }
  const MaxwellElement element{{Law::yeoh, 0.02, 0, -0.0005, 0.0001}, vhb_branches};
  const auto back = calibration::stretch_under(element, {fine.time_s, calibration::stress_under(element, fine)});
  ASSERT_TRUE(back);
  EXPECT_LT((back->stretch - fine.value).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(MaxwellElement, SlopesOfCreepAreThoseOfDifferences) {
  History history{Eigen::VectorXd(6), Eigen::VectorXd(6)};
  history.time_s << 0, 0.5, 5, 40, 45, 60;
  history.value << 0.03, 0.05, 0.05, 0.05, 0.01, 0.01;
  const auto at = [&](const Eigen::VectorXd& x) {
    return MaxwellElement{{Law::mooney_rivlin, x[0], x[1], 0, 0}, {{x[2], std::exp(x[3])}, {x[4], std::exp(x[5])}}};
  };
  const calibration::LawSlopes of_law = [](double l) -> Eigen::VectorXd {
    return 2 * (l - 1 / (l * l)) * Eigen::Vector2d(1, 1 / l);
  };
  Eigen::VectorXd x(6);
  x << 0.01, 0.005, 0.03, std::log(0.7), 0.02, std::log(20.0);
  const auto found = calibration::stretch_under(at(x), history, of_law);
  ASSERT_TRUE(found);
  for (Index u = 0; u < 6; ++u) {
    Eigen::VectorXd up = x, down = x;
    const double step = u == 3 || u == 5 ? 1e-4 : 1e-6;
    up[u] += step;
    down[u] -= step;
    const Eigen::VectorXd slope = (calibration::stretch_under(at(up), history, {}, 1e-12)->stretch -
                                   calibration::stretch_under(at(down), history, {}, 1e-12)->stretch) /
                                  (2 * step);
    EXPECT_LT((found->slopes.col(u) - slope).cwiseAbs().maxCoeff(), 2e-5 * (1 + slope.cwiseAbs().maxCoeff())) << u;
  }
}

TEST(MaxwellElement, AStressThatNoStretchBearsIsSaid) {
  // its stress has a maximum of 0.46 MPa at a strain of 0.4
  const MaxwellElement falling{{Law::yeoh, 0.5, 0, -0.4, 0}, {}};
  EXPECT_FALSE(calibration::stretch_under(falling, {Eigen::Vector2d(0, 1), Eigen::Vector2d(0.1, 2)}));
}

}  // namespace
}  // namespace softkin
