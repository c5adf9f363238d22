#pragma once

#include <array>
#include <map>
#include <optional>
#include <softkin/vision/boards.hpp>
#include <softkin/vision/dots.hpp>
#include <softkin/vision/specimen_edges.hpp>
#include <string>
#include <vector>

namespace softkin::cli {

using namespace vision;

/// What the user asked for, as typed.
struct MeasureOptions {
  std::vector<std::string> pictures;
  std::string board, scale, camera, dots, tags, dictionary, interface, origin, x_axis, output;
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
  MeasureOptions given;
  std::vector<DotRequest> dots;
  std::map<int, std::string> tags;  // their names by number
  bool all_tags = false;
  std::optional<BoardSpec> board;
  std::optional<ScaleRequest> scale;
  std::optional<Camera> camera;
  std::optional<std::array<Colour, 2>> interface;
  std::vector<AngleRequest> angles;
  std::array<std::string, 2> x_axis;
};

/// throws  InvalidInput naming the option
[[nodiscard]] MeasureRequest understood(const MeasureOptions& options);

struct NamedMarker {
  std::string name;
  MarkerPlace at;
};

struct Angle {
  std::string name;
  double degrees = 0, error = 0;  // counter-clockwise; standard error
};

/// Finds in one picture after another what was asked for. The first picture fixes the scale (unless the camera moves or
/// each picture has its board) and the axes of the mm frame.
class Measurer {
 public:
  Measurer(MeasureRequest request, bool film) : request_(std::move(request)), film_(film) {}

  struct Seen {
    std::vector<NamedMarker> markers;  // in the order of the first picture
    std::optional<SpecimenView> specimen;
    std::vector<Angle> angles;
  };

  /// Throws InvalidInput that begins with file.
  [[nodiscard]] Seen measure(const RgbImage& picture, const std::string& file);

  /// How the scale was found, for people: a line or two.
  [[nodiscard]] std::vector<std::string> notes() const;
  [[nodiscard]] double mm_per_pixel() const { return mm_per_pixel_; }  // in the middle of the first picture

 private:
  Seen in_picture(const RgbImage& picture);
  PlaneView view_of(const RgbImage& picture);
  PlaneView scaled(const RgbImage& picture);
  std::vector<NamedMarker> markers_in(const RgbImage& picture, const PlaneView& view);
  void append_tags(std::vector<NamedMarker>& markers, const RgbImage& picture, const PlaneView& view);
  std::vector<Angle> angles_of(const std::vector<NamedMarker>& markers);

  MeasureRequest request_;
  bool film_;
  std::optional<PlaneView> view_;  // that holds for all pictures
  bool first_ = true;
  Vec2 origin_ = Vec2::Zero();
  double turn_ = 0;
  std::map<std::string, double> last_angles_;
  double mm_per_pixel_ = 0;
  double scale_error_ = 0;     // relative, of --scale a,b [-]
  double board_residual_ = 0;  // worst picture [px]
};

// The commands; return the exit code, throw InvalidInput.
[[nodiscard]] int measure_photos(const MeasureOptions& options);
[[nodiscard]] int measure_film(const MeasureOptions& options);

}  // namespace softkin::cli
