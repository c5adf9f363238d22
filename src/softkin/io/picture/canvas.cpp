#include <algorithm>
#include <cmath>
#include <cstring>
#include <softkin/io/picture/canvas.hpp>

namespace softkin {

namespace {

// ASCII 32..126, rows of five cells from the top; rows left out are empty.
constexpr const char* glyphs[95] = {
    "",
    "..#.. ..#.. ..#.. ..#.. ..#.. ..... ..#..",              // !
    ".#.#. .#.#. .#.#.",                                      // "
    ".#.#. .#.#. ##### .#.#. ##### .#.#. .#.#.",              // #
    "..#.. .#### #.#.. .###. ..#.# ####. ..#..",              // $
    "##... ##..# ...#. ..#.. .#... #..## ...##",              // %
    ".##.. #..#. #..#. .##.. #.#.# #..#. .##.#",              // &
    "..#.. ..#.. ..#..",                                      // '
    "...#. ..#.. .#... .#... .#... .#... .#... ..#.. ...#.",  // (
    ".#... ..#.. ...#. ...#. ...#. ...#. ...#. ..#.. .#...",  // )
    "..... ..#.. #.#.# .###. #.#.# ..#..",                    // *
    "..... ..#.. ..#.. ##### ..#.. ..#..",                    // +
    "..... ..... ..... ..... ..... .##.. .##.. ..#.. .#...",  // ,
    "..... ..... ..... .###.",                                // -
    "..... ..... ..... ..... ..... .##.. .##..",              // .
    "....# ....# ...#. ..#.. .#... #.... #....",              // /
    "..#.. .#.#. #...# #...# #...# .#.#. ..#..",              // 0
    "..#.. .##.. ..#.. ..#.. ..#.. ..#.. .###.",              // 1
    ".###. #...# ....# ...#. ..#.. .#... #####",              // 2
    ".###. #...# ....# ..##. ....# #...# .###.",              // 3
    "...#. ..##. .#.#. #..#. ##### ...#. ...#.",              // 4
    "##### #.... ####. ....# ....# #...# .###.",              // 5
    ".###. #.... #.... ####. #...# #...# .###.",              // 6
    "##### ....# ...#. ...#. ..#.. ..#.. ..#..",              // 7
    ".###. #...# #...# .###. #...# #...# .###.",              // 8
    ".###. #...# #...# .#### ....# ....# .###.",              // 9
    "..... ..... .##.. .##.. ..... .##.. .##..",              // :
    "..... ..... .##.. .##.. ..... .##.. .##.. ..#.. .#...",  // ;
    "..... ...#. ..#.. .#... ..#.. ...#.",                    // <
    "..... ..... ##### ..... #####",                          // =
    "..... .#... ..#.. ...#. ..#.. .#...",                    // >
    ".###. #...# ....# ...#. ..#.. ..... ..#..",              // ?
    ".###. #...# #.### #.#.# #.### #.... .###.",              // @
    "..#.. .#.#. #...# #...# ##### #...# #...#",              // A
    "####. #...# #...# ####. #...# #...# ####.",              // B
    ".###. #...# #.... #.... #.... #...# .###.",              // C
    "###.. #..#. #...# #...# #...# #..#. ###..",              // D
    "##### #.... #.... ####. #.... #.... #####",              // E
    "##### #.... #.... ####. #.... #.... #....",              // F
    ".###. #...# #.... #.### #...# #...# .###.",              // G
    "#...# #...# #...# ##### #...# #...# #...#",              // H
    ".###. ..#.. ..#.. ..#.. ..#.. ..#.. .###.",              // I
    "....# ....# ....# ....# ....# #...# .###.",              // J
    "#...# #..#. #.#.. ##... #.#.. #..#. #...#",              // K
    "#.... #.... #.... #.... #.... #.... #####",              // L
    "#...# ##.## #.#.# #.#.# #...# #...# #...#",              // M
    "#...# ##..# ##..# #.#.# #..## #..## #...#",              // N
    ".###. #...# #...# #...# #...# #...# .###.",              // O
    "####. #...# #...# ####. #.... #.... #....",              // P
    ".###. #...# #...# #...# #.#.# #..#. .##.#",              // Q
    "####. #...# #...# ####. #.#.. #..#. #...#",              // R
    ".#### #.... #.... .###. ....# ....# ####.",              // S
    "##### ..#.. ..#.. ..#.. ..#.. ..#.. ..#..",              // T
    "#...# #...# #...# #...# #...# #...# .###.",              // U
    "#...# #...# #...# #...# .#.#. .#.#. ..#..",              // V
    "#...# #...# #...# #.#.# #.#.# ##.## #...#",              // W
    "#...# #...# .#.#. ..#.. .#.#. #...# #...#",              // X
    "#...# #...# .#.#. ..#.. ..#.. ..#.. ..#..",              // Y
    "##### ....# ...#. ..#.. .#... #.... #####",              // Z
    ".###. .#... .#... .#... .#... .#... .#... .#... .###.",  // [
    "#.... #.... .#... ..#.. ...#. ....# ....#",              // backslash
    ".###. ...#. ...#. ...#. ...#. ...#. ...#. ...#. .###.",  // ]
    "..#.. .#.#. #...#",                                      // ^
    "..... ..... ..... ..... ..... ..... ..... #####",        // _
    ".#... ..#.. ...#.",                                      // `
    "..... ..... .###. ....# .#### #...# .####",              // a
    "#.... #.... ####. #...# #...# #...# ####.",              // b
    "..... ..... .#### #.... #.... #.... .####",              // c
    "....# ....# .#### #...# #...# #...# .####",              // d
    "..... ..... .###. #...# ##### #.... .####",              // e
    "..##. .#... ####. .#... .#... .#... .#...",              // f
    "..... ..... .#### #...# #...# #...# .#### ....# .###.",  // g
    "#.... #.... ####. #...# #...# #...# #...#",              // h
    "..#.. ..... .##.. ..#.. ..#.. ..#.. .###.",              // i
    "...#. ..... ..##. ...#. ...#. ...#. ...#. ...#. .##..",  // j
    "#.... #.... #..#. #.#.. ##... #.#.. #..#.",              // k
    ".##.. ..#.. ..#.. ..#.. ..#.. ..#.. .###.",              // l
    "..... ..... ####. #.#.# #.#.# #.#.# #.#.#",              // m
    "..... ..... ####. #...# #...# #...# #...#",              // n
    "..... ..... .###. #...# #...# #...# .###.",              // o
    "..... ..... ####. #...# #...# #...# ####. #.... #....",  // p
    "..... ..... .#### #...# #...# #...# .#### ....# ....#",  // q
    "..... ..... #.##. ##... #.... #.... #....",              // r
    "..... ..... .#### #.... .###. ....# ####.",              // s
    ".#... .#... ####. .#... .#... .#... ..##.",              // t
    "..... ..... #...# #...# #...# #...# .####",              // u
    "..... ..... #...# #...# .#.#. .#.#. ..#..",              // v
    "..... ..... #.#.# #.#.# #.#.# #.#.# .####",              // w
    "..... ..... #...# .#.#. ..#.. .#.#. #...#",              // x
    "..... ..... #...# #...# #...# #...# .#### ....# .###.",  // y
    "..... ..... ##### ...#. ..#.. .#... #####",              // z
    "..##. ..#.. ..#.. ..#.. .#... ..#.. ..#.. ..#.. ..##.",  // {
    "..#.. ..#.. ..#.. ..#.. ..#.. ..#.. ..#.. ..#.. ..#..",  // |
    ".##.. ..#.. ..#.. ..#.. ...#. ..#.. ..#.. ..#.. .##..",  // }
    "..... ..... ..... .##.# #.##.",                          // ~
};
constexpr const char* box = "##### #...# #...# #...# #...# #...# #####";

constexpr double stroke_cells = 1.05;  // width of the font's lines [cell]
constexpr double capital_rows = 7;

/// One char per code point, those outside ASCII as 127 (drawn as a box).
std::string displayable(const std::string& text) {
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xC0) == 0x80) continue;  // the later bytes of a code point
    result += byte >= 32 && byte <= 126 ? c : char{127};
  }
  return result;
}

double line_width(std::size_t characters, double cell) {
  return characters == 0 ? 0 : (double(characters) * glyph_advance - 1) * cell;
}

struct FontCell {
  int column, row;
};

/// Calls draw(a, b) for the strokes that join the inked cells of a character; a lone cell is a stroke of no length.
template <class Draw>
void for_each_stroke(char character, const Draw& draw) {
  const auto inked = [&](int column, int row) { return glyph_cell(character, column, row); };
  for (int row = 0; row < glyph_rows; ++row) {
    for (int column = 0; column < glyph_columns; ++column) {
      if (!inked(column, row)) continue;
      const FontCell cell{column, row};
      draw(cell, cell);
      const bool right = inked(column + 1, row), below = inked(column, row + 1), left = inked(column - 1, row);
      if (right) draw(cell, FontCell{column + 1, row});
      if (below) draw(cell, FontCell{column, row + 1});
      if (!right && !below && inked(column + 1, row + 1)) draw(cell, FontCell{column + 1, row + 1});
      if (!left && !below && inked(column - 1, row + 1)) draw(cell, FontCell{column - 1, row + 1});
    }
  }
}

double distance_to(const Canvas::Stroke& stroke, const Canvas::Place& p) {
  const Canvas::Place along = stroke.to - stroke.from;
  const double squared = along.squaredNorm();
  const double fraction = squared > 0 ? std::clamp((p - stroke.from).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (p - stroke.from - fraction * along).norm();
}

}  // namespace

bool glyph_cell(char character, int column, int row) {
  if (column < 0 || column >= glyph_columns || row < 0 || row >= glyph_rows) return false;
  const char* glyph = character >= 32 && character <= 126 ? glyphs[character - 32] : box;
  const std::size_t place = row * (glyph_columns + 1) + column;
  return place < std::strlen(glyph) && glyph[place] == '#';
}

double round_length(double limit) {
  const double power = std::pow(10, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= limit) return factor * power;
  return power;
}

void Canvas::cover(int x, int y, const Rgb& color, double fraction) {
  if (fraction <= 0 || x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
  std::uint8_t* pixel = image_.pixel(x, y);
  for (int k = 0; k < 3; ++k) pixel[k] = to_byte(pixel[k] / 255.0 * (1 - fraction) + color[k] * fraction);
}

void Canvas::fill(const Place& low, const Place& high, const Rgb& color) {
  const auto overlap = [](int pixel, double from, double to) {
    return std::max(0.0, std::min(to, pixel + 1.0) - std::max(from, double(pixel)));
  };
  for (int y = int(std::floor(low.y())); y < high.y(); ++y)
    for (int x = int(std::floor(low.x())); x < high.x(); ++x)
      cover(x, y, color, overlap(x, low.x(), high.x()) * overlap(y, low.y(), high.y()));
}

void Canvas::strokes(const std::vector<Stroke>& strokes, double width, const Rgb& color) {
  if (strokes.empty()) return;
  Place low = strokes[0].from, high = low;
  for (const Stroke& s : strokes) {
    low = low.cwiseMin(s.from).cwiseMin(s.to);
    high = high.cwiseMax(s.from).cwiseMax(s.to);
  }
  const double reach = width / 2 + 1;
  for (int y = int(std::floor(low.y() - reach)); y < high.y() + reach; ++y) {
    for (int x = int(std::floor(low.x() - reach)); x < high.x() + reach; ++x) {
      double distance = width + 1;
      for (const Stroke& s : strokes) distance = std::min(distance, distance_to(s, Place(x + 0.5, y + 0.5)));
      cover(x, y, color, std::clamp(width / 2 + 0.5 - distance, 0.0, 1.0));
    }
  }
}

double Canvas::text_width(const std::string& text, double cell) {
  return line_width(displayable(text).size(), cell);
}

std::string Canvas::fitted(const std::string& text, double cell, double width) {
  std::string result = displayable(text);
  if (line_width(result.size(), cell) <= width) return result;
  while (!result.empty() && line_width(result.size() + 3, cell) > width) result.pop_back();
  return result + "...";
}

void Canvas::text(const Place& at, const std::string& text, double cell, const Rgb& color, Anchor anchor, bool upward,
                  double line) {
  const std::string characters = displayable(text);
  const double width = line_width(characters.size(), cell);
  const double start = anchor == Anchor::start ? 0 : anchor == Anchor::middle ? -width / 2 : -width;
  const Place across = upward ? Place(0, -1) : Place(1, 0), down = upward ? Place(1, 0) : Place(0, 1);
  for (std::size_t i = 0; i < characters.size(); ++i) {
    const auto place = [&](const FontCell& c) -> Place {
      return at + (start + (double(i) * glyph_advance + c.column + 0.5) * cell) * across +
             (c.row + 0.5 - capital_rows / 2) * cell * down;
    };
    std::vector<Stroke> glyph;
    for_each_stroke(characters[i], [&](const FontCell& a, const FontCell& b) {
      glyph.push_back({place(a), place(b)});
    });
    strokes(glyph, line * stroke_cells * cell, color);
  }
}

}  // namespace softkin
