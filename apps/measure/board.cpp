#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/vision/tags.hpp>

#include "cli/command.hpp"
#include "cli/terminal.hpp"
#include "commands.hpp"
#include "report_text.hpp"

namespace softkin::cli {

namespace {

/// White around the board, without which its outer tags are not found [mm].
double margin_of(const BoardSpec& board) {
  return board.kind == BoardSpec::Kind::grid ? board.tag / 4 : board.square / 2;
}

std::string svg_of(const BoardSpec& board) {
  const double margin = margin_of(board), width = board.width() + 2 * margin, height = board.height() + 2 * margin;
  const auto mm = [](double value) { return number(value, 9); };
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + mm(width) + "mm\" height=\"" + mm(height) +
                     "mm\" viewBox=\"0 0 " + mm(width) + " " + mm(height) +
                     "\" shape-rendering=\"crispEdges\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (const auto& [x, y, w, h] : board_squares(board))
    text += "<rect x=\"" + mm(margin + x) + "\" y=\"" + mm(margin + board.height() - y - h) + "\" width=\"" + mm(w) +
            "\" height=\"" + mm(h) + "\"/>\n";
  return text + "</svg>\n";
}

RgbImage picture_of(const BoardSpec& board, double pixels) {
  const double margin = margin_of(board);
  const double columns = std::ceil((board.width() + 2 * margin) * pixels);
  const double rows = std::ceil((board.height() + 2 * margin) * pixels);
  if (!(columns * rows <= 1e8 && columns >= 16 && rows >= 16))
    throw InvalidInput("--dpi: the picture would have " + number(columns) + " x " + number(rows) + " pixels");
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

}  // namespace

int measure_board(const BoardOptions& options) {
  const BoardSpec board = parse_board(options.board);
  const std::vector<Output> outputs{{"-o", options.output}};
  check_outputs(outputs, {});
  const bool svg = lower_extension(options.output) == ".svg";
  const std::string content = svg ? svg_of(board) : encode_png(picture_of(board, options.dpi / 25.4));
  const OutputFolders folders(outputs);
  write_file(options.output, content);
  print("wrote " + options.output + ": " + decimal(board.width(), 1) + " x " + decimal(board.height(), 1) +
        " mm without its margin" + (svg ? "" : " at " + number(options.dpi) + " dots per inch") +
        "; print it at 100 % and measure the print\n");
  return done;
}

}  // namespace softkin::cli
