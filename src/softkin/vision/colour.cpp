#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/colour.hpp>
#include <softkin/vision/pixels.hpp>

namespace softkin::vision {

namespace {

constexpr double hue_tolerance = 20;      // around the hue of #rrggbb [degrees]
constexpr double least_saturation = 0.3;  // printed and painted colours under room light have 0.4 to 1
constexpr double least_value = 50;        // of 255: darker pixels have no hue that can be trusted

struct Known {
  const char* name;
  std::array<double, 3> low, high;
};

constexpr Known by_hue(const char* name, double from, double to) {
  return {name, {from, least_saturation, least_value}, {to, 1, 255}};
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
  cv::Mat3f pixel(1, 1, cv::Vec3f(float(bits >> 16), float((bits >> 8) & 255), float(bits & 255)));
  cv::cvtColor(pixel, pixel, cv::COLOR_RGB2HSV);
  const double hue = pixel(0)[0];
  if (pixel(0)[1] < least_saturation || pixel(0)[2] < least_value)
    throw InvalidInput("colour " + name + " has no hue; take one of more saturation, or black, or white");
  return by_hue("", hue - hue_tolerance, hue + hue_tolerance);
}

}  // namespace

Colour::Colour(const std::string& asked) : name(asked), low(known(asked).low), high(known(asked).high) {}

double clipped_share(const RgbImage& picture) {
  cv::Mat clipped;
  cv::inRange(mat_of(picture), cv::Scalar::all(254), cv::Scalar::all(255), clipped);
  return cv::countNonZero(clipped) / static_cast<double>(clipped.total());
}

}  // namespace softkin::vision
