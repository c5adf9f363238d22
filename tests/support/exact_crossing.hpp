#pragma once

#include <array>
#include <cstddef>
#include <softkin/core/types.hpp>
#include <vector>

namespace softkin::testing {

/// Two triangles by their places in the list, a < b.
struct Crossing {
  std::size_t a = 0, b = 0;
};

/// Pairs of triangles that meet where they should not, without any rounding: decided for the doubles as they are.
/// Fractions no code with what it is to judge.
///
/// no common vertex   a point in both, be it that they only touch
/// one                a point in both other than that vertex
/// two                an overlap: they lie in one plane, on the same side of their edge
/// three              always
/// without area       is the segment or point that its corners span; no pair that has two vertices in common
///
/// positions  #V by 3
/// group      empty, or of each triangle: pairs within a group >= 0 are not looked at
/// returns    by ascending a, then b
/// throws     std::invalid_argument where a vertex of a triangle is not there or not finite, or groups do not fit
[[nodiscard]] std::vector<Crossing> crossings(const Points& positions,
                                              const std::vector<std::array<Index, 3>>& triangles,
                                              const std::vector<int>& group = {});

}  // namespace softkin::testing
