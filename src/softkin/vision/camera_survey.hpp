#pragma once

#include <softkin/io/table/table.hpp>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/pictures.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

/// Pictures of a board, one after another, and the camera that took them.
class CameraSurvey {
 public:
  explicit CameraSurvey(BoardSpec board) : board_(std::move(board)) {}

  /// Throws InvalidInput that begins with file: no board, or a picture of another size
  void add(const RgbImage& picture, const std::string& file);
  [[nodiscard]] std::size_t size() const { return boards_.size(); }

  /// Throws as fit_camera()
  void fit();

  // Of the camera that was fitted:

  [[nodiscard]] const Camera& camera() const { return camera_; }
  /// Root mean square distance of the corners in each picture [px].
  [[nodiscard]] const std::vector<double>& errors() const { return errors_; }
  [[nodiscard]] Table shown() const;
  [[nodiscard]] std::string text() const;
  /// output: the camera's file
  [[nodiscard]] std::string json(const std::string& output) const;

 private:
  BoardSpec board_;
  std::vector<BoardSight> boards_;
  int width_ = 0, height_ = 0;
  Camera camera_;
  std::vector<double> errors_;
};

}  // namespace softkin::vision
