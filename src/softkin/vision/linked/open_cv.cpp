#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <softkin/vision/open_cv.hpp>

namespace softkin::vision::opencv {

namespace {

RgbImage as_rgb(const cv::Mat& bgr) {
  RgbImage picture(bgr.cols, bgr.rows);
  cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, picture.bytes.data());
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return picture;
}

/// The same bytes.
cv::Mat mat_of(const GrayImage& picture) {
  return cv::Mat(picture.height, picture.width, CV_8U, const_cast<std::uint8_t*>(picture.bytes.data()));
}

Vec2 vec(const cv::Point2f& point) {
  return {point.x, point.y};
}

class LinkedVideo : public Video {
 public:
  explicit LinkedVideo(const cv::VideoCapture& capture) : capture_(capture) {
    rate_ = capture_.get(cv::CAP_PROP_FPS);
    frames_ = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  }

  std::optional<RgbImage> next() override {
    cv::Mat bgr;
    if (!capture_.read(bgr) || bgr.empty()) return std::nullopt;
    return as_rgb(bgr);
  }

 private:
  cv::VideoCapture capture_;
};

}  // namespace

void prepare(int threads) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // quiet; Film reports the errors of a video
  if (threads > 0) cv::setNumThreads(threads);
}

std::optional<RgbImage> decoded(const std::string& content) {
  cv::Mat bgr;
  try {
    bgr = cv::imdecode(cv::Mat(1, static_cast<int>(content.size()), CV_8U, const_cast<char*>(content.data())),
                       cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  if (bgr.empty()) return std::nullopt;
  return as_rgb(bgr);
}

std::unique_ptr<Video> open_video(const std::string& file) {
  cv::VideoCapture capture;
  try {
    capture.open(file);
  } catch (const cv::Exception&) {
    return nullptr;
  }
  return capture.isOpened() ? std::make_unique<LinkedVideo>(capture) : nullptr;
}

Dictionary dictionary(int number) {
  const auto tags = cv::aruco::getPredefinedDictionary(number);
  return {.size = tags->bytesList.rows, .modules = tags->markerSize};
}

std::vector<std::uint8_t> tag_squares(int dictionary, int tag) {
  const auto tags = cv::aruco::getPredefinedDictionary(dictionary);
  cv::Mat1b image;
  tags->drawMarker(tag, tags->markerSize + 2, image, 1);
  return {image.begin(), image.end()};
}

std::vector<RoughTag> find_tags(const GrayImage& picture, int dictionary) {
  const cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
  // OpenCV's own refinement may jump to a corner of the pattern beside; refine_quad starts from the contour
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> numbers;
  cv::aruco::detectMarkers(mat_of(picture), cv::aruco::getPredefinedDictionary(dictionary), corners, numbers,
                           parameters);
  std::vector<RoughTag> tags(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    tags[i].number = numbers[i];
    std::transform(corners[i].begin(), corners[i].begin() + 4, tags[i].corners.begin(), vec);
  }
  return tags;
}

std::optional<std::vector<Vec2>> chessboard(const GrayImage& picture, int columns, int rows) {
  std::vector<cv::Point2f> corners;
  if (!cv::findChessboardCornersSB(mat_of(picture), cv::Size(columns, rows), corners, cv::CALIB_CB_ACCURACY))
    return std::nullopt;
  std::vector<Vec2> result(corners.size());
  std::transform(corners.begin(), corners.end(), result.begin(), vec);
  return result;
}

std::vector<Vec2> crossings(const GrayImage& picture, const std::vector<Vec2>& rough, int reach) {
  std::vector<cv::Point2f> corners;
  for (const Vec2& place : rough) corners.emplace_back(cv::Point2d(place.x(), place.y()));
  cv::cornerSubPix(mat_of(picture), corners, cv::Size(reach, reach), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 50, 1e-3));
  std::vector<Vec2> result(corners.size());
  std::transform(corners.begin(), corners.end(), result.begin(), vec);
  return result;
}

std::optional<Fit> calibrated(const std::vector<BoardSight>& sights, int width, int height) {
  std::vector<std::vector<cv::Point3f>> places(sights.size());
  std::vector<std::vector<cv::Point2f>> pixels(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i)
    for (const PlanePoint& point : sights[i].points) {
      places[i].emplace_back(cv::Point3d(point.place.x(), point.place.y(), 0));
      pixels[i].emplace_back(cv::Point2d(point.pixel.x(), point.pixel.y()));
    }
  cv::Matx33d matrix;
  cv::Vec<double, 5> lens;
  cv::Mat turns, shifts, spread, spread_outside;
  Fit fit;
  try {
    fit.reprojection_error = cv::calibrateCamera(places, pixels, cv::Size(width, height), matrix, lens, turns, shifts,
                                                 spread, spread_outside, fit.errors, cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  fit.matrix = {matrix(0, 0), matrix(1, 1), matrix(0, 2), matrix(1, 2)};
  fit.lens = {lens[0], lens[1], lens[2], lens[3]};
  fit.focal_errors = {spread.at<double>(0), spread.at<double>(1)};
  for (int i = 0; i < turns.rows; ++i) {
    const cv::Vec3d& turn = turns.at<cv::Vec3d>(i);
    fit.rotations.push_back({turn[0], turn[1], turn[2]});
  }
  return fit;
}

}  // namespace softkin::vision::opencv
