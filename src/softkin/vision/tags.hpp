#pragma once

#include <array>
#include <optional>
#include <softkin/calibration/board.hpp>
#include <softkin/calibration/plane_view.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A square tag (ArUco) in a picture.
struct Tag {
  int number = 0;
  std::array<Vec2, 4> corners;  // lens distortion taken out; top left of the tag, then clockwise [px]

  /// Where its diagonals cross: its centre from any side [px, without distortion].
  [[nodiscard]] Vec2 centre() const;
};

/// Names of the dictionaries of tags: 4x4_50 to 7x7_1000, original.
[[nodiscard]] const std::vector<std::string>& dictionaries();

/// Number of tags in a dictionary. Throws InvalidInput where there is no such dictionary.
[[nodiscard]] int dictionary_size(const std::string& dictionary);

/// The squares of a tag row by row from the top left, its dark border included: 1 dark.
/// throws  InvalidInput: no such dictionary, no such number
[[nodiscard]] std::vector<std::vector<int>> tag_squares(const std::string& dictionary, int number);

/// All tags of a dictionary in a picture, with corners to some hundredths of a pixel, by number; a number may come
/// twice.
[[nodiscard]] std::vector<Tag> find_tags(const RgbImage& picture, const std::string& dictionary,
                                         const std::optional<Camera>& camera);

/// The corners of a board that a picture shows.
/// camera  whose distortion is taken out
/// throws  InvalidInput: not there, too little of it, a tag twice
[[nodiscard]] std::vector<PlanePoint> find_board(const RgbImage& picture, const BoardSpec& board,
                                                 const std::optional<Camera>& camera);

/// The dark squares of a board [mm], each lower left corner, then width and height; for printing.
/// throws  InvalidInput: no such dictionary, or too few tags in it
[[nodiscard]] std::vector<std::array<double, 4>> board_squares(const BoardSpec& board);

}  // namespace softkin
