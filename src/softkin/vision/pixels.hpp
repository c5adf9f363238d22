#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/pictures.hpp>

// Pictures as OpenCV has them: for sources of this room only.
namespace softkin::vision {

/// The same bytes as a matrix: red, green, blue, 8 bits each.
[[nodiscard]] cv::Mat3b mat_of(const RgbImage& picture);

/// Brightness, 8 bits.
[[nodiscard]] cv::Mat gray_of(const RgbImage& picture);

/// Value between the pixels, beyond the frame that of the nearest. Exact, where cv::remap goes by 1/32 pixel.
template <class Value>
[[nodiscard]] Value between(const cv::Mat& picture, const Vec2& pixel) {
  cv::Mat_<Value> patch;
  cv::getRectSubPix(picture, {1, 1}, cv::Point2d(pixel.x(), pixel.y()), patch, CV_32F);
  return patch(0);
}

/// Pixels of a colour that hang together, corners counting as contact.
struct Blob {
  cv::Rect box;                                      // [px]
  cv::Mat mask;                                      // of the box, 8 bits: its pixels are not 0
  double area = 0;                                   // [px]
  Vec2 centre = Vec2::Zero();                        // of mass [px]
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // covariance of its pixels [px^2]

  /// Its area by that of the ellipse of the same covariance: 1 for an ellipse, 0.95 for a rectangle, less where it is
  /// hollow or ragged.
  [[nodiscard]] double fullness() const;
  /// Longest by shortest axis, >= 1.
  [[nodiscard]] double elongation() const;
  /// Does it come nearer than so many pixels to the frame?
  [[nodiscard]] bool touches_frame(const RgbImage& picture, int margin) const;
};

/// Blobs of a colour, of at least so many pixels, the largest first. Each pixel is judged by the mean of its 3 x 3
/// neighbourhood, so that noise makes no specks.
[[nodiscard]] std::vector<Blob> find_blobs(const RgbImage& picture, const Colour& colour, int least);

}  // namespace softkin::vision
