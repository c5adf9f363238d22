#include <opencv2/imgproc.hpp>
#include <softkin/vision/gray.hpp>

namespace softkin {

cv::Mat gray_of(const RgbImage& picture) {
  const cv::Mat rgb(picture.height, picture.width, CV_8UC3, const_cast<std::uint8_t*>(picture.bytes.data()));
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

}  // namespace softkin
