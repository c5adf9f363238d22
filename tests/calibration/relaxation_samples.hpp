#pragma once

#include <cmath>
#include <random>
#include <string>

#include "calibration/branch_equations.hpp"
#include "softkin/model/measurements.hpp"

namespace softkin::testing {

// VHB 4910 as published: relaxed shear modulus 15.36 kPa, limit stretch 5.85
constexpr double vhb_modulus = 0.01536, vhb_limit = 3 * (5.85 * 5.85 - 1);
inline const std::vector<ViscousBranch> vhb_branches{{0.02606, 0.61}, {0.02653, 6.56}, {0.01083, 61.25}};

inline double gent_stress(double l) {
  return vhb_modulus * (l - 1 / (l * l)) / (1 - (l * l + 2 / l - 3) / vhb_limit);
}

/// A neo-hookean material of shear modulus 0.1 MPa.
inline double rubber_stress(double l) {
  return 0.1 * (l - 1 / (l * l));
}

/// What is imposed on a strip: stretches, or stresses [MPa] where load_imposed.
struct Imposed {
  std::vector<double> time_s, value;
  bool load_imposed = false;
};

/// Loads and unloads at a constant rate of stretch [1/s], in a number of cycles.
inline Imposed cycled(double most, double rate, int cycles, int rows) {
  Imposed imposed;
  for (int i = 0; i <= cycles * rows; ++i) {
    const double phase = 2.0 * (i % rows) / rows;
    imposed.time_s.push_back(2 * (most - 1) / rate * i / rows);
    imposed.value.push_back(1 + (most - 1) * (phase <= 1 ? phase : 2 - phase));
  }
  return imposed;
}

/// A value at once and held, rows at even places of log(time) from first to last [s].
inline Imposed held_at(double value, double first, double last, int rows, bool load_imposed = false) {
  Imposed imposed{{0}, {value}, load_imposed};
  for (int i = 0; i < rows; ++i) {
    imposed.time_s.push_back(first * std::pow(last / first, static_cast<double>(i) / (rows - 1)));
    imposed.value.push_back(value);
  }
  return imposed;
}

/// Returns the test as predicted by the branch equations, with noise relative to the largest response.
inline RelaxationRun made_run(const Imposed& imposed, const std::function<double(double)>& law,
                              const std::vector<ViscousBranch>& branches, double noise, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  RelaxationRun run{"made.csv", "run " + std::to_string(seed), imposed.load_imposed, imposed.time_s, {}, {}, {}};
  BranchEquations equations(law, branches);
  double shortest = 1e9, most = 0;
  for (const ViscousBranch& branch : branches) shortest = std::min(shortest, branch.time_s);
  std::vector<double> answer;
  for (std::size_t i = 0; i < imposed.value.size(); ++i) {
    const double now = imposed.value[i], before = imposed.value[i - (i > 0 ? 1 : 0)];
    const double dt = i > 0 ? imposed.time_s[i] - imposed.time_s[i - 1] : 0;
    const int steps = 4 + static_cast<int>(20 * dt / shortest);
    if (imposed.load_imposed) {
      answer.push_back(i == 0 ? equations.bearing(now, 5.8) : equations.creep(dt, before, now, steps, 5.8));
    } else {
      equations.stretch(dt, before, now, steps);
      answer.push_back(equations.stress(now));
    }
    most = std::max(most, std::abs(answer.back() - (imposed.load_imposed ? 1 : 0)));
  }
  for (double& value : answer) value += noise * most * normal(engine);
  run.stretch = imposed.load_imposed ? answer : imposed.value;
  run.stress_MPa = imposed.load_imposed ? imposed.value : answer;
  return run;
}

}  // namespace softkin::testing
