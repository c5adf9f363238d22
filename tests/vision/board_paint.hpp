#pragma once

#include <softkin/vision/boards.hpp>
#include <vision/rendering.hpp>

namespace softkin::testing {

using namespace vision;

/// A printed board, its lower left corner at a place of the plane [mm].
class BoardPaint {
 public:
  BoardPaint(
      const BoardSpec& board, const Vec2& corner, Paint ground = [](const Vec2&) { return paper; })
      : board_(board), corner_(corner), ground_(std::move(ground)) {
    for (const auto& square : board_squares(board)) {
      const int first = cell(square[0]), last = cell(square[0] + square[2]);
      for (int i = first; i <= last; ++i) columns_[std::size_t(i)].push_back(square);
    }
  }

  Eigen::Vector3d operator()(const Vec2& place) const {
    const Vec2 arm = place - corner_;
    if (arm.x() < 0 || arm.y() < 0 || arm.x() > board_.width() || arm.y() > board_.height()) return ground_(place);
    for (const auto& [x, y, w, h] : columns_[std::size_t(cell(arm.x()))])
      if (arm.x() >= x && arm.x() <= x + w && arm.y() >= y && arm.y() <= y + h) return ink;
    return paper;
  }

 private:
  static constexpr int cells = 64;  // so that a point is tested against few squares

  [[nodiscard]] int cell(double x) const { return std::clamp(int(x / board_.width() * cells), 0, cells - 1); }

  BoardSpec board_;
  Vec2 corner_;
  Paint ground_;
  std::vector<std::vector<std::array<double, 4>>> columns_ = std::vector<std::vector<std::array<double, 4>>>(cells);
};

}  // namespace softkin::testing
