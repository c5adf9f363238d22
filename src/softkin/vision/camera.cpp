#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/vision/camera.hpp>
#include <sstream>
#include <utility>

namespace softkin::vision {

namespace {

constexpr std::size_t least_pictures = 4;
constexpr double most_focal_error = 0.03;  // of the focal length
constexpr double least_tilt = 0.2;         // between two boards [rad]: seen straight, near and small is far and large

using Points = std::vector<cv::Point2d>;

cv::Matx33d matrix_of(const Camera& camera) {
  return {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
}

cv::Vec<double, 5> lens_of(const Camera& camera) {
  return {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
}

/// Largest angle between the planes of two of the boards [rad].
double tilt_between(const cv::Mat& turns) {
  std::vector<cv::Vec3d> normals;
  for (int i = 0; i < turns.rows; ++i) {
    cv::Matx33d frame;
    cv::Rodrigues(turns.at<cv::Vec3d>(i), frame);
    normals.emplace_back(frame(0, 2), frame(1, 2), frame(2, 2));
  }
  double least = 1;
  for (const cv::Vec3d& a : normals)
    for (const cv::Vec3d& b : normals) least = std::min(least, a.dot(b));
  return std::acos(std::max(-1.0, least));
}

using scene::Node;

/// A number in the file, its range and where it belongs.
struct Key {
  std::string name;
  double low, high;
  double* value;
};

struct Group {
  std::string name;
  std::vector<Key> keys;
  bool given = false;
};

/// The file's groups. whole: width, height and number of pictures.
std::vector<Group> groups_of(Camera& camera, std::array<double, 3>& whole) {
  return {{"picture", {{"width", 16, 1e5, &whole[0]}, {"height", 16, 1e5, &whole[1]}}},
          {"matrix",
           {{"fx", 1, 1e7, &camera.fx},
            {"fy", 1, 1e7, &camera.fy},
            {"cx", -1e6, 1e6, &camera.cx},
            {"cy", -1e6, 1e6, &camera.cy}}},
          {"distortion",
           {{"k1", -100, 100, &camera.k1},
            {"k2", -1e4, 1e4, &camera.k2},
            {"p1", -1, 1, &camera.p1},
            {"p2", -1, 1, &camera.p2},
            {"k3", -1e6, 1e6, &camera.k3}}},
          {"quality",
           {{"reprojection_error", 0, 1e6, &camera.reprojection_error},
            {"focal_error", 0, 1e7, &camera.focal_error},
            {"pictures", 0, 1e6, &whole[2]}}}};
}

void read_number(const Node& node, const Key& key) {
  if (node.kind == Node::Kind::scalar && node.plain && parse_real(node.text, *key.value) && *key.value >= key.low &&
      *key.value <= key.high)
    return;
  std::ostringstream message;
  message << node.name << " must be a number from " << key.low << " to " << key.high;
  throw InvalidInput(node.origin, message.str());
}

/// The one of this name. Throws InvalidInput where there is none.
template <class Named>
Named& named(std::vector<Named>& known, const Node::Entry& entry) {
  std::vector<std::string> names;
  for (Named& each : known) {
    if (each.name == entry.key) return each;
    names.push_back(each.name);
  }
  throw InvalidInput(entry.origin, "unknown key '" + entry.key + "'" + suggest_name(entry.key, names));
}

void read_group(const Node& node, std::vector<Key>& keys) {
  if (node.kind != Node::Kind::map) throw InvalidInput(node.origin, node.name + " must be a map of numbers");
  for (const Key& key : keys) *key.value = NAN;
  for (const Node::Entry& entry : node.entries) read_number(*entry.value, named(keys, entry));
  for (const Key& key : keys)
    if (std::isnan(*key.value)) throw InvalidInput(node.origin, "'" + key.name + "' is missing in " + node.name);
}

void check_folding(const Camera& camera, const std::string& file) {
  for (int i = 0; i <= 16; ++i)
    for (int j = 0; j <= 16; ++j) {
      const Vec2 seen(i / 16.0 * (camera.width - 1), j / 16.0 * (camera.height - 1));
      if (!((distorted(camera, undistorted(camera, seen)) - seen).norm() < 1e-3))
        throw InvalidInput({file},
                           "the distortion folds the picture over itself near a corner; take pictures of the "
                           "board nearer to the corners and find the camera again");
    }
}

using Map = Eigen::Matrix3d;

Vec2 mapped(const Map& map, const Vec2& point) {
  return (map * point.homogeneous()).hnormalized();
}

/// Derivative of the map's value by its first 8 entries, the ninth being 1.
Eigen::Matrix<double, 2, 8> by_entries(const Map& map, const Vec2& point) {
  const double w = map.row(2).dot(point.homogeneous());
  const Vec2 value = mapped(map, point);
  Eigen::Matrix<double, 2, 8> result;
  result << point.x(), point.y(), 1, 0, 0, 0, -value.x() * point.x(), -value.x() * point.y(),  //
      0, 0, 0, point.x(), point.y(), 1, -value.y() * point.x(), -value.y() * point.y();
  return result / w;
}

/// To the last digits of single precision, which OpenCV computes it in.
Map first_guess(const std::vector<PlanePoint>& points) {
  std::vector<cv::Point2d> places, pixels;
  for (const PlanePoint& point : points) {
    places.emplace_back(point.place.x(), point.place.y());
    pixels.emplace_back(point.pixel.x(), point.pixel.y());
  }
  Map result = Map::Constant(NAN);
  if (const cv::Mat map = cv::findHomography(places, pixels); !map.empty()) cv::cv2eigen(map, result);
  return result;
}

}  // namespace

Vec2 distorted(const Camera& camera, const Vec2& ideal) {
  const std::vector<cv::Point3d> ray{{(ideal.x() - camera.cx) / camera.fx, (ideal.y() - camera.cy) / camera.fy, 1}};
  Points seen;
  cv::projectPoints(ray, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), lens_of(camera), seen);
  return {seen[0].x, seen[0].y};
}

Vec2 undistorted(const Camera& camera, const Vec2& seen) {
  Points ideal;
  cv::undistortPoints(Points{{seen.x(), seen.y()}}, ideal, matrix_of(camera), lens_of(camera), cv::noArray(),
                      matrix_of(camera), cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-11));
  return {ideal[0].x, ideal[0].y};
}

Camera fit_camera(const std::vector<BoardSight>& sights, int width, int height, std::vector<double>& errors) {
  if (sights.size() < least_pictures)
    throw InvalidInput("a camera is found from " + std::to_string(least_pictures) +
                       " pictures of the board or more, better 10 to 20 under different angles");
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
  Camera camera{.width = width, .height = height, .pictures = static_cast<int>(sights.size())};
  try {
    camera.reprojection_error = cv::calibrateCamera(places, pixels, cv::Size(width, height), matrix, lens, turns,
                                                    shifts, spread, spread_outside, errors, cv::CALIB_FIX_K3);
  } catch (const cv::Exception&) {
    throw InvalidInput("no camera fits these pictures; is the board flat, and are they all from one camera?");
  }
  camera.fx = matrix(0, 0), camera.fy = matrix(1, 1), camera.cx = matrix(0, 2), camera.cy = matrix(1, 2);
  camera.k1 = lens[0], camera.k2 = lens[1], camera.p1 = lens[2], camera.p2 = lens[3];
  camera.focal_error = std::max(spread.at<double>(0), spread.at<double>(1));
  if (!std::isfinite(camera.reprojection_error) || !(camera.focal_error < most_focal_error * camera.fx) ||
      !(tilt_between(turns) > least_tilt))
    throw InvalidInput(
        "these pictures do not tell the focal length: take the board under different angles, tilted by "
        "20 to 45 degrees to different sides");
  return camera;
}

std::string camera_text(const Camera& camera) {
  Camera copy = camera;
  std::array<double, 3> whole{double(camera.width), double(camera.height), double(camera.pictures)};
  std::ostringstream text;
  text.precision(10);
  text << "# made by softkin measure camera; lengths in pixels, distortion without unit\nsoftkin_camera: 1\n";
  for (const Group& group : groups_of(copy, whole)) {
    const char* before = ": {";
    text << group.name;
    for (const Key& key : group.keys) text << std::exchange(before, ", ") << key.name << ": " << *key.value;
    text << "}\n";
  }
  return text.str();
}

Camera read_camera(const std::filesystem::path& path) {
  const std::string file = path.string();
  const std::shared_ptr<const Node> root = scene::parse_yaml(read_file(path), file);
  if (root->kind != Node::Kind::map) throw InvalidInput({file}, "not a camera file");
  Camera camera;
  double version = 0;
  std::array<double, 3> whole{};
  std::vector<Group> groups = groups_of(camera, whole);
  groups.insert(groups.begin(), {"softkin_camera", {{"", 1, 1, &version}}});
  for (const Node::Entry& entry : root->entries) {
    Group& group = named(groups, entry);
    group.given = true;
    if (&group == &groups[0])
      read_number(*entry.value, group.keys[0]);
    else
      read_group(*entry.value, group.keys);
  }
  for (const Group& group : groups)
    if (!group.given) throw InvalidInput({file}, "not a camera file: '" + group.name + "' is missing");
  if (whole[0] != std::floor(whole[0]) || whole[1] != std::floor(whole[1]))
    throw InvalidInput({file}, "width and height of a picture are whole numbers of pixels");
  camera.width = static_cast<int>(whole[0]);
  camera.height = static_cast<int>(whole[1]);
  camera.pictures = static_cast<int>(whole[2]);
  check_folding(camera, file);
  return camera;
}

PlaneView::PlaneView(std::optional<Camera> camera, double mm_per_pixel) : camera_(std::move(camera)) {
  to_plane_ = Eigen::Vector3d(mm_per_pixel, -mm_per_pixel, 1).asDiagonal();
  fitted_ = to_picture_ = to_plane_.inverse();
}

PlaneView::PlaneView(std::optional<Camera> camera, const std::vector<PlanePoint>& points) : camera_(std::move(camera)) {
  if (points.size() < 4) throw InvalidInput("a plane is found from four points or more");
  fitted_ = first_guess(points);
  const Eigen::Index n = static_cast<Eigen::Index>(2 * points.size());
  Eigen::Matrix<double, Eigen::Dynamic, 8> rows(n, 8);
  Eigen::VectorXd miss(n);
  for (int round = 0;; ++round) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(2 * k);
      rows.middleRows<2>(i) = by_entries(fitted_, points[k].place);
      miss.segment<2>(i) = points[k].pixel - mapped(fitted_, points[k].place);
    }
    const Eigen::Matrix<double, 8, 1> size = rows.colwise().norm().cwiseInverse();
    rows *= size.asDiagonal();  // entries of the map differ in size
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(rows);
    solver.setThreshold(1e-6);
    if (!rows.allFinite() || solver.rank() < 8)
      throw InvalidInput("the points of the plane lie on a line: its perspective cannot be found");
    if (round == 5) {
      // an exact fit of four points says nothing about their errors
      const double variance = n > 8 ? miss.squaredNorm() / static_cast<double>(n - 8) : 0;
      covariance_ = variance * size.asDiagonal() * (rows.transpose() * rows).inverse() * size.asDiagonal();
      break;
    }
    Eigen::Matrix<double, 9, 1> step = Eigen::Matrix<double, 9, 1>::Zero();
    step.head<8>() = size.cwiseProduct(solver.solve(miss));
    fitted_ += step.reshaped<Eigen::RowMajor>(3, 3);
  }
  residual_ = std::sqrt(miss.squaredNorm() / static_cast<double>(points.size()));
  to_picture_ = fitted_;
  to_plane_ = to_picture_.inverse();
}

Vec2 PlaneView::ideal(const Vec2& seen) const {
  return camera_ ? undistorted(*camera_, seen) : seen;
}

Vec2 PlaneView::ideal_to_mm(const Vec2& ideal) const {
  return mapped(to_plane_, ideal);
}

Vec2 PlaneView::to_mm(const Vec2& seen) const {
  return mapped(to_plane_, ideal(seen));
}

Vec2 PlaneView::to_pixel(const Vec2& place) const {
  const Vec2 pixel = mapped(to_picture_, place);
  return camera_ ? distorted(*camera_, pixel) : pixel;
}

double PlaneView::pixel_area(const Vec2& seen) const {
  Eigen::Matrix2d sides;
  sides << to_mm(seen + Vec2(0.5, 0)) - to_mm(seen - Vec2(0.5, 0)),
      to_mm(seen + Vec2(0, 0.5)) - to_mm(seen - Vec2(0, 0.5));
  return std::abs(sides.determinant());
}

double PlaneView::error_at(const Vec2& seen) const {
  const Vec2 place = mapped(fitted_.inverse(), ideal(seen));
  const Eigen::Matrix<double, 2, 8> rows = by_entries(fitted_, place);
  const Eigen::Vector3d image = fitted_ * place.homogeneous();
  // derivative of the pixel by the place, to bring the error of the pixel to the plane
  const Eigen::Matrix2d slope =
      (fitted_.topLeftCorner<2, 2>() - image.hnormalized() * fitted_.block<1, 2>(2, 0)) / image.z();
  const Eigen::Matrix<double, 2, 8> in_plane = slope.inverse() * rows;
  return std::sqrt((in_plane * covariance_ * in_plane.transpose()).trace() / 2);
}

PlaneView PlaneView::moved(const Vec2& origin, double angle) const {
  PlaneView result = *this;
  result.to_plane_ = (Eigen::Rotation2Dd(-angle) * Eigen::Translation2d(-origin)).matrix() * to_plane_;
  result.to_picture_ = result.to_plane_.inverse();
  return result;
}

}  // namespace softkin::vision
