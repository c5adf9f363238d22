#pragma once

#include <array>
#include <optional>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/vision/camera.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

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

/// Corners of a dark square on light ground, to a few hundredths of a pixel: lines through the places where the picture
/// is half way between dark and light, which blur does not move, and where these lines cross.
///
/// corners  as found roughly, in order around the square [px]
/// module   width of the dark border by that of the square [-]
/// camera   its distortion is taken out, so that edges are straight
/// returns  the corners as a camera without distortion would see them [px]; none where an edge is not to be seen
[[nodiscard]] std::optional<std::array<Vec2, 4>> refine_quad(const RgbImage& picture,
                                                             const std::array<Vec2, 4>& corners, double module,
                                                             const std::optional<Camera>& camera);

}  // namespace softkin::vision
