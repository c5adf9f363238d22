#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/io/table/coupled_curves_file.hpp>
#include <sstream>

namespace softkin {
namespace {

using Pair = std::array<double, 2>;

/// Two chambers commanded by volume, and a cable.
Model two_coupled_chambers() {
  Model model;
  for (const char* name : {"left", "cable", "right"}) {
    Actuator actuator;
    actuator.name = name;
    if (std::string(name) != "cable") actuator.drive = ChamberDrive{};
    model.actuators.push_back(actuator);
  }
  return model;
}

class CoupledCurvesFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  CoupledCurves read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_coupled_curves(two_coupled_chambers(), path_);
  }
  /// Of the pressures on two axes, rows in any order.
  template <class Law>
  CoupledCurves measure(const std::vector<double>& left, const std::vector<double>& right, const Law& law) {
    std::vector<std::string> rows;
    for (const double p : left)
      for (const double q : right) {
        std::ostringstream row;
        row.precision(17);
        const Pair ratios = law(p, q);
        row << q << "," << ratios[0] << "," << ratios[1] << "," << p << "\n";
        rows.push_back(row.str());
      }
    std::shuffle(rows.begin(), rows.end(), std::mt19937(3));
    std::string text = "right_pressure_kPa,left,right,left_pressure_kPa\n";
    for (const std::string& row : rows) text += row;
    return read(text);
  }
  void refused(const std::string& text, const std::string& message) {
    try {
      (void)read(text);
      ADD_FAILURE() << "accepted; expected " << message;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string() + message), std::string::npos) << error.what();
    }
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("softkin_coupled_" + std::to_string(::getpid()) + ".csv");
};

/// Two linear equations, solved by Cramer's rule.
TEST_F(CoupledCurvesFile, LinearLawsAreInvertedExactly) {
  const CoupledCurves curves = measure({0, 40, 100}, {-10, 50, 80}, [](double p, double q) {
    return Pair{1 + 0.002 * p - 0.0004 * q, 1 - 0.0005 * p + 0.003 * q};
  });
  EXPECT_EQ(curves.chambers, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(curves.pressures_kPa[1], (std::vector<double>{-10, 50, 80}));
  const double determinant = 0.002 * 0.003 - 0.0004 * 0.0005;
  for (const Pair& p : {Pair{0, -10}, Pair{17, 3}, Pair{40, 50}, Pair{99, 79}, Pair{100, 80}}) {
    const Eigen::Vector2d ratios = curves.ratios_at(Eigen::Vector2d(p[0], p[1]));
    const double a = ratios[0] - 1, b = ratios[1] - 1;
    EXPECT_NEAR(a, 0.002 * p[0] - 0.0004 * p[1], 1e-12);
    const std::vector<Eigen::VectorXd> found = curves.pressures_for(ratios);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0][0], (a * 0.003 + b * 0.0004) / determinant, 1e-6);
    EXPECT_NEAR(found[0][1], (b * 0.002 + a * 0.0005) / determinant, 1e-6);
  }
  EXPECT_TRUE(curves.pressures_for(Eigen::Vector2d(1.3, 1)).empty());
  EXPECT_THROW((void)curves.ratios_at(Eigen::Vector2d(101, 0)), InvalidInput);
}

/// Against brute force: of all places of a fine grid, the one whose ratios are nearest.
TEST_F(CoupledCurvesFile, CurvedLawsAreInvertedAsBruteForceDoes) {
  const CoupledCurves curves = measure({0, 30, 60, 90}, {0, 45, 90}, [](double p, double q) {
    return Pair{1 + 0.002 * p + 2e-5 * p * p - 3e-6 * p * q, 1 + 0.003 * q + 1e-5 * q * q - 4e-6 * p * q};
  });
  for (const Pair& p : {Pair{12, 70}, Pair{50, 50}, Pair{88, 4}}) {
    const Eigen::Vector2d requested = curves.ratios_at(Eigen::Vector2d(p[0], p[1]));
    Eigen::Vector2d best(0, 0);
    double least = 1;
    for (int i = 0; i <= 360; ++i)
      for (int k = 0; k <= 360; ++k) {
        const Eigen::Vector2d here(0.25 * i, 0.25 * k);
        const double off = (curves.ratios_at(here) - requested).norm();
        if (off < least) {
          least = off;
          best = here;
        }
      }
    const std::vector<Eigen::VectorXd> found = curves.pressures_for(requested);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_LT((found[0] - best).cwiseAbs().maxCoeff(), 0.26);
    EXPECT_LT((found[0] - Eigen::Vector2d(p[0], p[1])).cwiseAbs().maxCoeff(), 1e-6);
  }
}

/// left = 1 + p + g(q) with g = 0, 0, 2, right = 1 + p + q: p = q = 1 apart from 0.5, 1.5 and 1.5, 0.5 for 2.5 and 3.
TEST_F(CoupledCurvesFile, TellsAllAnswers) {
  const CoupledCurves curves = measure({0, 1, 2}, {0, 1, 2}, [](double p, double q) {
    return Pair{1 + p + (q > 1 ? 2 * (q - 1) : 0), 1 + p + q};
  });
  const std::vector<Eigen::VectorXd> found = curves.pressures_for(Eigen::Vector2d(2.5, 3));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0][0], 0.5, 1e-9);
  EXPECT_NEAR(found[0][1], 1.5, 1e-9);
  EXPECT_NEAR(found[1][0], 1.5, 1e-9);
}

TEST_F(CoupledCurvesFile, RefusesByLine) {
  const std::string head = "left_pressure_kPa,right_pressure_kPa,left,right\n";
  refused("left_pressure_kPa,left\n0,1\n10,1.1\n", ":1: a table of coupled chambers has 2 to 6 of them, not 1");
  refused("left_pressure_kPa,left,right\n0,1,1\n", ":1: chamber 'right' needs both columns, 'right' (its ratio) and");
  refused("left_pressure_kPa,left,right_pressure_kPa,right,cable\n0,1,0,1,1\n", ":1: column 'cable' is of no chamber");
  refused(head + "0,0,1,1\n0,10,1,1.1\n", ":1: column 'left_pressure_kPa' needs two pressures at least");
  refused(head + "0,0,1,1\n0,10,1,1.1\n10,0,1.1,1\n",
          ":1: it needs a row for every combination of its pressures, 4, and has 3; there is none with "
          "left_pressure_kPa = 10, right_pressure_kPa = 10");
  refused(head + "0,0,1,1\n0,10,1,1.1\n10,0,1.1,1\n0,10,1,1.1\n", ":5: these pressures stand in line 3 already");
  refused(head + "0,0,1,1\n0,10,1,1.1\n10,0,1.1,1\n10,10,1,1.1\n",
          ":5: 'left' must rise with its own pressure, the others being equal, but is 1 after 1 in line 3");
  refused(head + "0,0,0,1\n0,10,1,1.1\n10,0,1.1,1\n10,10,1.1,1.1\n", ":2: 'left' must be greater than 0");
  refused(head + "0,0,1,1\n0,10,1,x\n", ":3: ");
  std::string scattered = head;
  for (int i = 0; i < 2000; ++i) scattered += std::to_string(i) + "," + std::to_string(i) + ",1,1\n";
  refused(scattered, ":1: its pressures are of no grid: a row for every combination would be 4e+06 rows");
}

}  // namespace
}  // namespace softkin
