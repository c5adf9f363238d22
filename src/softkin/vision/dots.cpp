#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/dots.hpp>
#include <softkin/vision/pixels.hpp>
#include <utility>

namespace softkin::vision {

namespace {

constexpr int min_area = 20;                  // [px]: a diameter of 5
constexpr double min_fullness = 0.88;         // a half disc has 0.95
constexpr double largest_elongation = 3;      // a disc seen at 70 degrees
constexpr double rival_fraction = 0.3;        // of the largest dot's area: smaller ones are dirt
constexpr int blur = 4;                       // the edge of a dot fades within so many pixels
constexpr int ring = 4;                       // width of the ground looked at around it [px]
constexpr double max_glare = 0.02;            // of a dot's inner pixels
constexpr double max_white = 0.7;             // more of it: a ring on paper, not a highlight on a dot
constexpr double over_exposed_picture = 0.3;  // fraction of clipped pixels that explains a missing dot

using Rgb3 = Eigen::RowVector3d;

std::string at_pixel(const Vec2& place) {
  return "(" + std::to_string(std::lround(place.x())) + ", " + std::to_string(std::lround(place.y())) + ")";
}

std::string percent(double fraction) {
  return std::to_string(std::lround(100 * fraction)) + " %";
}

/// Some pixels, a row each: (1, x, y) from the dot's centre, and their colours.
struct Pixels {
  Eigen::MatrixX3d places, colours;

  template <class Condition>
  [[nodiscard]] Pixels where(const Condition& condition) const {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < places.rows(); ++i)
      if (condition(i)) kept.push_back(i);
    return {places(kept, Eigen::all), colours(kept, Eigen::all)};
  }
};

/// Those of a window of the picture that a condition of their place in it holds for.
template <class Condition>
Pixels pixels_in(const RgbImage& picture, const PixelBox& window, const Vec2& centre, const Condition& condition) {
  std::vector<std::pair<int, int>> points;
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x)
      if (condition(x, y)) points.emplace_back(window.x + x, window.y + y);
  Pixels pixels{Eigen::MatrixX3d(points.size(), 3), Eigen::MatrixX3d(points.size(), 3)};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Index row = i;
    const auto [x, y] = points[i];
    const std::uint8_t* rgb = picture.bytes.data() + 3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x));
    pixels.places.row(row) << 1, x - centre.x(), y - centre.y();
    pixels.colours.row(row) << rgb[0], rgb[1], rgb[2];
  }
  return pixels;
}

/// Steps along rows, columns or diagonals from the blob, of each pixel of a window that holds it.
Eigen::ArrayXXi steps_from(const Blob& blob, const PixelBox& window) {
  const int far = window.width + window.height;
  Eigen::ArrayXXi steps = Eigen::ArrayXXi::Constant(window.width + 2, window.height + 2, far);  // with a rim
  auto inner = steps.block(1, 1, window.width, window.height);
  for (int y = 0; y < blob.box.height; ++y)
    for (int x = 0; x < blob.box.width; ++x)
      if (blob.mask.at(x, y) != 0) inner(blob.box.x - window.x + x, blob.box.y - window.y + y) = 0;
  // from the pixels before and then from those behind: exact for these steps
  for (int y = 1; y <= window.height; ++y)
    for (int x = 1; x <= window.width; ++x)
      steps(x, y) = std::min(
          {steps(x, y), steps(x - 1, y) + 1, steps(x - 1, y - 1) + 1, steps(x, y - 1) + 1, steps(x + 1, y - 1) + 1});
  for (int y = window.height; y >= 1; --y)
    for (int x = window.width; x >= 1; --x)
      steps(x, y) = std::min(
          {steps(x, y), steps(x + 1, y) + 1, steps(x + 1, y + 1) + 1, steps(x, y + 1) + 1, steps(x - 1, y + 1) + 1});
  return inner;
}

Rgb3 median(Eigen::MatrixX3d colours) {
  const Eigen::Index middle = colours.rows() / 2;
  for (auto channel : colours.colwise()) std::nth_element(channel.begin(), channel.begin() + middle, channel.end());
  return colours.row(middle);
}

/// Square of the distance from the centre of an ellipse, whose edge is at 4.
Eigen::ArrayXd distances(const Pixels& pixels, const Blob& blob) {
  const auto arms = pixels.places.rightCols<2>();
  return (arms * blob.spread.inverse()).cwiseProduct(arms).rowwise().sum();
}

/// Median colour in the middle, where no ground shines through; of the whole blob where that is a ring.
Rgb3 core_colour(const RgbImage& picture, const Blob& blob) {
  const Pixels all = pixels_in(picture, blob.box, blob.centre, [&](int x, int y) { return blob.mask.at(x, y) != 0; });
  const Eigen::ArrayXd distance = distances(all, blob);
  const Pixels core = all.where([&](Eigen::Index i) { return distance[i] <= 1; });
  return median(core.places.rows() > 0 ? core.colours : all.colours);
}

/// Colour of the ground as a linear function of the place, for lighting is never even, and covariance of its noise.
struct Ground {
  Eigen::Matrix3d fit, noise;
};

Ground ground_of(const Pixels& ring_pixels) {
  const Rgb3 middle = median(ring_pixels.colours);
  const Eigen::MatrixX3d off = (ring_pixels.colours.rowwise() - middle).cwiseAbs();
  const Rgb3 width = (3 * (1.4826 * median(off)).cwiseMax(3)).array() + 6;
  // what else lies there, another marker or an edge, is no ground
  const Pixels ground = ring_pixels.where([&](Eigen::Index i) { return (off.row(i).array() <= width.array()).all(); });
  Ground result;
  result.fit = MinimumNorm(ground.places).solve(ground.colours);
  const Eigen::MatrixX3d miss = ground.colours - ground.places * result.fit;
  result.noise = miss.transpose() * miss / static_cast<double>(miss.rows());
  result.noise.diagonal().array() += 1.0 / 12;  // whole numbers
  return result;
}

MarkerPlace refined(const RgbImage& picture, const Blob& blob, const PlaneView& view) {
  const int reach = blur + ring;
  const PixelBox window =
      shared_part({blob.box.x - reach, blob.box.y - reach, blob.box.width + 2 * reach, blob.box.height + 2 * reach},
                  {0, 0, picture.width, picture.height});
  const Eigen::ArrayXXi steps = steps_from(blob, window);
  const Ground ground = ground_of(pixels_in(
      picture, window, blob.centre, [&](int x, int y) { return steps(x, y) > blur && steps(x, y) <= blur + ring; }));
  const Pixels near = pixels_in(picture, window, blob.centre, [&](int x, int y) { return steps(x, y) <= blur; });
  const Rgb3 contrast = core_colour(picture, blob) - ground.fit.row(0);
  const double size = contrast.squaredNorm();
  const Eigen::VectorXd fractions = (near.colours - near.places * ground.fit) * contrast.transpose() / size;
  Eigen::MatrixX2d places(fractions.size(), 2);
  Eigen::VectorXd areas(fractions.size());
  for (Eigen::Index i = 0; i < fractions.size(); ++i) {
    const Vec2 seen = blob.centre + near.places.row(i).tail<2>().transpose();
    places.row(i) = view.to_mm(seen);
    areas[i] = view.pixel_area(seen);
  }
  const double sum = fractions.dot(areas);
  MarkerPlace result;
  result.place = places.transpose() * fractions.cwiseProduct(areas) / sum;
  result.pixel = view.to_pixel(result.place);
  const double noise = (contrast * ground.noise).dot(contrast) / (size * size);  // variance of a pixel's fraction
  const double arm = areas.cwiseAbs2().dot((places.rowwise() - result.place.transpose()).rowwise().squaredNorm());
  result.error = std::hypot(std::sqrt(noise * arm / 2) / sum, pixel_error * std::sqrt(view.pixel_area(result.pixel)),
                            view.error_at(result.pixel));
  return result;
}

/// Share of the inner dot that is nearer to white than to the dot's colour: a highlight, which moves the centre.
double glare(const RgbImage& picture, const Blob& blob) {
  const double white = (core_colour(picture, blob).minCoeff() + 255) / 2;
  const Pixels all = pixels_in(picture, blob.box, blob.centre, [](int, int) { return true; });
  const auto inner = (distances(all, blob) <= 1.5).eval();  // farther out the ground shines through
  const auto bright = (all.colours.rowwise().minCoeff().array() > white).eval();
  return inner.any() ? static_cast<double>((inner && bright).count()) / static_cast<double>(inner.count()) : 0;
}

}  // namespace

MarkerPlace find_dot(const RgbImage& picture, const Colour& colour, const PlaneView& view, const std::string& name) {
  const std::string dot = name == colour.name ? "dot '" + name + "'" : colour.name + " dot '" + name + "'";
  std::vector<Blob> blobs = find_blobs(picture, colour, min_area);
  const bool white = colour.name == "white";
  const auto refuse_glare = [&](const Blob& blob) {
    const double fraction = white || blob.elongation() > largest_elongation ? 0 : glare(picture, blob);
    if (fraction > max_glare && fraction < max_white)
      throw InvalidInput(percent(fraction) + " of " + dot + " at " + at_pixel(blob.centre) +
                         " is white: it is over-exposed, has a highlight, or is not a full dot");
  };
  const std::vector<Blob> all = blobs;
  std::erase_if(
      blobs, [](const Blob& blob) { return blob.fullness() < min_fullness || blob.elongation() > largest_elongation; });
  if (blobs.empty()) {
    if (!all.empty()) refuse_glare(all[0]);
    std::string message = "no " + dot + " found";
    if (!all.empty()) message += ": nothing of this colour is round";
    const double clipped = clipped_fraction(picture);
    if (!white && clipped > over_exposed_picture)
      message += "; the picture is over-exposed: " + percent(clipped) + " of it is white";
    throw InvalidInput(message);
  }
  if (blobs.size() > 1 && blobs[1].area > rival_fraction * blobs[0].area)
    throw InvalidInput("two candidates for " + dot + ": at " + at_pixel(blobs[0].centre) + " and " +
                       at_pixel(blobs[1].centre) + "; cover one, or give another colour");
  // a dot that fills what is free of the margin leaves no ground
  const bool fills = blobs[0].box.width == picture.width - 2 * blur && blobs[0].box.height == picture.height - 2 * blur;
  if (blobs[0].touches_frame(picture, blur) || fills)
    throw InvalidInput(dot + " at " + at_pixel(blobs[0].centre) + " is partly outside the frame");
  refuse_glare(blobs[0]);
  return refined(picture, blobs[0], view);
}

}  // namespace softkin::vision
