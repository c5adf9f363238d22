#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/own_file.hpp>
#include <softkin/vision/board_print.hpp>

namespace softkin::vision {

namespace {

constexpr double mm_per_inch = 25.4;

/// White around the board, without which its outer tags are not found [mm].
double margin_of(const BoardSpec& board) {
  return board.kind == BoardSpec::Kind::grid ? board.tag / 4 : board.square / 2;
}

}  // namespace

std::string board_svg(const BoardSpec& board) {
  const double margin = margin_of(board), width = board.width() + 2 * margin, height = board.height() + 2 * margin;
  const auto mm = [](double value) { return number(value, 9); };
  std::string text = std::string(xml_mark) + "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + mm(width) +
                     "mm\" height=\"" + mm(height) + "mm\" viewBox=\"0 0 " + mm(width) + " " + mm(height) +
                     "\" shape-rendering=\"crispEdges\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const auto& [x, y, w, h] : board_squares(board))
    text += "<rect x=\"" + mm(margin + x) + "\" y=\"" + mm(margin + board.height() - y - h) + "\" width=\"" + mm(w) +
            "\" height=\"" + mm(h) + "\"/>\n";
  return text + "</svg>\n";
}

RgbImage board_picture(const BoardSpec& board, double dpi) {
  const double pixels = dpi / mm_per_inch;
  const double margin = margin_of(board);
  const double columns = std::ceil((board.width() + 2 * margin) * pixels);
  const double rows = std::ceil((board.height() + 2 * margin) * pixels);
  if (!(columns * rows <= 1e8 && columns >= 16 && rows >= 16))
    throw InvalidInput("dots per inch: the picture would have " + number(columns) + " x " + number(rows) + " pixels");
  RgbImage picture(static_cast<int>(columns), static_cast<int>(rows));
  // edges between pixels are shades, so that the picture is true to scale at any resolution
  std::vector<double> dark(static_cast<std::size_t>(columns * rows), 0);
  for (const auto& [x, y, w, h] : board_squares(board)) {
    const double left = (margin + x) * pixels, right = left + w * pixels;
    const double top = (margin + board.height() - y - h) * pixels, bottom = top + h * pixels;
    for (int row = static_cast<int>(top); row < std::min(bottom, rows); ++row)
      for (int column = static_cast<int>(left); column < std::min(right, columns); ++column)
        dark[std::size_t(row) * std::size_t(picture.width) + std::size_t(column)] +=
            (std::min(bottom, row + 1.0) - std::max(top, double(row))) *
            (std::min(right, column + 1.0) - std::max(left, double(column)));
  }
  for (std::size_t i = 0; i < dark.size(); ++i)
    std::fill_n(picture.bytes.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, to_byte(std::max(0.0, 1 - dark[i])));
  return picture;
}

}  // namespace softkin::vision
