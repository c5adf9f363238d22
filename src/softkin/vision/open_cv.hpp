#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <softkin/io/picture/rgb_image.hpp>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/pixels.hpp>
#include <string>
#include <vector>

/// What this module leaves to OpenCV: decoding, and the finding of tags and boards. The module has these declarations
/// alone; who uses it brings the functions: programs those of linked/, which call OpenCV's libraries, the Python
/// package those of python/src/vision, which call its cv2.
namespace softkin::vision::opencv {

/// Threads (0: one a core), and its own messages off.
void prepare(int threads);

/// The picture in the content of a file, turned as its camera specifies; none where that is no picture.
[[nodiscard]] std::optional<RgbImage> decoded(const std::string& content);

/// A video that is open.
class Video {
 public:
  virtual ~Video() = default;
  /// The next frame; none after the last.
  [[nodiscard]] virtual std::optional<RgbImage> next() = 0;
  [[nodiscard]] double rate() const { return rate_; }      // frames per second of its header; 0: none
  [[nodiscard]] double frames() const { return frames_; }  // that it should have; 0 or less: not known

 protected:
  double rate_ = 0, frames_ = 0;
};

/// Null where the file is no video that can be read.
[[nodiscard]] std::unique_ptr<Video> open_video(const std::string& file);

/// Dictionaries of tags by their number, in OpenCV's order: 0 is 4x4_50, 16 the original one.
struct Dictionary {
  int size = 0;     // tags
  int modules = 0;  // squares in a row of a tag, without its border
};
[[nodiscard]] Dictionary dictionary(int number);

/// The squares of a tag row by row with its border, modules + 2 in a row; dark ones are 0.
[[nodiscard]] std::vector<std::uint8_t> tag_squares(int dictionary, int tag);

/// A tag with its corners as its contour has them: top left of the tag, then clockwise [px].
struct RoughTag {
  int number = 0;
  std::array<Vec2, 4> corners;
};
[[nodiscard]] std::vector<RoughTag> find_tags(const GrayImage& picture, int dictionary);

/// Inner corners of a chessboard row by row [px]; none where not all of them are found.
[[nodiscard]] std::optional<std::vector<Vec2>> chessboard(const GrayImage& picture, int columns, int rows);

/// Crossings of dark and light squares to a fraction of a pixel, from where they are roughly; reach: of the window that
/// is looked at, to each side [px].
[[nodiscard]] std::vector<Vec2> crossings(const GrayImage& picture, const std::vector<Vec2>& rough, int reach);

/// A camera as fit_camera() wants it, k3 being 0.
struct Fit {
  std::array<double, 4> matrix{};                // fx, fy, cx, cy [px]
  std::array<double, 4> lens{};                  // k1, k2, p1, p2
  std::array<double, 2> focal_errors{};          // standard errors of fx and fy [px]
  double reprojection_error = 0;                 // root of the mean square [px]
  std::vector<double> errors;                    // the same of each picture
  std::vector<std::array<double, 3>> rotations;  // of each board, axis times angle [rad]
};

/// None where no camera fits.
[[nodiscard]] std::optional<Fit> calibrated(const std::vector<BoardSight>& sights, int width, int height);

}  // namespace softkin::vision::opencv
