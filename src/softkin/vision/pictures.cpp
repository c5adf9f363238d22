#include <algorithm>
#include <cstdlib>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/mesh/text_mesh_tools.hpp>
#include <softkin/vision/open_cv.hpp>
#include <softkin/vision/pictures.hpp>
#include <softkin/vision/pixels.hpp>
#include <utility>

namespace softkin::vision {

namespace {

namespace fs = std::filesystem;

constexpr int min_side = 16;  // [px]

/// A JPEG that was cut off would decode into a picture whose lower part is grey; libpng would print its own words.
bool is_cut_off(const std::string& content) {
  if (content.starts_with("\x89PNG")) return content.rfind("IEND") == std::string::npos;
  if (!content.starts_with("\xFF\xD8\xFF")) return false;
  const std::size_t end = content.rfind("\xFF\xD9");
  return end == std::string::npos || end < content.size() / 2;
}

/// The last number in a file's name, by which frames are ordered.
std::optional<long> number_of(const fs::path& path) {
  const std::string stem = path.stem().string();
  const std::size_t end = stem.find_last_of("0123456789");
  if (end == std::string::npos) return std::nullopt;
  const std::size_t before = stem.find_last_not_of("0123456789", end),
                    begin = before == std::string::npos ? 0 : before + 1;
  if (end - begin > 15) return std::nullopt;
  return std::stol(stem.substr(begin, end - begin + 1));
}

/// In the order of their numbers. A gap would shift the clock, so it is refused.
std::vector<fs::path> pictures_in(const fs::path& folder) {
  std::vector<std::pair<long, fs::path>> found;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = lower_extension(entry.path());
    for (const char* known : {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".ppm", ".pgm", ".webp"}) {
      if (extension != known || !entry.is_regular_file(failure)) continue;
      const auto number = number_of(entry.path());
      if (!number) throw InvalidInput({entry.path().string()}, "a frame needs a number in its name");
      found.emplace_back(*number, entry.path());
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<fs::path> pictures;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0 && found[i].first != found[i - 1].first + 1)
      throw InvalidInput({found[i].second.string()}, "the frame before it is " +
                                                         found[i - 1].second.filename().string() +
                                                         "; numbers must follow one another, for they are the clock");
    pictures.push_back(found[i].second);
  }
  if (pictures.empty()) throw InvalidInput({folder.string()}, "no picture in this folder");
  return pictures;
}

constexpr double hue_tolerance = 20;    // around the hue of #rrggbb [degrees]
constexpr double min_saturation = 0.3;  // printed and painted colours under room light have 0.4 to 1
constexpr double min_value = 50;        // of 255: darker pixels have no hue that can be trusted

struct Known {
  const char* name;
  std::array<double, 3> low, high;
};

constexpr Known by_hue(const char* name, double from, double to) {
  return {name, {from, min_saturation, min_value}, {to, 1, 255}};
}

constexpr std::array<Known, 9> all_known{by_hue("red", -20, 15),
                                         by_hue("orange", 15, 42),
                                         by_hue("yellow", 42, 70),
                                         by_hue("green", 70, 165),
                                         by_hue("cyan", 165, 200),
                                         by_hue("blue", 200, 265),
                                         by_hue("magenta", 265, 340),
                                         Known{"black", {0, 0, 0}, {360, 1, 80}},
                                         Known{"white", {0, 0, 190}, {360, 0.15, 255}}};

Known known(const std::string& name) {
  std::vector<std::string> names;
  for (const Known& each : all_known) {
    if (name == each.name) return each;
    names.emplace_back(each.name);
  }
  if (name.size() != 7 || name[0] != '#' || name.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    throw InvalidInput("no colour '" + name + "'" + suggest_name(name, names) + " (or #rrggbb)");
  const auto bits = std::strtol(name.c_str() + 1, nullptr, 16);
  const auto [hue, saturation, value] = hsv_of({float(bits >> 16), float((bits >> 8) & 255), float(bits & 255)});
  if (saturation < min_saturation || value < min_value)
    throw InvalidInput("colour " + name + " has no hue; take one of more saturation, or black, or white");
  return by_hue("", hue - hue_tolerance, hue + hue_tolerance);
}

}  // namespace

void prepare_opencv(int threads) {
  opencv::prepare(threads);
}

RgbImage read_picture(const fs::path& path) {
  const std::string content = read_file(path);
  std::optional<RgbImage> picture;
  if (!content.empty() && !is_cut_off(content)) picture = opencv::decoded(content);
  if (!picture)
    throw InvalidInput({path.string()},
                       is_cut_off(content) ? "the picture is cut off" : "not a picture that can be read");
  if (picture->width < min_side || picture->height < min_side)
    throw InvalidInput({path.string()}, "the picture is smaller than 16 x 16 pixels");
  return *std::move(picture);
}

bool is_film(const fs::path& path) {
  std::error_code failure;  // a link to itself: reported where it is read
  if (fs::is_directory(path, failure)) return true;
  const std::string extension = lower_extension(path);
  for (const char* known : {".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".wmv"})
    if (extension == known) return true;
  return false;
}

Film::Film(std::vector<fs::path> files, std::optional<double> rate) : name_(files.at(0).string()) {
  std::error_code failure;
  const bool folder = fs::is_directory(files[0], failure);
  if (files.size() > 1 || folder) {
    pictures_ = files.size() > 1 ? std::move(files) : pictures_in(files[0]);
    frames_ = pictures_.size();
    if (!rate && folder)
      throw InvalidInput({name_}, "a folder of pictures has no clock: give the frames per second (fps)");
    if (!rate) throw InvalidInput("pictures have no clock: give the frames per second (fps)");
    rate_ = *rate;
  } else {
    (void)fs::file_size(files[0]);  // names what is wrong with the file
    refuse_lfs_pointer(files[0]);
    video_ = opencv::open_video(name_);
    if (!video_) throw InvalidInput({name_}, "not a video that can be read");
    rate_ = rate ? *rate : video_->rate();
    if (!rate && !(rate_ > 0))
      throw InvalidInput({name_}, "the video does not say its frames per second: give them (fps)");
    frames_ = static_cast<std::size_t>(std::max(0.0, video_->frames()));
  }
  if (!(rate_ > 0 && rate_ <= 1e6)) throw InvalidInput({name_}, "frames per second must be above 0, at most 1e6");
}

Film::~Film() = default;

std::optional<Frame> Film::next() {
  Frame frame{RgbImage(0, 0), static_cast<double>(position_) / rate_, ""};
  if (video_) {
    std::optional<RgbImage> picture = video_->next();
    if (!picture) {
      if (position_ == 0) throw InvalidInput({name_}, "the video has no frame that can be read");
      return std::nullopt;
    }
    frame.picture = *std::move(picture);
    frame.name = name_ + ": frame " + std::to_string(position_ + 1);
  } else {
    if (position_ == pictures_.size()) return std::nullopt;
    frame.name = pictures_[position_].string();
    frame.picture = read_picture(frame.name);
  }
  if (position_++ == 0) {
    width_ = frame.picture.width;
    height_ = frame.picture.height;
  }
  if (frame.picture.width != width_ || frame.picture.height != height_)
    throw InvalidInput({frame.name}, "the picture is not of the size of the first");
  return frame;
}

Colour::Colour(const std::string& requested)
    : name(requested), low(known(requested).low), high(known(requested).high) {}

double clipped_fraction(const RgbImage& picture) {
  std::size_t clipped = 0;
  for (std::size_t i = 0; i < picture.bytes.size(); i += 3)
    clipped += *std::min_element(picture.bytes.begin() + std::ptrdiff_t(i),
                                 picture.bytes.begin() + std::ptrdiff_t(i + 3)) >= 254;
  return static_cast<double>(clipped) / (static_cast<double>(picture.bytes.size()) / 3);
}

}  // namespace softkin::vision
