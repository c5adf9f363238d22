#pragma once

#include <array>
#include <map>
#include <optional>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/pictures.hpp>
#include <softkin/vision/silhouettes.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

/// The options of a measurement as typed: docs/measure.md.
struct MeasureOptions {
  std::string board{}, scale{}, camera{}, dots{}, tags{}, dictionary{}, interface {
  }, origin{}, x_axis{}, outline{};
  std::vector<std::string> angles{};
  bool moving_camera = false;
  std::optional<Camera> lens{};  // that the file `camera` would have; `camera` is then its name alone
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

/// The options of a measurement, parsed.
struct MeasureRequest {
  MeasureOptions given;
  std::vector<DotRequest> dots;
  std::map<int, std::string> tags;  // their names by number
  bool all_tags = false;
  std::optional<BoardSpec> board;
  std::optional<ScaleRequest> scale;
  std::optional<Camera> camera;
  std::optional<std::array<Colour, 2>> interface;
  std::optional<SilhouetteLook> outline;
  std::vector<AngleRequest> angles;
  std::array<std::string, 2> x_axis;
};

/// throws  InvalidInput naming the option
[[nodiscard]] MeasureRequest understood(const MeasureOptions& options);

}  // namespace softkin::vision
