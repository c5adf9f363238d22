#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/vision/outlines.hpp>
#include <softkin/vision/pixels.hpp>
#include <softkin/vision/silhouettes.hpp>

namespace softkin::vision {

namespace {

constexpr int min_silhouette = 100;         // [px]: smaller parts are dirt
constexpr int frame_margin = 3;             // points nearer to the frame are left out [px]
constexpr std::size_t max_outline = 400;    // points
constexpr std::size_t chord = 4;            // to both sides along the outline, for its normal [px]
constexpr std::size_t side_of_polygon = 8;  // by which the length is measured: steps of pixels are no length [px]
constexpr double min_contrast = 30;         // between the robot and the ground, of 255
constexpr double reach_of_edge = 3;         // to both sides, where the edge is looked for [px]
constexpr double step_of_edge = 0.25;

/// Mean of 3 x 3, so that noise makes no specks; at the frame of what there is.
GrayImage smoothed(const GrayImage& gray) {
  GrayImage mean = gray;
  for (int y = 0; y < gray.height; ++y)
    for (int x = 0; x < gray.width; ++x) {
      int sum = 0, count = 0;
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, gray.height - 1); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, gray.width - 1); ++i, ++count) sum += gray.at(i, j);
      mean.bytes[std::size_t(y) * std::size_t(gray.width) + std::size_t(x)] =
          static_cast<std::uint8_t>((sum + count / 2) / count);
    }
  return mean;
}

struct TwoClasses {
  int threshold = 0;            // the dark class is up to it
  double dark = 0, bright = 0;  // means
};

/// The threshold with the largest variance between the classes.
TwoClasses two_classes(const GrayImage& gray) {
  std::array<double, 256> histogram{};
  for (const std::uint8_t byte : gray.bytes) histogram[byte] += 1;
  double count = 0, sum = 0;
  for (std::size_t i = 0; i < 256; ++i) count += histogram[i], sum += static_cast<double>(i) * histogram[i];
  TwoClasses best;
  double below = 0, sum_below = 0, largest = -1;
  for (std::size_t i = 0; i < 255; ++i) {
    below += histogram[i];
    sum_below += static_cast<double>(i) * histogram[i];
    if (below == 0 || below == count) continue;
    const double dark = sum_below / below, bright = (sum - sum_below) / (count - below);
    const double between = below * (count - below) * (bright - dark) * (bright - dark);
    if (between > largest) largest = between, best = {static_cast<int>(i), dark, bright};
  }
  return best;
}

/// From a pixel of the border outwards, or back, to where the picture is half the colour of what is inside and half
/// that of what is outside: blur leaves that where it is. Where both are alike, to the outer edge of the pixel.
Vec2 moved_to_edge(const RgbImage& picture, const Vec2& pixel, const Vec2& outward) {
  const auto colour = [&](double at) { return between(picture, pixel + at * outward); };
  const Eigen::Vector3d outside = colour(reach_of_edge), contrast = colour(-reach_of_edge) - outside;
  const auto fraction = [&](double at) { return (colour(at) - outside).dot(contrast) / contrast.squaredNorm() - 0.5; };
  double before = 0.5;
  for (double at = step_of_edge - reach_of_edge; contrast.norm() > min_contrast && at <= reach_of_edge;
       at += step_of_edge) {
    const double here = fraction(at);
    if (here <= 0) return pixel + (at - step_of_edge * here / (here - before)) * outward;
    before = here;
  }
  return pixel + 0.5 * outward;
}

/// Border pixels moved to the edge. Their order is against the clock as seen, y being down.
std::vector<Vec2> edge_points(const RgbImage& picture, const std::vector<Vec2>& border) {
  std::vector<Vec2> points;
  const std::size_t count = border.size(), reach = std::min(chord, count / 4);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 along = border[(i + reach) % count] - border[(i + count - reach) % count];
    const Vec2 normal(-along.y(), along.x());
    points.push_back(normal.norm() > 0 ? moved_to_edge(picture, border[i], normal.normalized()) : border[i]);
  }
  return points;
}

GrayImage mask_by_brightness(const RgbImage& picture, const SilhouetteLook& look) {
  GrayImage mask = smoothed(gray_of(picture));
  const TwoClasses classes = two_classes(mask);
  if (classes.bright - classes.dark < min_contrast)
    throw InvalidInput("no outline found: the picture is nearly the same brightness everywhere");
  for (std::uint8_t& byte : mask.bytes) byte = (byte <= classes.threshold) == (look.name == "dark") ? 1 : 0;
  return mask;
}

double length_of(const std::vector<Vec2>& points) {
  double length = 0;
  for (std::size_t i = 0; i < points.size(); i += side_of_polygon)
    length += (points[i + side_of_polygon < points.size() ? i + side_of_polygon : 0] - points[i]).norm();
  return length;
}

const Blob& largest_of(const std::vector<Blob>& blobs, const SilhouetteLook& look, const RgbImage& picture) {
  if (blobs.empty())
    throw InvalidInput("no outline found: nothing that is " + look.name + " has " + std::to_string(min_silhouette) +
                       " pixels or more");
  const Blob& blob = blobs[0];
  if (blob.box == PixelBox{0, 0, picture.width, picture.height})
    throw InvalidInput("no outline found: the largest part that is " + look.name +
                       " reaches all sides of the picture, so it is the ground behind the robot");
  return blob;
}

Silhouette silhouette_of(const Blob& blob, const RgbImage& picture, const PlaneView& view) {
  const std::vector<Vec2> border = outline_of(blob);
  std::vector<Vec2> places;
  for (const Vec2& point : edge_points(picture, border)) places.push_back(view.to_mm(point));
  Silhouette silhouette;
  silhouette.length = length_of(places);
  silhouette.area = moments_of(places).area;
  silhouette.cut = blob.touches_frame(picture, frame_margin);
  const std::size_t each = (places.size() + max_outline - 1) / max_outline;
  for (std::size_t i = 0; i < places.size(); i += each) {
    const Vec2& at = border[i];
    const double nearest = std::min({at.x(), at.y(), picture.width - 1 - at.x(), picture.height - 1 - at.y()});
    if (nearest >= frame_margin) silhouette.points.push_back(places[i]);
  }
  return silhouette;
}

}  // namespace

SilhouetteLook::SilhouetteLook(const std::string& requested) : name(requested) {
  if (requested != "dark" && requested != "bright") colour = Colour(requested);
}

Silhouette find_silhouette(const RgbImage& picture, const SilhouetteLook& look, const PlaneView& view) {
  const std::vector<Blob> blobs = look.colour ? find_blobs(picture, *look.colour, min_silhouette)
                                              : find_blobs(mask_by_brightness(picture, look), min_silhouette);
  return silhouette_of(largest_of(blobs, look, picture), picture, view);
}

}  // namespace softkin::vision
