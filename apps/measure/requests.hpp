#pragma once

#include <array>
#include <map>
#include <optional>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/dots.hpp>
#include <softkin/vision/plane_view.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

using namespace vision;

/// What the user asked for, as typed.
struct MeasureOptions {
  std::vector<std::string> pictures;
  std::string board, scale, camera, dots, tags, dictionary = "4x4_50", interface, origin, x_axis, output;
  std::vector<std::string> angles;
  double fps = 0;  // 0: not given
  int threads = 0;
  bool json = false, moving_camera = false;
};

/// A coloured dot with a name.
struct DotRequest {
  std::string name;
  Colour colour;
};

/// The angle of the line from one marker to another, against the x axis or a second such line.
struct AngleRequest {
  std::vector<std::string> markers;  // two or four

  [[nodiscard]] std::string name() const;  // "angle_a_b"
};

/// Two points at a known distance.
struct ScaleRequest {
  std::optional<std::array<Vec2, 2>> pixels;
  std::array<std::string, 2> markers;  // where there are no pixels
  double length = 0;                   // [mm]
};

/// What the user asked for, understood.
struct MeasureRequest {
  std::vector<DotRequest> dots;
  std::map<int, std::string> tags;  // their names by number
  bool all_tags = false;
  std::string dictionary;
  std::optional<BoardSpec> board;
  std::optional<ScaleRequest> scale;
  std::optional<Camera> camera;
  std::string camera_file;
  std::optional<std::array<Colour, 2>> interface;
  std::vector<AngleRequest> angles;
  std::string origin;
  std::array<std::string, 2> x_axis;
  bool moving_camera = false;
};

/// throws  InvalidInput naming the option
[[nodiscard]] MeasureRequest understood(const MeasureOptions& options);

}  // namespace softkin::cli
