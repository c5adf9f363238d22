#pragma once

#include <string>
#include <vector>

namespace softkin {

/// A point of a picture, in pixels to the right and down.
struct SvgPoint {
  double x = 0, y = 0;
};

enum class SvgAnchor { start, middle, end };

struct SvgText {
  SvgPoint at;  // on the baseline
  std::string text;
  double size = 12;  // of the font [pixel]
  SvgAnchor anchor = SvgAnchor::start;
  bool bold = false, upwards = false;  // upwards: read from below
};

struct SvgStroke {
  std::string color = "#000000";
  double width = 1;
  std::string dashes;  // "6 3"; empty: none
  std::string fill = "none";
};

/// Shapes of marks, each with as much ink as the others.
inline constexpr int svg_mark_shapes = 7;

/// The elements of an SVG picture as text.
class SvgCanvas {
 public:
  SvgCanvas(double width, double height, const std::string& title);

  void open(const std::string& name, const std::string& attributes = "");  // <g class="name" attributes>
  void close();
  void text(const SvgText& text);
  void line(SvgPoint from, SvgPoint to, const SvgStroke& stroke);
  void rectangle(SvgPoint low, SvgPoint high, const SvgStroke& stroke, const std::string& name);
  void polyline(const std::vector<SvgPoint>& points, const SvgStroke& stroke);
  /// From every first of two points to the second.
  void segments(const std::vector<SvgPoint>& points, const SvgStroke& stroke);
  /// shape: from 0 to svg_mark_shapes - 1.
  void marks(const std::vector<SvgPoint>& points, int shape, double radius, const SvgStroke& stroke);
  /// Later content under clip-path="url(#name)" is visible inside the rectangle alone.
  void clip(const std::string& name, SvgPoint low, SvgPoint high);

  /// The whole picture.
  [[nodiscard]] std::string finish() const { return text_ + "</svg>\n"; }

 private:
  void add_stroke(const SvgStroke& stroke);

  std::string text_;
};

/// text as XML: markup escaped; control characters and what is not UTF-8 are question marks.
[[nodiscard]] std::string svg_escaped(const std::string& text);

/// About the width of text in a sans-serif font, rather too much [pixel].
[[nodiscard]] double svg_text_width(const std::string& text, double size);

/// By how much bold text is wider.
inline constexpr double svg_bold = 1.15;

/// text, or as much of its beginning with "..." as fits into a width.
[[nodiscard]] std::string svg_fitted(const std::string& text, double size, double width);

/// The points of a line but those that are within a quarter of a pixel of the last one kept; first and last stay.
[[nodiscard]] std::vector<SvgPoint> thinned_line(const std::vector<SvgPoint>& points);

/// Points that are at least a distance [pixel] from the one kept before, the first among them.
[[nodiscard]] std::vector<SvgPoint> apart_along(const std::vector<SvgPoint>& points, double distance);

/// The first of the points in each square of half a pixel.
[[nodiscard]] std::vector<SvgPoint> apart_on_grid(const std::vector<SvgPoint>& points);

}  // namespace softkin
