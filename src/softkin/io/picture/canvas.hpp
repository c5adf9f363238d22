#pragma once

#include <Eigen/Core>
#include <softkin/io/picture/rgb_image.hpp>
#include <string>

namespace softkin {

constexpr int glyph_columns = 5, glyph_rows = 9;  // capitals take the upper 7 rows, two are for descenders
constexpr int glyph_advance = 6;                  // columns from one character to the next

/// Whether a cell of the character is inked; a character outside ASCII 32..126 is an empty box.
[[nodiscard]] bool glyph_cell(char character, int column, int row);

/// 1, 2 or 5 times a power of ten: the largest that does not exceed `limit` > 0.
[[nodiscard]] double round_length(double limit);

/// Lines, areas and text with smooth borders over an image; places in pixels from the top left, y down.
class Canvas {
 public:
  using Place = Eigen::Vector2d;
  struct Stroke {
    Place from, to;
  };
  enum class Anchor { start, middle, end };  // the part of the text that stands at the place

  explicit Canvas(RgbImage& image) : image_(image) {}

  void fill(const Place& low, const Place& high, const Rgb& color);
  /// Lines with round ends, as one area.
  void strokes(const std::vector<Stroke>& strokes, double width, const Rgb& color);
  /// One line of text whose half capital height is at the place; cell: size of a cell of the font [pixel];
  /// upward: reads from bottom to top; line: width of its lines over that of the font. A character outside ASCII (one
  /// UTF-8 code point) is an empty box.
  void text(const Place& at, const std::string& text, double cell, const Rgb& color, Anchor anchor = Anchor::start,
            bool upward = false, double line = 1);

  [[nodiscard]] static double text_width(const std::string& text, double cell);
  /// The text, or its beginning and "..." where it is wider than `width`.
  [[nodiscard]] static std::string fitted(const std::string& text, double cell, double width);

 private:
  void cover(int x, int y, const Rgb& color, double fraction);

  RgbImage& image_;
};

}  // namespace softkin
