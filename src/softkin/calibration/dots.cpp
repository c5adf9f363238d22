#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <softkin/calibration/blobs.hpp>
#include <softkin/calibration/dots.hpp>
#include <softkin/core/error.hpp>

namespace softkin {

namespace {

constexpr std::size_t least_area = 20;        // [px]: a diameter of 5
constexpr double least_fullness = 0.88;       // a half disc has 0.95
constexpr double largest_elongation = 3;      // a disc seen at 70 degrees
constexpr double rival_share = 0.3;           // of the largest dot's area: smaller ones are dirt
constexpr int blur = 4;                       // the edge of a dot fades within so many pixels
constexpr int ring = 4;                       // width of the ground looked at around it [px]
constexpr double most_glare = 0.02;           // of a dot's inner pixels
constexpr double most_white = 0.7;            // more of it: a ring on paper, not a highlight on a dot
constexpr double over_exposed_picture = 0.3;  // share of clipped pixels that explains a missing dot

using Rgb3 = Eigen::Vector3d;

Rgb3 colour_at(const RgbImage& picture, int x, int y) {
  const std::uint8_t* bytes = picture.bytes.data() + 3 * (std::size_t(y) * picture.width + x);
  return {double(bytes[0]), double(bytes[1]), double(bytes[2])};
}

std::string at_pixel(const Vec2& place) {
  return "(" + std::to_string(std::lround(place.x())) + ", " + std::to_string(std::lround(place.y())) + ")";
}

std::string percent(double share) {
  return std::to_string(std::lround(100 * share)) + " %";
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A pixel around the dot, and how far outside of it (Chebyshev distance; 0: inside).
struct Near {
  int x, y, distance;
};

std::vector<Near> neighbourhood(const Blob& blob, int width, int height) {
  const int reach = blur + ring, left = blob.left - reach, top = blob.top - reach;
  const int columns = blob.right - blob.left + 2 * reach + 1, rows = blob.bottom - blob.top + 2 * reach + 1;
  std::vector<int> distance(std::size_t(columns) * rows, reach + 1);
  for (const int pixel : blob.pixels) {
    const int x = pixel % width - left, y = pixel / width - top;
    distance[std::size_t(y) * columns + x] = 0;
  }
  for (int step = 0; step < reach; ++step)
    for (int y = 1; y + 1 < rows; ++y)
      for (int x = 1; x + 1 < columns; ++x) {
        int& here = distance[std::size_t(y) * columns + x];
        if (here <= step) continue;
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i)
            if (distance[std::size_t(y + j) * columns + x + i] == step) here = step + 1;
      }
  std::vector<Near> result;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const int d = distance[std::size_t(y) * columns + x];
      if (d > reach || x + left < 0 || y + top < 0 || x + left >= width || y + top >= height) continue;
      result.push_back({x + left, y + top, d});
    }
  return result;
}

/// Colour of the ground as a linear function of the place: lighting is never even.
class Ground {
 public:
  Ground(const RgbImage& picture, const std::vector<Near>& near, const Vec2& centre) : centre_(centre) {
    std::vector<const Near*> used;
    for (const Near& pixel : near)
      if (pixel.distance > blur) used.push_back(&pixel);
    const std::vector<const Near*> all = used;
    std::array<std::vector<double>, 3> values;
    for (const Near* pixel : all)
      for (int c = 0; c < 3; ++c) values[std::size_t(c)].push_back(colour_at(picture, pixel->x, pixel->y)[c]);
    Rgb3 middle, width;
    for (int c = 0; c < 3; ++c) {
      std::vector<double>& list = values[std::size_t(c)];
      middle[c] = median(list);
      for (double& value : list) value = std::abs(value - middle[c]);
      width[c] = 3 * std::max(3.0, 1.4826 * median(list)) + 6;
    }
    // what else lies there, another marker or an edge, is no ground
    std::erase_if(used, [&](const Near* pixel) {
      return ((colour_at(picture, pixel->x, pixel->y) - middle).cwiseAbs().array() > width.array()).any();
    });
    fit(picture, used);
  }

  [[nodiscard]] Rgb3 at(int x, int y) const {
    return fit_.transpose() * Eigen::Vector3d(1, x - centre_.x(), y - centre_.y());
  }
  /// Covariance of its noise.
  [[nodiscard]] const Eigen::Matrix3d& noise() const { return noise_; }

 private:
  void fit(const RgbImage& picture, const std::vector<const Near*>& used) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-9, right = Eigen::Matrix3d::Zero();
    for (const Near* pixel : used) {
      const Eigen::Vector3d row(1, pixel->x - centre_.x(), pixel->y - centre_.y());
      normal += row * row.transpose();
      right += row * colour_at(picture, pixel->x, pixel->y).transpose();
    }
    fit_ = normal.inverse() * right;
    noise_.setZero();
    for (const Near* pixel : used) {
      const Rgb3 miss = colour_at(picture, pixel->x, pixel->y) - at(pixel->x, pixel->y);
      noise_ += miss * miss.transpose() / static_cast<double>(used.size());
    }
    noise_.diagonal().array() += 1.0 / 12;  // whole numbers
  }

  Vec2 centre_;
  Eigen::Matrix3d fit_, noise_ = Eigen::Matrix3d::Zero();
};

/// Median colour of the pixels in the middle, where no ground shines through.
Rgb3 core_colour(const RgbImage& picture, const Blob& blob) {
  const Eigen::Matrix2d inverse = blob.spread.inverse();
  std::array<std::vector<double>, 3> values;
  // the edge of an ellipse is at 4; a ring has no pixel within 1
  for (const double within : {1.0, 100.0}) {
    if (!values[0].empty()) break;
    for (const int pixel : blob.pixels) {
      const Vec2 arm = Vec2(pixel % picture.width, pixel / picture.width) - blob.centre;
      if (arm.dot(inverse * arm) > within) continue;
      const Rgb3 colour = colour_at(picture, pixel % picture.width, pixel / picture.width);
      for (int c = 0; c < 3; ++c) values[std::size_t(c)].push_back(colour[c]);
    }
  }
  return {median(values[0]), median(values[1]), median(values[2])};
}

MarkerPlace refined(const RgbImage& picture, const Blob& blob, const PlaneView& view) {
  const std::vector<Near> near = neighbourhood(blob, picture.width, picture.height);
  const Ground ground(picture, near, blob.centre);
  const Rgb3 core = core_colour(picture, blob);
  const Rgb3 contrast = core - ground.at(int(std::lround(blob.centre.x())), int(std::lround(blob.centre.y())));
  const double size = contrast.squaredNorm();
  double sum = 0;
  Vec2 moment = Vec2::Zero();
  struct Weighed {
    Vec2 place;
    double area;
  };
  std::vector<Weighed> weighed;
  for (const Near& pixel : near) {
    if (pixel.distance > blur) continue;
    const Vec2 seen(pixel.x, pixel.y);
    const double share = (colour_at(picture, pixel.x, pixel.y) - ground.at(pixel.x, pixel.y)).dot(contrast) / size;
    weighed.push_back({view.to_mm(seen), view.pixel_area(seen)});
    sum += share * weighed.back().area;
    moment += share * weighed.back().area * weighed.back().place;
  }
  MarkerPlace result;
  result.place = moment / sum;
  const double noise = contrast.dot(ground.noise() * contrast) / (size * size);  // variance of a pixel's share
  double variance = 0;
  for (const Weighed& each : weighed)
    variance += noise * each.area * each.area * (each.place - result.place).squaredNorm() / 2 / (sum * sum);
  result.pixel = view.to_pixel(result.place);
  result.error = std::hypot(std::sqrt(variance), pixel_error * std::sqrt(view.pixel_area(result.pixel)),
                            view.error_at(result.pixel));
  return result;
}

/// Share of the inner dot that is nearer to white than to the dot's colour: a highlight, which moves the centre.
double glare(const RgbImage& picture, const Blob& blob) {
  const Eigen::Matrix2d inverse = blob.spread.inverse();
  const double white = (core_colour(picture, blob).minCoeff() + 255) / 2;
  double bright = 0, all = 0;
  for (int y = blob.top; y <= blob.bottom; ++y)
    for (int x = blob.left; x <= blob.right; ++x) {
      const Vec2 arm = Vec2(x, y) - blob.centre;
      if (arm.dot(inverse * arm) > 1.5) continue;  // farther out the ground shines through
      all += 1;
      bright += colour_at(picture, x, y).minCoeff() > white;
    }
  return all > 0 ? bright / all : 0;
}

}  // namespace

MarkerPlace find_dot(const RgbImage& picture, const Colour& colour, const PlaneView& view, const std::string& name) {
  const std::string dot = name == colour.name() ? "dot '" + name + "'" : colour.name() + " dot '" + name + "'";
  std::vector<Blob> blobs = find_blobs(pixels_of(colour, picture), picture.width, least_area);
  const bool white = colour.name() == "white";
  const auto refuse_glare = [&](const Blob& blob) {
    const double share = white || blob.elongation() > largest_elongation ? 0 : glare(picture, blob);
    if (share > most_glare && share < most_white)
      throw InvalidInput(percent(share) + " of " + dot + " at " + at_pixel(blob.centre) +
                         " is white: it is over-exposed, has a highlight, or is not a full dot");
  };
  const std::vector<Blob> all = blobs;
  std::erase_if(blobs, [](const Blob& blob) {
    return blob.fullness() < least_fullness || blob.elongation() > largest_elongation;
  });
  if (blobs.empty()) {
    if (!all.empty()) refuse_glare(all[0]);
    std::string message = "no " + dot + " found";
    if (!all.empty()) message += ": nothing of this colour is round";
    const double clipped = clipped_share(picture);
    if (!white && clipped > over_exposed_picture)
      message += "; the picture is over-exposed: " + percent(clipped) + " of it is white";
    throw InvalidInput(message);
  }
  if (blobs.size() > 1 && blobs[1].area() > rival_share * blobs[0].area())
    throw InvalidInput("two candidates for " + dot + ": at " + at_pixel(blobs[0].centre) + " and " +
                       at_pixel(blobs[1].centre) + "; cover one, or give another colour");
  if (blobs[0].touches_frame(picture.width, picture.height, blur))
    throw InvalidInput(dot + " at " + at_pixel(blobs[0].centre) + " is partly outside the frame");
  refuse_glare(blobs[0]);
  return refined(picture, blobs[0], view);
}

}  // namespace softkin
