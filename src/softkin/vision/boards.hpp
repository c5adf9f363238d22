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

/// Number of tags in a dictionary, 4x4_50 to 7x7_1000 or original. Throws InvalidInput where there is no such one.
[[nodiscard]] int dictionary_size(const std::string& dictionary);

/// All tags of a dictionary in a picture, with corners to some hundredths of a pixel, by number; a number may come
/// twice.
[[nodiscard]] std::vector<Tag> find_tags(const RgbImage& picture, const std::string& dictionary,
                                         const std::optional<Camera>& camera);

/// Corners of a dark square on light ground, to a few hundredths of a pixel: lines through the places where the
/// brightness is halfway between dark and light, which blur does not move, and where these lines cross.
///
/// corners  as found roughly, in order around the square [px]
/// module   width of the dark border by that of the square [-]
/// camera   its distortion is taken out, so that edges are straight
/// returns  the corners as a camera without distortion would see them [px]; none where an edge is not to be seen
[[nodiscard]] std::optional<std::array<Vec2, 4>> refine_quad(const RgbImage& picture,
                                                             const std::array<Vec2, 4>& corners, double module,
                                                             const std::optional<Camera>& camera);

/// A printed flat pattern of known size.
///
/// Rows and columns count from the top left as printed. Its frame [mm]: x to the right, y up, the origin at the lower
/// left corner of the lower left tag (grid) or square (charuco, checker).
struct BoardSpec {
  enum class Kind { grid, charuco, checker };
  Kind kind = Kind::grid;
  int columns = 0, rows = 0;          // grid: tags; charuco, checker: squares; charuco: rows odd
  double square = 0;                  // charuco, checker: side of a square [mm]
  double tag = 0, gap = 0;            // grid, charuco: side of a tag; grid: between tags [mm]
  std::string dictionary = "4x4_50";  // of the tags
  int first = 0;                      // grid: number of the tag at the top left; the others follow row by row

  /// Of so many tags or squares in a row [mm].
  [[nodiscard]] double length(int count) const {
    return kind == Kind::grid ? count * (tag + gap) - gap : count * square;
  }
  [[nodiscard]] double width() const { return length(columns); }
  [[nodiscard]] double height() const { return length(rows); }
  /// How many.
  [[nodiscard]] int tags() const {
    return kind == Kind::checker ? 0 : kind == Kind::grid ? columns * rows : columns * rows / 2;
  }
};

/// Reads "5x4,tag=12mm,gap=3mm", "charuco,7x5,square=10mm,tag=7mm" or "checker,9x6,square=10mm"; a length without a
/// unit is refused. Further keys: dictionary=5x5_100, first=10 (grid).
/// throws  InvalidInput naming the part that is wrong
[[nodiscard]] BoardSpec parse_board(const std::string& text);

/// A length such as "25mm" or "1in" [mm]. what: for messages.
/// throws  InvalidInput: no unit, no number, not > 0
[[nodiscard]] double parse_length(const std::string& text, const std::string& what);

/// The parts between the commas.
[[nodiscard]] std::vector<std::string> parts_of(const std::string& text);

/// A number of up to six digits.
[[nodiscard]] std::optional<int> whole_number(const std::string& text);

/// The corner of a grid's tag in the board's frame [mm]; number: from 0 at the top left; corner: 0 top left, then
/// clockwise.
[[nodiscard]] Vec2 grid_corner(const BoardSpec& board, int number, int corner);

/// The corners of a board that a picture shows.
/// camera  whose distortion is taken out
/// throws  InvalidInput: not there, too little of it, a tag twice
[[nodiscard]] std::vector<PlanePoint> find_board(const RgbImage& picture, const BoardSpec& board,
                                                 const std::optional<Camera>& camera);

/// The dark squares of a board [mm], each lower left corner, then width and height; for printing.
/// throws  InvalidInput: no such dictionary, or too few tags in it
[[nodiscard]] std::vector<std::array<double, 4>> board_squares(const BoardSpec& board);

}  // namespace softkin::vision
