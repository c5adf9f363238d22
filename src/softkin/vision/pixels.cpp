#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/core/dense.hpp>
#include <softkin/vision/pixels.hpp>
#include <tuple>
#include <utility>

namespace softkin::vision {

namespace {

bool has_colour(const std::array<float, 3>& rgb, const Colour& colour) {
  const auto [hue, saturation, value] = hsv_of(rgb);
  if (saturation < colour.low[1] || saturation > colour.high[1] || value < colour.low[2] || value > colour.high[2])
    return false;
  for (const double turn : {-360.0, 0.0, 360.0})  // hues go round
    // no hue belongs to two colours
    if (hue >= colour.low[0] + turn && hue <= colour.high[0] + turn - 1e-4) return true;
  return false;
}

/// Of numbers from 0 to last, beyond which the picture is mirrored about its outermost pixels.
int mirrored(int i, int last) {
  return i < 0 ? -i : i > last ? 2 * last - i : i;
}

/// Which pixels have the colour in the mean of 3 x 3.
GrayImage pixels_of(const RgbImage& picture, const Colour& colour) {
  const int width = picture.width, height = picture.height;
  GrayImage result{width, height, std::vector<std::uint8_t>(std::size_t(width) * std::size_t(height))};
  std::vector<std::array<int, 3>> columns(width);  // sums of three pixels
  for (int y = 0; y < height; ++y) {
    const auto row = [&](int number) {
      return picture.bytes.data() + std::size_t(mirrored(number, height - 1)) * std::size_t(width) * 3;
    };
    const std::uint8_t *above = row(y - 1), *here = row(y), *below = row(y + 1);
    for (std::size_t i = 0; i < columns.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) columns[i][c] = above[3 * i + c] + here[3 * i + c] + below[3 * i + c];
    for (int x = 0; x < width; ++x) {
      const auto &left = columns[std::size_t(mirrored(x - 1, width - 1))], &middle = columns[std::size_t(x)],
                 &right = columns[std::size_t(mirrored(x + 1, width - 1))];
      std::array<float, 3> mean;
      for (std::size_t c = 0; c < 3; ++c) mean[c] = static_cast<float>(left[c] + middle[c] + right[c]) / 9;
      result.bytes[std::size_t(y) * std::size_t(width) + std::size_t(x)] = has_colour(mean, colour) ? 1 : 0;
    }
  }
  return result;
}

/// Takes the pixels that hang together with a first one out of the mask.
std::vector<std::pair<int, int>> taken_out(GrayImage& mask, int x, int y) {
  const auto take = [&mask](int i, int j) {
    return std::exchange(mask.bytes[std::size_t(j) * std::size_t(mask.width) + std::size_t(i)], std::uint8_t{0}) != 0;
  };
  std::vector<std::pair<int, int>> pixels;
  if (take(x, y)) pixels.emplace_back(x, y);
  for (std::size_t next = 0; next < pixels.size(); ++next) {
    const auto [u, v] = pixels[next];
    for (int j = std::max(v - 1, 0); j <= std::min(v + 1, mask.height - 1); ++j)
      for (int i = std::max(u - 1, 0); i <= std::min(u + 1, mask.width - 1); ++i)
        if (take(i, j)) pixels.emplace_back(i, j);
  }
  return pixels;
}

Blob blob_of(const std::vector<std::pair<int, int>>& pixels) {
  int left = pixels[0].first, right = left, top = pixels[0].second, bottom = top;
  for (const auto& [x, y] : pixels) {
    left = std::min(left, x), right = std::max(right, x);
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  Blob blob;
  blob.box = {left, top, right - left + 1, bottom - top + 1};
  blob.mask = {blob.box.width, blob.box.height,
               std::vector<std::uint8_t>(std::size_t(blob.box.width) * std::size_t(blob.box.height))};
  blob.area = static_cast<double>(pixels.size());
  Vec2 sum = Vec2::Zero();  // from the corner of the box
  for (const auto& [x, y] : pixels) {
    sum += Vec2(x - left, y - top);
    blob.mask.bytes[std::size_t(y - top) * std::size_t(blob.box.width) + std::size_t(x - left)] = 255;
  }
  const Vec2 middle = sum / blob.area;
  blob.centre = middle + Vec2(left, top);
  for (const auto& [x, y] : pixels) {
    const Vec2 arm = Vec2(x - left, y - top) - middle;
    blob.spread += arm * arm.transpose();
  }
  blob.spread /= blob.area;
  blob.spread.diagonal().array() += 1.0 / 12;  // a pixel is a square, not a point
  return blob;
}

/// The four pixels around a place, and the weights of the farther ones.
struct Corner {
  int x0, y0, x1, y1;
  double right, down;

  Corner(const Vec2& pixel, int width, int height) {
    const double x = std::max(0.0, std::min(width - 1.0, pixel.x())),
                 y = std::max(0.0, std::min(height - 1.0, pixel.y()));
    x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
    right = x - x0, down = y - y0;
  }

  template <class Value>
  [[nodiscard]] auto mixed(const Value& value) const {
    return ((1 - down) * ((1 - right) * value(x0, y0) + right * value(x1, y0)) +
            down * ((1 - right) * value(x0, y1) + right * value(x1, y1)))
        .eval();
  }
};

}  // namespace

PixelBox shared_part(const PixelBox& a, const PixelBox& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  const int width = std::min(a.x + a.width, b.x + b.width) - x, height = std::min(a.y + a.height, b.y + b.height) - y;
  return width > 0 && height > 0 ? PixelBox{x, y, width, height} : PixelBox{};
}

GrayImage gray_of(const RgbImage& picture) {
  GrayImage gray{picture.width, picture.height, std::vector<std::uint8_t>(picture.bytes.size() / 3)};
  for (std::size_t i = 0; i < gray.bytes.size(); ++i) {  // 0.299, 0.587 and 0.114 in units of 2^-15
    const std::uint8_t* rgb = picture.bytes.data() + 3 * i;
    gray.bytes[i] = static_cast<std::uint8_t>((9798 * rgb[0] + 19235 * rgb[1] + 3735 * rgb[2] + (1 << 14)) >> 15);
  }
  return gray;
}

std::array<float, 3> hsv_of(const std::array<float, 3>& rgb) {
  const auto [red, green, blue] = rgb;
  const float value = std::max({red, green, blue}), spread = value - std::min({red, green, blue});
  if (!(spread > 0)) return {0, 0, value};
  const float hue = value == red     ? (green - blue) / spread
                    : value == green ? (blue - red) / spread + 2
                                     : (red - green) / spread + 4;
  return {60 * (hue < 0 ? hue + 6 : hue), spread / value, value};
}

Eigen::Vector3d between(const RgbImage& picture, const Vec2& pixel) {
  return Corner(pixel, picture.width, picture.height).mixed([&picture](int x, int y) -> Eigen::Vector3d {
    const std::uint8_t* rgb = picture.bytes.data() + 3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x));
    return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
  });
}

double between(const GrayImage& picture, const Vec2& pixel) {
  using One = Eigen::Matrix<double, 1, 1>;
  return Corner(pixel, picture.width, picture.height).mixed([&picture](int x, int y) -> One {
    return One(double(picture.at(x, y)));
  })[0];
}

double Blob::fullness() const {
  return area / (4 * std::numbers::pi * std::sqrt(spread.determinant()));
}

double Blob::elongation() const {
  const Vec2 values = symmetric_eigenvalues(spread);
  return std::sqrt(values[1] / values[0]);
}

bool Blob::touches_frame(const RgbImage& picture, int margin) const {
  return shared_part(box, {margin, margin, picture.width - 2 * margin, picture.height - 2 * margin}) != box;
}

std::vector<Blob> find_blobs(const RgbImage& picture, const Colour& colour, int least) {
  return find_blobs(pixels_of(picture, colour), least);
}

std::vector<Blob> find_blobs(GrayImage mask, int least) {
  std::vector<Blob> blobs;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (mask.at(x, y) == 0) continue;
      const std::vector<std::pair<int, int>> pixels = taken_out(mask, x, y);
      if (static_cast<int>(pixels.size()) >= least) blobs.push_back(blob_of(pixels));
    }
  // std::stable_sort would move them through memory that is not aligned for their matrices
  std::sort(blobs.begin(), blobs.end(), [](const Blob& a, const Blob& b) {
    return std::tuple(-a.area, a.box.y, a.box.x) < std::tuple(-b.area, b.box.y, b.box.x);
  });
  return blobs;
}

}  // namespace softkin::vision
