#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/pixels.hpp>
#include <softkin/vision/plane_view.hpp>
#include <softkin/vision/tags.hpp>

namespace softkin::vision {

namespace {

constexpr double least_share = 0.4;  // of a board's tags or corners: fewer fix its perspective badly

/// Corners of a tag: top left, then clockwise.
std::array<Vec2, 4> tag_places(const BoardSpec& board, int number) {
  if (board.kind == BoardSpec::Kind::grid)
    return {grid_corner(board, number, 0), grid_corner(board, number, 1), grid_corner(board, number, 2),
            grid_corner(board, number, 3)};
  const double side = board.tag, margin = (board.square - side) / 2;
  Vec2 low;
  for (int i = 0; number >= 0; ++i) {  // every other square, row by row from the top left
    const int x = i % board.columns, y = board.rows - 1 - i / board.columns;
    if ((x + y) % 2 != 0 && number-- == 0) low = Vec2(x * board.square + margin, y * board.square + margin);
  }
  return {low + Vec2(0, side), low + Vec2(side, side), low + Vec2(side, 0), low};
}

PlanePoint point_of(const cv::Point2f& corner, const Vec2& place, const std::optional<Camera>& camera) {
  const Vec2 seen(corner.x, corner.y);
  return {camera ? undistorted(*camera, seen) : seen, place};
}

[[noreturn]] void refuse(const BoardSpec& board, int found, int all, const char* what) {
  const std::string count = std::to_string(found) + " of its " + std::to_string(all) + " " + what;
  throw InvalidInput(found == 0 ? "the board is not found: none of its " + std::to_string(all) + " " + what +
                                      (board.kind == BoardSpec::Kind::checker ? "" : " (" + board.dictionary + ")")
                                : "too little of the board is seen: " + count);
}

void check_dictionary(const BoardSpec& board) {
  const int size = dictionary_size(board.dictionary);
  if (board.first + board.tags() > size)
    throw InvalidInput("the board has " + std::to_string(board.tags()) + " tags from number " +
                       std::to_string(board.first) + ", but dictionary " + board.dictionary + " has " +
                       std::to_string(size));
}

/// The board's tags in the picture, by their place on the board.
std::map<int, Tag> tags_on(const RgbImage& picture, const BoardSpec& board, const std::optional<Camera>& camera) {
  check_dictionary(board);
  std::map<int, Tag> found;
  for (const Tag& tag : find_tags(picture, board.dictionary, camera)) {
    const int place = tag.number - board.first;
    if (place < 0 || place >= board.tags()) continue;
    if (!found.emplace(place, tag).second)
      throw InvalidInput("tag " + std::to_string(tag.number) + " of the board is in the picture twice");
  }
  const int least = std::max(1, static_cast<int>(std::ceil(least_share * board.tags())));
  if (static_cast<int>(found.size()) < least) refuse(board, static_cast<int>(found.size()), board.tags(), "tags");
  return found;
}

void append(std::vector<PlanePoint>& points, const BoardSpec& board, int number, const Tag& tag) {
  const std::array<Vec2, 4> places = tag_places(board, number);
  for (std::size_t k = 0; k < 4; ++k) points.push_back({tag.corners[k], places[k]});
}

std::vector<PlanePoint> charuco_corners(const RgbImage& picture, const BoardSpec& board,
                                        const std::optional<Camera>& camera) {
  const std::map<int, Tag> tags = tags_on(picture, board, std::nullopt);
  std::vector<Vec2> places;
  std::vector<cv::Point2f> corners;
  double side = 1e9;  // of a square in the picture [px]
  for (int y = 1; y < board.rows; ++y)
    for (int x = 1; x < board.columns; ++x) {
      const Vec2 place(x * board.square, y * board.square);
      std::vector<PlanePoint> near;  // of the two tags whose squares meet here
      for (const auto& [number, tag] : tags) {
        const std::array<Vec2, 4> around = tag_places(board, number);
        if (((around[0] + around[2]) / 2 - place).norm() < 0.8 * board.square) append(near, board, number, tag);
      }
      if (near.size() < 8) continue;
      const PlaneView view({}, near);
      const Vec2 pixel = view.to_pixel(place);
      side = std::min(side, board.square / std::sqrt(view.pixel_area(pixel)));
      places.push_back(place);
      corners.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
  const int all = (board.rows - 1) * (board.columns - 1);
  if (static_cast<double>(corners.size()) < std::max(4.0, least_share * all))
    refuse(board, static_cast<int>(corners.size()), all, "corners");
  // the window holds the crossing alone, not the tags beside it
  const double margin = side * (board.square - board.tag) / (2 * board.square);
  const int reach = std::max(2, static_cast<int>(0.9 * margin));
  cv::cornerSubPix(gray_of(picture), corners, cv::Size(reach, reach), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-3));
  std::vector<PlanePoint> points;
  for (std::size_t i = 0; i < corners.size(); ++i) points.push_back(point_of(corners[i], places[i], camera));
  // the tags reach farther out than the crossings between squares
  for (const auto& [number, tag] : camera ? tags_on(picture, board, camera) : tags) append(points, board, number, tag);
  return points;
}

std::vector<PlanePoint> checker_corners(const RgbImage& picture, const BoardSpec& board,
                                        const std::optional<Camera>& camera) {
  const int columns = board.columns - 1, rows = board.rows - 1;
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(gray_of(picture), cv::Size(columns, rows), corners, cv::CALIB_CB_ACCURACY))
    throw InvalidInput("the board is not found: no " + std::to_string(columns) + " x " + std::to_string(rows) +
                       " inner corners of " + std::to_string(board.columns) + " x " + std::to_string(board.rows) +
                       " squares; all of it must be in the picture");
  std::vector<PlanePoint> points;
  for (int i = 0; i < rows * columns; ++i) {
    const Vec2 place((i % columns + 1) * board.square, board.height() - (i / columns + 1) * board.square);
    points.push_back(point_of(corners[std::size_t(i)], place, camera));
  }
  return points;
}

void append_tag(std::vector<std::array<double, 4>>& squares, const BoardSpec& board, int number) {
  const std::vector<std::vector<int>> dark = tag_squares(board.dictionary, board.first + number);
  const Vec2 top_left = tag_places(board, number)[0];
  const double side = board.tag / static_cast<double>(dark.size());
  for (std::size_t r = 0; r < dark.size(); ++r)
    for (std::size_t c = 0; c < dark.size(); ++c) {
      if (dark[r][c] == 0) continue;
      squares.push_back(
          {top_left.x() + static_cast<double>(c) * side, top_left.y() - static_cast<double>(r + 1) * side, side, side});
    }
}

}  // namespace

std::vector<PlanePoint> find_board(const RgbImage& picture, const BoardSpec& board,
                                   const std::optional<Camera>& camera) {
  if (board.kind == BoardSpec::Kind::charuco) return charuco_corners(picture, board, camera);
  if (board.kind == BoardSpec::Kind::checker) return checker_corners(picture, board, camera);
  std::vector<PlanePoint> points;
  for (const auto& [number, tag] : tags_on(picture, board, camera)) append(points, board, number, tag);
  return points;
}

std::vector<std::array<double, 4>> board_squares(const BoardSpec& board) {
  std::vector<std::array<double, 4>> squares;
  if (board.kind != BoardSpec::Kind::grid)
    for (int y = 0; y < board.rows; ++y)
      for (int x = 0; x < board.columns; ++x)
        if ((x + y) % 2 == 0) squares.push_back({x * board.square, y * board.square, board.square, board.square});
  if (board.kind == BoardSpec::Kind::checker) return squares;
  check_dictionary(board);
  for (int number = 0; number < board.tags(); ++number) append_tag(squares, board, number);
  return squares;
}

}  // namespace softkin::vision
