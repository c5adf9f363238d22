#pragma once

#include <softkin/statics/statics.hpp>
#include <string>
#include <vector>

namespace softkin::random_robots {

/// A robot and its commands, both functions of the seed.
struct RandomCase {
  std::uint64_t seed = 0;
  bool sensible = true;               // built to be solved; else some of its features are odd
  std::vector<std::string> features;  // what is odd about it, a word each
  RobotSpec spec;                     // lengths in mm
  std::vector<Actuation> commands;    // one after another, each from the shape before
  StaticsOptions options;
  bool forgets = false;     // the next solve starts from the positions of the last shape alone
  int interrupt_after = 0;  // calls of the progress callback; 0: never
};

/// Robots of some 6 to 300 elements from 0.1 mm to 10 m, of both formulations; seven of ten are sensible.
[[nodiscard]] RandomCase make_case(std::uint64_t seed);

}  // namespace softkin::random_robots
