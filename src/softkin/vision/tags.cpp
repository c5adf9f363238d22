#include <algorithm>
#include <opencv2/aruco.hpp>
#include <opencv2/imgproc.hpp>
#include <softkin/calibration/quad_edges.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/gray.hpp>
#include <softkin/vision/tags.hpp>

namespace softkin {

namespace {

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  const auto found = std::find(dictionaries().begin(), dictionaries().end(), name);
  if (found == dictionaries().end())
    throw InvalidInput("no dictionary '" + name + "'" + suggest_name(name, dictionaries()));
  return cv::aruco::getPredefinedDictionary(static_cast<int>(found - dictionaries().begin()));  // in OpenCV's order
}

}  // namespace

const std::vector<std::string>& dictionaries() {
  static const std::vector<std::string> names{"4x4_50",  "4x4_100",  "4x4_250", "4x4_1000", "5x5_50",  "5x5_100",
                                              "5x5_250", "5x5_1000", "6x6_50",  "6x6_100",  "6x6_250", "6x6_1000",
                                              "7x7_50",  "7x7_100",  "7x7_250", "7x7_1000", "original"};
  return names;
}

int dictionary_size(const std::string& dictionary) {
  return dictionary_of(dictionary)->bytesList.rows;
}

std::vector<std::vector<int>> tag_squares(const std::string& dictionary, int number) {
  const auto tags = dictionary_of(dictionary);
  if (number < 0 || number >= tags->bytesList.rows)
    throw InvalidInput("dictionary " + dictionary + " has tags 0 to " + std::to_string(tags->bytesList.rows - 1) +
                       ", no tag " + std::to_string(number));
  const int side = tags->markerSize + 2;
  cv::Mat image;
  tags->drawMarker(number, side, image, 1);
  std::vector<std::vector<int>> squares(static_cast<std::size_t>(side));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) squares[std::size_t(y)].push_back(image.at<std::uint8_t>(y, x) < 128);
  return squares;
}

Vec2 Tag::centre() const {
  return crossing(corners[0], corners[2], corners[1], corners[3]);
}

std::vector<Tag> find_tags(const RgbImage& picture, const std::string& dictionary,
                           const std::optional<Camera>& camera) {
  const auto known = dictionary_of(dictionary);
  const cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
  // OpenCV's own refinement may jump to a corner of the pattern beside; refine_quad starts from the contour
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> numbers;
  cv::aruco::detectMarkers(gray_of(picture), known, corners, numbers, parameters);
  std::vector<Tag> tags;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::array<Vec2, 4> rough;
    for (std::size_t k = 0; k < 4; ++k) rough[k] = Vec2(corners[i][k].x, corners[i][k].y);
    const auto corner = refine_quad(picture, rough, 1.0 / (known->markerSize + 2), camera);
    if (corner) tags.push_back({numbers[i], *corner});
  }
  std::stable_sort(tags.begin(), tags.end(), [](const Tag& a, const Tag& b) { return a.number < b.number; });
  return tags;
}

}  // namespace softkin
