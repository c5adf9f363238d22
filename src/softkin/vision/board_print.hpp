#pragma once

#include <softkin/vision/boards.hpp>
#include <string>

namespace softkin::vision {

/// A board with a white margin, without which its outer tags are not found, true to scale. Throws as board_squares().
[[nodiscard]] std::string board_svg(const BoardSpec& board);

/// The same as a picture of so many dots per inch. Throws InvalidInput where it would be smaller than 16 pixels or
/// larger than 1e8 in all
[[nodiscard]] RgbImage board_picture(const BoardSpec& board, double dpi);

}  // namespace softkin::vision
