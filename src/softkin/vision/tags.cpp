#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/aruco.hpp>
#include <softkin/core/error.hpp>
#include <softkin/vision/pixels.hpp>
#include <softkin/vision/tags.hpp>

namespace softkin::vision {

namespace {

constexpr double step = 0.5;           // along a profile [px]
constexpr double least_contrast = 25;  // of 255
constexpr double far_off = 0.5;        // of a line: on something else [px]
constexpr double end_share = 0.12;     // of an edge: left out at both ends, where blur rounds the corner

using Line = Eigen::Hyperplane<double, 2>;

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  const auto found = std::find(dictionaries().begin(), dictionaries().end(), name);
  if (found == dictionaries().end())
    throw InvalidInput("no dictionary '" + name + "'" + suggest_name(name, dictionaries()));
  return cv::aruco::getPredefinedDictionary(static_cast<int>(found - dictionaries().begin()));  // in OpenCV's order
}

/// Distance from the middle of a profile at which it passes the level upwards, nearest to the middle.
std::optional<double> passage(const cv::Mat1f& profile, double reach, double level) {
  std::optional<double> best;
  for (int i = 0; i + 1 < profile.cols; ++i) {
    if (!(profile(i) <= level && profile(i + 1) > level)) continue;
    const double s = -reach + step * (i + (level - profile(i)) / (profile(i + 1) - profile(i)));
    if (!best || std::abs(s) < std::abs(*best)) best = s;
  }
  return best;
}

/// An edge, distortion taken out.
std::optional<Line> edge_line(const cv::Mat& gray, const Vec2& from, const Vec2& to, const Vec2& middle, double module,
                              const std::optional<Camera>& camera) {
  const double length = (to - from).norm();
  Vec2 outwards = Vec2(to.y() - from.y(), from.x() - to.x()) / length;
  if (outwards.dot(middle - from) > 0) outwards = -outwards;
  const double depth = 2 * std::abs(outwards.dot(middle - from));  // of the square behind this edge
  const double reach = std::clamp(0.75 * module * depth, 1.5, 5.0);
  // profiles across the edge, from inside (dark) outwards
  cv::Mat1f profiles(std::clamp(static_cast<int>(length), 10, 60), static_cast<int>(2 * reach / step + 1e-9) + 1), mean;
  const auto place = [&](int i) {
    return Vec2(from + (end_share + (1 - 2 * end_share) * (i + 0.5) / profiles.rows) * (to - from));
  };
  for (int i = 0; i < profiles.rows; ++i)
    for (int k = 0; k < profiles.cols; ++k)
      profiles(i, k) = between<float>(gray, place(i) + (step * k - reach) * outwards);
  // darkest on the inner half and lightest on the outer half: ink and paper, also where the dark border and the margin
  // are hardly wider than the blur
  cv::reduce(profiles, mean, 0, cv::REDUCE_AVG);
  double dark = 0, light = 0;
  cv::minMaxLoc(mean.colRange(0, (mean.cols + 1) / 2), &dark, nullptr);
  cv::minMaxLoc(mean.colRange((mean.cols + 1) / 2, mean.cols), nullptr, &light);
  if (!(light - dark > least_contrast)) return std::nullopt;
  std::vector<cv::Point2f> points;
  for (int i = 0; i < profiles.rows; ++i)
    if (const auto s = passage(profiles.row(i), reach, (dark + light) / 2)) {
      const Vec2 seen = place(i) + *s * outwards, ideal = camera ? undistorted(*camera, seen) : seen;
      points.emplace_back(cv::Point2d(ideal.x(), ideal.y()));
    }
  cv::Vec4f line;
  for (int round = 0; round < 2; ++round) {
    if (points.size() < 5) return std::nullopt;
    cv::fitLine(points, line, cv::DIST_L2, 0, 0, 0);
    std::erase_if(points, [&](const cv::Point2f& p) {
      return std::abs((p.x - line[2]) * line[1] - (p.y - line[3]) * line[0]) > far_off;
    });
  }
  return Line(Vec2(line[1], -line[0]), Vec2(line[2], line[3]));
}

std::optional<std::array<Vec2, 4>> refined(const cv::Mat& gray, std::array<Vec2, 4> corners, double module,
                                           const std::optional<Camera>& camera) {
  std::array<Vec2, 4> ideal;
  for (int round = 0; round < 2; ++round) {
    const Vec2 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
    std::vector<Line> lines;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto line = edge_line(gray, corners[i], corners[(i + 1) % 4], middle, module, camera);
      if (!line) return std::nullopt;
      lines.push_back(*line);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      ideal[i] = lines[i].intersection(lines[(i + 3) % 4]);
      const Vec2 seen = camera ? distorted(*camera, ideal[i]) : ideal[i];
      // a corner that runs away is that of something else
      if (!((seen - corners[i]).norm() < 5)) return std::nullopt;
      corners[i] = seen;
    }
  }
  return ideal;
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
  return Line::Through(corners[0], corners[2]).intersection(Line::Through(corners[1], corners[3]));
}

std::vector<Tag> find_tags(const RgbImage& picture, const std::string& dictionary,
                           const std::optional<Camera>& camera) {
  const auto known = dictionary_of(dictionary);
  const cv::Ptr<cv::aruco::DetectorParameters> parameters = cv::aruco::DetectorParameters::create();
  // OpenCV's own refinement may jump to a corner of the pattern beside; refine_quad starts from the contour
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> numbers;
  const cv::Mat gray = gray_of(picture);
  cv::aruco::detectMarkers(gray, known, corners, numbers, parameters);
  std::vector<Tag> tags;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    std::array<Vec2, 4> rough;
    for (std::size_t k = 0; k < 4; ++k) rough[k] = Vec2(corners[i][k].x, corners[i][k].y);
    const auto corner = refined(gray, rough, 1.0 / (known->markerSize + 2), camera);
    if (corner) tags.push_back({numbers[i], *corner});
  }
  std::stable_sort(tags.begin(), tags.end(), [](const Tag& a, const Tag& b) { return a.number < b.number; });
  return tags;
}

std::optional<std::array<Vec2, 4>> refine_quad(const RgbImage& picture, const std::array<Vec2, 4>& corners,
                                               double module, const std::optional<Camera>& camera) {
  return refined(gray_of(picture), corners, module, camera);
}

}  // namespace softkin::vision
