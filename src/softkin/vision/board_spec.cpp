#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/vision/boards.hpp>

namespace softkin::vision {

namespace {

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

}  // namespace

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

}  // namespace softkin::vision
