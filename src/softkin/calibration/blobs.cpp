#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <softkin/calibration/blobs.hpp>

namespace softkin {

namespace {

/// All pixels of the mask that hang together with this one; takes them out of the mask.
std::vector<int> flood(std::vector<std::uint8_t>& mask, int width, int height, int first) {
  std::vector<int> pixels{first};
  mask[static_cast<std::size_t>(first)] = 0;
  for (std::size_t next = 0; next < pixels.size(); ++next) {
    const int x = pixels[next] % width, y = pixels[next] / width;
    for (int j = std::max(0, y - 1); j <= std::min(height - 1, y + 1); ++j)
      for (int i = std::max(0, x - 1); i <= std::min(width - 1, x + 1); ++i) {
        const int pixel = j * width + i;
        if (mask[static_cast<std::size_t>(pixel)] == 0) continue;
        mask[static_cast<std::size_t>(pixel)] = 0;
        pixels.push_back(pixel);
      }
  }
  return pixels;
}

Blob measured(std::vector<int> pixels, int width) {
  Blob blob;
  blob.left = blob.top = std::numeric_limits<int>::max();
  for (const int pixel : pixels) {
    const int x = pixel % width, y = pixel / width;
    blob.left = std::min(blob.left, x);
    blob.right = std::max(blob.right, x);
    blob.top = std::min(blob.top, y);
    blob.bottom = std::max(blob.bottom, y);
    blob.centre += Vec2(x, y);
  }
  const double count = static_cast<double>(pixels.size());
  blob.centre /= count;
  for (const int pixel : pixels) {
    const Vec2 arm = Vec2(pixel % width, pixel / width) - blob.centre;
    blob.spread += arm * arm.transpose() / count;
  }
  blob.spread.diagonal().array() += 1.0 / 12;  // a pixel is a square, not a point
  blob.pixels = std::move(pixels);
  return blob;
}

}  // namespace

double Blob::fullness() const {
  return area() / (4 * std::numbers::pi * std::sqrt(spread.determinant()));
}

double Blob::elongation() const {
  const Vec2 values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
  return std::sqrt(values[1] / values[0]);
}

bool Blob::touches_frame(int width, int height, int margin) const {
  return left < margin || top < margin || right >= width - margin || bottom >= height - margin;
}

std::vector<Blob> find_blobs(const std::vector<std::uint8_t>& mask, int width, std::size_t least) {
  std::vector<std::uint8_t> rest = mask;
  const int height = static_cast<int>(mask.size()) / width;
  std::vector<Blob> blobs;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] == 0) continue;
    std::vector<int> pixels = flood(rest, width, height, static_cast<int>(i));
    if (pixels.size() >= least) blobs.push_back(measured(std::move(pixels), width));
  }
  // std::stable_sort would move them through memory that is not aligned for their matrices
  std::sort(blobs.begin(), blobs.end(), [](const Blob& a, const Blob& b) {
    return a.area() != b.area() ? a.area() > b.area() : a.pixels[0] < b.pixels[0];
  });
  return blobs;
}

}  // namespace softkin
