#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/open_cv.hpp>
#include <softkin/vision/pixels.hpp>

namespace softkin::vision {

namespace {

constexpr double step = 0.5;               // along a profile [px]
constexpr double min_board_contrast = 25;  // of 255
constexpr double far_off = 0.5;            // of a line: on something else [px]
constexpr double end_fraction = 0.12;      // of an edge: left out at both ends, where blur rounds the corner

using Line = Eigen::Hyperplane<double, 2>;

int number_of_dictionary(const std::string& name) {
  static const std::vector<std::string> names{"4x4_50",  "4x4_100",  "4x4_250", "4x4_1000", "5x5_50",  "5x5_100",
                                              "5x5_250", "5x5_1000", "6x6_50",  "6x6_100",  "6x6_250", "6x6_1000",
                                              "7x7_50",  "7x7_100",  "7x7_250", "7x7_1000", "original"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw InvalidInput("no dictionary '" + name + "'" + suggest_name(name, names));
  return static_cast<int>(found - names.begin());  // in OpenCV's order
}

/// Distance from the middle of a profile at which it passes the level upwards, nearest to the middle.
std::optional<double> passage(const Eigen::ArrayXd& profile, double reach, double level) {
  std::optional<double> best;
  for (Eigen::Index i = 0; i + 1 < profile.size(); ++i) {
    if (!(profile[i] <= level && profile[i + 1] > level)) continue;
    const double s = -reach + step * (static_cast<double>(i) + (level - profile[i]) / (profile[i + 1] - profile[i]));
    if (!best || std::abs(s) < std::abs(*best)) best = s;
  }
  return best;
}

/// The line of least squares through points.
Line fitted_line(const std::vector<Vec2>& points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& point : points) mean += point / static_cast<double>(points.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Vec2& point : points) spread += (point - mean) * (point - mean).transpose();
  return Line(Vec2(symmetric_eigen(spread).vectors.col(0)), mean);
}

/// An edge, distortion taken out.
std::optional<Line> edge_line(const GrayImage& gray, const Vec2& from, const Vec2& to, const Vec2& middle,
                              double module, const std::optional<Camera>& camera) {
  const double length = (to - from).norm();
  Vec2 outwards = Vec2(to.y() - from.y(), from.x() - to.x()) / length;
  if (outwards.dot(middle - from) > 0) outwards = -outwards;
  const double depth = 2 * std::abs(outwards.dot(middle - from));  // of the square behind this edge
  const double reach = std::clamp(0.75 * module * depth, 1.5, 5.0);
  // profiles across the edge, from inside (dark) outwards
  const int rows = std::clamp(static_cast<int>(length), 10, 60),
            columns = static_cast<int>(2 * reach / step + 1e-9) + 1;
  Eigen::ArrayXXd profiles(columns, rows);
  const auto place = [&](int i) {
    return Vec2(from + (end_fraction + (1 - 2 * end_fraction) * (i + 0.5) / rows) * (to - from));
  };
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < columns; ++k) profiles(k, i) = between(gray, place(i) + (step * k - reach) * outwards);
  // darkest on the inner half and lightest on the outer half: ink and paper, also where the dark border and the margin
  // are hardly wider than the blur
  const Eigen::ArrayXd mean = profiles.rowwise().mean();
  const double dark = mean.head((columns + 1) / 2).minCoeff(), light = mean.tail(columns / 2).maxCoeff();
  if (!(light - dark > min_board_contrast)) return std::nullopt;
  std::vector<Vec2> points;
  for (int i = 0; i < rows; ++i)
    if (const auto s = passage(profiles.col(i), reach, (dark + light) / 2)) {
      const Vec2 seen = place(i) + *s * outwards;
      points.push_back(camera ? undistorted(*camera, seen) : seen);
    }
  std::optional<Line> line;
  for (int round = 0; round < 2; ++round) {
    if (points.size() < 5) return std::nullopt;
    line = fitted_line(points);
    std::erase_if(points, [&](const Vec2& point) { return line->absDistance(point) > far_off; });
  }
  return line;
}

std::optional<std::array<Vec2, 4>> refined(const GrayImage& gray, std::array<Vec2, 4> corners, double module,
                                           const std::optional<Camera>& camera) {
  std::array<Vec2, 4> ideal;
  for (int round = 0; round < 2; ++round) {
    const Vec2 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
    std::vector<Line> lines;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto line = edge_line(gray, corners[i], corners[(i + 1) % 4], middle, module, camera);
      if (!line) return std::nullopt;
      lines.push_back(*line);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      ideal[i] = lines[i].intersection(lines[(i + 3) % 4]);
      const Vec2 seen = camera ? distorted(*camera, ideal[i]) : ideal[i];
      // a corner that runs away is that of something else
      if (!((seen - corners[i]).norm() < 5)) return std::nullopt;
      corners[i] = seen;
    }
  }
  return ideal;
}

void read_size(BoardSpec& board, const std::string& part) {
  const std::size_t times = part.find('x');
  const auto columns = whole_number(part.substr(0, times)),
             rows = times == std::string::npos ? std::nullopt : whole_number(part.substr(times + 1));
  if (!columns || !rows || *columns < 1 || *rows < 1 || *columns > 100 || *rows > 100)
    throw InvalidInput("board: '" + part + "' is no number of columns x rows such as 5x4 (at most 100x100)");
  board.columns = *columns;
  board.rows = *rows;
}

void read_key(BoardSpec& board, const std::string& part) {
  const std::size_t equals = part.find('=');
  const std::string key = part.substr(0, equals), value = part.substr(equals + 1);
  std::vector<std::string> keys;
  if (board.kind == BoardSpec::Kind::grid) keys = {"tag", "gap", "dictionary", "first"};
  if (board.kind == BoardSpec::Kind::charuco) keys = {"square", "tag", "dictionary"};
  if (board.kind == BoardSpec::Kind::checker) keys = {"square"};
  if (std::find(keys.begin(), keys.end(), key) == keys.end())
    throw InvalidInput("board: unknown key '" + key + "'" + suggest_name(key, keys));
  if (key == "dictionary") {
    board.dictionary = value;
  } else if (key == "first") {
    const auto first = whole_number(value);
    if (!first) throw InvalidInput("board: first='" + value + "' is no whole number");
    board.first = *first;
  } else {
    (key == "tag" ? board.tag : key == "gap" ? board.gap : board.square) = parse_length(value, "board: " + key);
  }
}

void check(const BoardSpec& board) {
  const bool grid = board.kind == BoardSpec::Kind::grid, checker = board.kind == BoardSpec::Kind::checker;
  if (board.columns == 0) throw InvalidInput("board: no number of columns x rows such as 5x4");
  if (!checker && !(board.tag > 0)) throw InvalidInput("board: the side of a tag is missing, such as tag=12mm");
  if (grid && board.columns * board.rows > 1 && !(board.gap > 0))
    throw InvalidInput("board: the gap between tags is missing, such as gap=3mm");
  if (!grid && !(board.square > 0)) throw InvalidInput("board: the side of a square is missing, such as square=10mm");
  if (board.kind == BoardSpec::Kind::charuco && !(board.tag < board.square))
    throw InvalidInput("board: a tag must be smaller than its square");
  if (board.kind == BoardSpec::Kind::charuco && board.rows % 2 == 0)
    throw InvalidInput("board: a charuco board has an odd number of rows; programs disagree about the others");
  if (!grid && (board.columns < 3 || board.rows < 3))
    throw InvalidInput("board: a board of squares has 3x3 or more; inner corners are what is measured");
}

constexpr double min_fraction = 0.4;  // of a board's tags or corners: fewer fix its perspective badly

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

PlanePoint point_of(const Vec2& seen, const Vec2& place, const std::optional<Camera>& camera) {
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
  const int least = std::max(1, static_cast<int>(std::ceil(min_fraction * board.tags())));
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
  std::vector<Vec2> places, corners;
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
      corners.push_back(pixel);
    }
  const int all = (board.rows - 1) * (board.columns - 1);
  if (static_cast<double>(corners.size()) < std::max(4.0, min_fraction * all))
    refuse(board, static_cast<int>(corners.size()), all, "corners");
  // the window holds the crossing alone, not the tags next to it
  const double margin = side * (board.square - board.tag) / (2 * board.square);
  const int reach = std::max(2, static_cast<int>(0.9 * margin));
  corners = opencv::crossings(gray_of(picture), corners, reach);
  std::vector<PlanePoint> points;
  for (std::size_t i = 0; i < corners.size(); ++i) points.push_back(point_of(corners[i], places[i], camera));
  // the tags reach farther out than the crossings between squares
  for (const auto& [number, tag] : camera ? tags_on(picture, board, camera) : tags) append(points, board, number, tag);
  return points;
}

std::vector<PlanePoint> checker_corners(const RgbImage& picture, const BoardSpec& board,
                                        const std::optional<Camera>& camera) {
  const int columns = board.columns - 1, rows = board.rows - 1;
  const auto corners = opencv::chessboard(gray_of(picture), columns, rows);
  if (!corners)
    throw InvalidInput("the board is not found: no " + std::to_string(columns) + " x " + std::to_string(rows) +
                       " inner corners of " + std::to_string(board.columns) + " x " + std::to_string(board.rows) +
                       " squares; all of it must be in the picture");
  std::vector<PlanePoint> points;
  for (int i = 0; i < rows * columns; ++i) {
    const int row = i / columns, column = i % columns;
    const Vec2 place((column + 1) * board.square, board.height() - (row + 1) * board.square);
    points.push_back(point_of((*corners)[std::size_t(i)], place, camera));
  }
  return points;
}

/// The dark squares of a tag, its border included.
void append_tag(std::vector<std::array<double, 4>>& squares, const BoardSpec& board, int number) {
  const int dictionary = number_of_dictionary(board.dictionary);
  const int count = opencv::dictionary(dictionary).modules + 2;  // of squares in a row
  const std::vector<std::uint8_t> tag = opencv::tag_squares(dictionary, board.first + number);
  const Vec2 top_left = tag_places(board, number)[0];
  const double side = board.tag / count;
  for (int r = 0; r < count; ++r)
    for (int c = 0; c < count; ++c)
      if (tag[std::size_t(r * count + c)] == 0)
        squares.push_back({top_left.x() + c * side, top_left.y() - (r + 1) * side, side, side});
}

}  // namespace

int dictionary_size(const std::string& dictionary) {
  return opencv::dictionary(number_of_dictionary(dictionary)).size;
}

Vec2 Tag::centre() const {
  return Line::Through(corners[0], corners[2]).intersection(Line::Through(corners[1], corners[3]));
}

std::vector<Tag> find_tags(const RgbImage& picture, const std::string& dictionary,
                           const std::optional<Camera>& camera) {
  const int number = number_of_dictionary(dictionary);
  const double module = 1.0 / (opencv::dictionary(number).modules + 2);
  const GrayImage gray = gray_of(picture);
  std::vector<Tag> tags;
  for (const opencv::RoughTag& rough : opencv::find_tags(gray, number))
    if (const auto corners = refined(gray, rough.corners, module, camera)) tags.push_back({rough.number, *corners});
  std::stable_sort(tags.begin(), tags.end(), [](const Tag& a, const Tag& b) { return a.number < b.number; });
  return tags;
}

std::optional<std::array<Vec2, 4>> refine_quad(const RgbImage& picture, const std::array<Vec2, 4>& corners,
                                               double module, const std::optional<Camera>& camera) {
  return refined(gray_of(picture), corners, module, camera);
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    parts.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return parts;
}

std::optional<int> whole_number(const std::string& text) {
  if (text.empty() || text.size() > 6 || text.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return std::stoi(text);
}

double parse_length(const std::string& text, const std::string& what) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const std::string unit = end;
  if (end == text.c_str() || !(value > 0) || !std::isfinite(value))
    throw InvalidInput(what + " '" + text + "' is no length above 0 such as 25mm");
  for (const std::string& known : length_units())
    if (unit == known && std::isfinite(value * mm_per(unit))) return value * mm_per(unit);
  if (unit.empty()) throw InvalidInput(what + " '" + text + "' has no unit; write it as 25mm");
  throw InvalidInput(what + " '" + text + "' has no unit of length" + suggest_name(unit, length_units()));
}

BoardSpec parse_board(const std::string& text) {
  BoardSpec board;
  std::vector<std::string> parts = parts_of(text);
  if (parts[0] == "charuco") board.kind = BoardSpec::Kind::charuco;
  if (parts[0] == "checker") board.kind = BoardSpec::Kind::checker;
  if (parts[0] == "grid" || parts[0] == "charuco" || parts[0] == "checker") parts.erase(parts.begin());
  for (const std::string& part : parts) {
    if (part.find('=') == std::string::npos)
      read_size(board, part);
    else
      read_key(board, part);
  }
  check(board);
  return board;
}

Vec2 grid_corner(const BoardSpec& board, int number, int corner) {
  const int column = number % board.columns, row = number / board.columns;
  const double pitch = board.tag + board.gap;
  const double left = column * pitch, top = board.height() - row * pitch;
  return {corner == 1 || corner == 2 ? left + board.tag : left, corner >= 2 ? top - board.tag : top};
}

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
