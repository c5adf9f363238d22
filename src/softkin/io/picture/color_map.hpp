#pragma once

#include <softkin/io/picture/rgb_image.hpp>

namespace softkin {

/// A perceptually uniform colour map that colour-blind readers can read too: dark violet at 0 to yellow at 1.
///
/// share   in [0, 1]; clamped
/// source  viridis of N. Smith and S. van der Walt (matplotlib, 2015, CC0): nine of its colours, linear between them
[[nodiscard]] Rgb mapped_color(double share);

}  // namespace softkin
