#pragma once

#include <map>
#include <optional>
#include <softkin/vision/dots.hpp>
#include <softkin/vision/measure_request.hpp>
#include <softkin/vision/specimen_edges.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

struct NamedMarker {
  std::string name;
  MarkerPlace at;
};

struct Angle {
  std::string name;
  double degrees = 0, error = 0;  // counter-clockwise; standard error
};

/// Measures the requested markers in one picture after another. The first picture fixes the scale (unless the camera
/// moves or each picture has its board) and the axes of the mm frame.
class Measurer {
 public:
  Measurer(MeasureRequest request, bool film) : request_(std::move(request)), film_(film) {}

  struct Seen {
    std::vector<NamedMarker> markers;  // in the order of the first picture
    std::optional<SpecimenView> specimen;
    std::vector<Angle> angles;
    std::optional<Silhouette> outline;
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

}  // namespace softkin::vision
