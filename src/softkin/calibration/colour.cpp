#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <softkin/calibration/colour.hpp>
#include <softkin/core/error.hpp>

namespace softkin {

namespace {

struct Hue {
  const char* name;
  double from, to;  // [degrees]
};

constexpr std::array<Hue, 7> hues{{{"red", 340, 15},
                                   {"orange", 15, 42},
                                   {"yellow", 42, 70},
                                   {"green", 70, 165},
                                   {"cyan", 165, 200},
                                   {"blue", 200, 265},
                                   {"magenta", 265, 340}}};
constexpr double hue_tolerance = 20;      // around the hue of #rrggbb [degrees]
constexpr double least_saturation = 0.3;  // printed and painted colours under room light have 0.4 to 1
constexpr double least_value = 50;        // of 255: darker pixels have no hue that can be trusted

struct HueSaturation {
  double hue, saturation, value;
};

HueSaturation in_hue(const std::array<double, 3>& c) {
  const double high = std::max({c[0], c[1], c[2]}), low = std::min({c[0], c[1], c[2]}), range = high - low;
  if (!(range > 0)) return {0, 0, high};
  double hue = 0;
  if (high == c[0])
    hue = 60 * (c[1] - c[2]) / range;
  else if (high == c[1])
    hue = 120 + 60 * (c[2] - c[0]) / range;
  else
    hue = 240 + 60 * (c[0] - c[1]) / range;
  return {hue < 0 ? hue + 360 : hue, range / high, high};
}

bool is_hex(const std::string& name) {
  return name.size() == 7 && name[0] == '#' && name.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
}

}  // namespace

const std::vector<std::string>& Colour::names() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> list;
    for (const Hue& hue : hues) list.emplace_back(hue.name);
    list.insert(list.end(), {"black", "white"});
    return list;
  }();
  return all;
}

Colour::Colour(const std::string& name) : name_(name), black_(name == "black"), white_(name == "white") {
  if (black_ || white_) return;
  if (is_hex(name)) {
    const long value = std::strtol(name.c_str() + 1, nullptr, 16);
    const HueSaturation colour = in_hue(
        {static_cast<double>(value >> 16), static_cast<double>((value >> 8) & 255), static_cast<double>(value & 255)});
    if (colour.saturation < least_saturation || colour.value < least_value)
      throw InvalidInput("colour " + name + " has no hue; take one of more saturation, or black, or white");
    hue_from_ = std::fmod(colour.hue + 360 - hue_tolerance, 360);
    hue_to_ = std::fmod(colour.hue + hue_tolerance, 360);
    return;
  }
  for (const Hue& hue : hues)
    if (name == hue.name) {
      hue_from_ = hue.from;
      hue_to_ = hue.to;
      return;
    }
  throw InvalidInput("no colour '" + name + "'" + suggest_name(name, names()) + " (or #rrggbb)");
}

bool Colour::has(const std::array<double, 3>& channels) const {
  const HueSaturation pixel = in_hue(channels);
  if (black_) return pixel.value < 80;
  if (white_) return pixel.value > 190 && pixel.saturation < 0.15;
  if (pixel.saturation < least_saturation || pixel.value < least_value) return false;
  if (hue_from_ > hue_to_) return pixel.hue >= hue_from_ || pixel.hue < hue_to_;
  return pixel.hue >= hue_from_ && pixel.hue < hue_to_;
}

std::vector<std::uint8_t> pixels_of(const Colour& colour, const RgbImage& picture) {
  const int width = picture.width, height = picture.height;
  std::vector<std::uint8_t> mask(std::size_t(width) * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::array<double, 3> mean{};
      int count = 0;
      for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i, ++count)
          for (std::size_t c = 0; c < 3; ++c) mean[c] += picture.bytes[3 * (std::size_t(j) * width + i) + c];
      for (double& channel : mean) channel /= count;
      mask[std::size_t(y) * width + x] = colour.has(mean);
    }
  return mask;
}

double clipped_share(const RgbImage& picture) {
  std::size_t clipped = 0;
  for (std::size_t i = 0; i + 2 < picture.bytes.size(); i += 3)
    clipped += picture.bytes[i] >= 254 && picture.bytes[i + 1] >= 254 && picture.bytes[i + 2] >= 254;
  return static_cast<double>(clipped) / (static_cast<double>(picture.bytes.size()) / 3);
}

}  // namespace softkin
