#pragma once

#include <array>
#include <softkin/model/mesh/mesh.hpp>

namespace softkin::random_robots {

/// A sum of products of doubles without any rounding: a fixed-point number wide enough for all of them.
class ExactSum {
 public:
  /// Adds factor times a product of three finite doubles. |factor| <= 8
  void add(int factor, double a, double b, double c);
  /// -1, 0 or 1
  [[nodiscard]] int sign();

 private:
  // three mantissas of 53 bits times 2^-1126 to 2^971 each
  static constexpr int word_bits = 32, lowest = -3392, words = 216;
  std::array<std::int64_t, words> words_{};
};

/// Sign of the volume of an element, exactly: of a prism with bilinear sides.
[[nodiscard]] int exact_orientation(const Points& positions, const Tetrahedron& element);
[[nodiscard]] int exact_orientation(const Points& positions, const Prism& element);

}  // namespace softkin::random_robots
