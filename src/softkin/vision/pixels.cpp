#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/vision/pixels.hpp>
#include <tuple>

namespace softkin::vision {

namespace {

cv::Mat pixels_of(const cv::Mat& rgb, const Colour& colour) {
  cv::Mat hsv, result = cv::Mat::zeros(rgb.size(), CV_8U), round;
  cv::boxFilter(rgb, hsv, CV_32F, {3, 3});
  cv::cvtColor(hsv, hsv, cv::COLOR_RGB2HSV);
  for (const double turn : {-360.0, 0.0, 360.0}) {  // hues go round
    // no hue belongs to two colours
    cv::inRange(hsv, cv::Scalar(colour.low[0] + turn, colour.low[1], colour.low[2]),
                cv::Scalar(colour.high[0] + turn - 1e-4, colour.high[1], colour.high[2]), round);
    result |= round;
  }
  return result;
}

}  // namespace

cv::Mat3b mat_of(const RgbImage& picture) {
  return cv::Mat(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.bytes.data()));
}

cv::Mat gray_of(const RgbImage& picture) {
  cv::Mat gray;
  cv::cvtColor(mat_of(picture), gray, cv::COLOR_RGB2GRAY);
  return gray;
}

double Blob::fullness() const {
  return area / (4 * std::numbers::pi * std::sqrt(spread.determinant()));
}

double Blob::elongation() const {
  const Vec2 values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
  return std::sqrt(values[1] / values[0]);
}

bool Blob::touches_frame(const RgbImage& picture, int margin) const {
  return (box & cv::Rect(margin, margin, picture.width - 2 * margin, picture.height - 2 * margin)) != box;
}

std::vector<Blob> find_blobs(const RgbImage& picture, const Colour& colour, int least) {
  cv::Mat labels, centres;
  cv::Mat1i stats;
  const int count = cv::connectedComponentsWithStats(pixels_of(mat_of(picture), colour), labels, stats, centres);
  std::vector<Blob> blobs;
  for (int i = 1; i < count; ++i) {
    const int* s = stats[i];
    if (s[cv::CC_STAT_AREA] < least) continue;
    Blob blob;
    blob.box = {s[cv::CC_STAT_LEFT], s[cv::CC_STAT_TOP], s[cv::CC_STAT_WIDTH], s[cv::CC_STAT_HEIGHT]};
    blob.mask = labels(blob.box) == i;
    const cv::Moments moments = cv::moments(blob.mask, true);
    blob.area = moments.m00;
    blob.centre = Vec2(blob.box.x + moments.m10 / blob.area, blob.box.y + moments.m01 / blob.area);
    blob.spread << moments.mu20, moments.mu11, moments.mu11, moments.mu02;
    blob.spread /= blob.area;
    blob.spread.diagonal().array() += 1.0 / 12;  // a pixel is a square, not a point
    blobs.push_back(std::move(blob));
  }
  // std::stable_sort would move them through memory that is not aligned for their matrices
  std::sort(blobs.begin(), blobs.end(), [](const Blob& a, const Blob& b) {
    return std::tuple(-a.area, a.box.y, a.box.x) < std::tuple(-b.area, b.box.y, b.box.x);
  });
  return blobs;
}

}  // namespace softkin::vision
