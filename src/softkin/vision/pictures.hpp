#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <softkin/io/picture/rgb_image.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

namespace opencv {
class Video;
}

/// Before anything else of this module: threads of OpenCV (0: one a core), and its own messages off.
void prepare_opencv(int threads);

/// A picture of any common form (PNG, JPEG, TIFF, BMP, ...), 8 bits a channel, turned as its camera specifies.
/// throws  InvalidInput: cannot be read, cut off, smaller than 16 x 16 pixels
[[nodiscard]] RgbImage read_picture(const std::filesystem::path& path);

/// A frame of a film.
struct Frame {
  RgbImage picture;
  double time = 0;   // since the first [s]
  std::string name;  // for messages
};

/// A film: a video file, a folder of pictures whose names end in consecutive numbers, or pictures one after
/// another.
class Film {
 public:
  /// files  the video, the folder, or the pictures
  /// rate   frames in a second; none: that of the video
  /// throws  InvalidInput: cannot be read, no frame, no rate, a rate that is not > 0
  Film(std::vector<std::filesystem::path> files, std::optional<double> rate);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// The next frame; none after the last. Throws InvalidInput where a picture cannot be read or differs in size.
  [[nodiscard]] std::optional<Frame> next();
  [[nodiscard]] double rate() const { return rate_; }
  /// How many frames there should be; 0: not known.
  [[nodiscard]] std::size_t frames() const { return frames_; }

 private:
  std::string name_;
  std::vector<std::filesystem::path> pictures_;
  std::unique_ptr<opencv::Video> video_;
  double rate_ = 0;
  std::size_t frames_ = 0, position_ = 0;
  int width_ = 0, height_ = 0;
};

/// Is this a film: a folder, or a file with the extension of a video?
[[nodiscard]] bool is_film(const std::filesystem::path& path);

/// A colour that a pixel has or has not: red, orange, yellow, green, cyan, blue, magenta by hue; black, white; or the
/// hue of "#rrggbb".
struct Colour {
  std::string name;
  // hue [degrees], from low to high around the circle; saturation [-]; value, of 255
  std::array<double, 3> low, high;

  /// throws  InvalidInput: no such colour, or a "#rrggbb" without hue
  explicit Colour(const std::string& name);
};

/// Share of pixels at full white in all channels, where nothing can be measured any more [-].
[[nodiscard]] double clipped_fraction(const RgbImage& picture);

}  // namespace softkin::vision
