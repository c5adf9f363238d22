#pragma once

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <random>
#include <softkin/core/types.hpp>

namespace softkin::random_robots {

/// Random draws that are the same in every standard library: its engines are specified, its distributions are not. Two
/// for one call have names, as its arguments are evaluated in an order that each compiler chooses.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(0x9E3779B97F4A7C15u * (seed + 1)) {}

  [[nodiscard]] double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * unit(); }
  [[nodiscard]] double log_between(double low, double high) { return low * std::pow(high / low, unit()); }
  /// 0 <= result < count
  [[nodiscard]] int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(count)); }
  [[nodiscard]] int whole(int low, int high) { return low + below(high - low + 1); }
  [[nodiscard]] bool chance(double fraction) { return unit() < fraction; }
  template <class Value>
  [[nodiscard]] Value pick(std::initializer_list<Value> values) {
    return values.begin()[below(static_cast<int>(values.size()))];
  }
  /// Uniform in [-1, 1]^3.
  [[nodiscard]] Vec3 offset() {
    const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
    return {x, y, z};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace softkin::random_robots
