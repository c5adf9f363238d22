#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/scanner.hpp>
#include <softkin/io/scene/tree.hpp>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/open_cv.hpp>
#include <sstream>
#include <tuple>
#include <utility>

namespace softkin::vision {

namespace {

constexpr std::size_t min_pictures = 4;
constexpr double max_focal_error = 0.03;  // of the focal length
constexpr double min_tilt = 0.2;          // between two boards [rad]: seen straight, near and small is far and large

/// Largest angle between the planes of two of the boards [rad].
double tilt_between(const std::vector<std::array<double, 3>>& rotations) {
  std::vector<Eigen::Vector3d> normals;
  for (const std::array<double, 3>& rotation : rotations) {
    const Eigen::Vector3d turn(rotation[0], rotation[1], rotation[2]);
    const double angle = turn.norm();
    normals.emplace_back(angle > 0 ? Eigen::AngleAxisd(angle, turn / angle) * Eigen::Vector3d::UnitZ()
                                   : Eigen::Vector3d::UnitZ());
  }
  double least = 1;
  for (const Eigen::Vector3d& a : normals)
    for (const Eigen::Vector3d& b : normals) least = std::min(least, a.dot(b));
  return std::acos(std::clamp(least, -1.0, 1.0));
}

/// What the lens does to a direction (x, y, 1): the factor along the radius, and what is added to it.
struct Bend {
  double radial;
  Vec2 tangential;

  Bend(const Camera& camera, const Vec2& at) {
    const double x = at.x(), y = at.y(), r = at.squaredNorm();
    radial = 1 + r * (camera.k1 + r * (camera.k2 + r * camera.k3));
    tangential = {2 * camera.p1 * x * y + camera.p2 * (r + 2 * x * x),
                  camera.p1 * (r + 2 * y * y) + 2 * camera.p2 * x * y};
  }
};

Vec2 direction_of(const Camera& camera, const Vec2& pixel) {
  return {(pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy};
}

Vec2 pixel_of(const Camera& camera, const Vec2& direction) {
  return {camera.fx * direction.x() + camera.cx, camera.fy * direction.y() + camera.cy};
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

/// Moves points so that their mean is 0 and their mean distance from it the root of 2.
Map normaliser(const std::vector<PlanePoint>& points, Vec2 PlanePoint::*const which) {
  Vec2 mean = Vec2::Zero();
  for (const PlanePoint& point : points) mean += point.*which / static_cast<double>(points.size());
  double distance = 0;
  for (const PlanePoint& point : points) distance += (point.*which - mean).norm() / static_cast<double>(points.size());
  const double scale = std::sqrt(2) / distance;
  Map map;
  map << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return map;
}

/// The map of least algebraic error, whose ninth entry is 1 (Hartley and Zisserman, Multiple View Geometry, Alg. 4.2).
Map first_guess(const std::vector<PlanePoint>& points) {
  const Map from = normaliser(points, &PlanePoint::place), to = normaliser(points, &PlanePoint::pixel);
  Eigen::Matrix<double, 9, 9> square = Eigen::Matrix<double, 9, 9>::Zero();
  for (const PlanePoint& point : points) {
    const Eigen::Vector3d place = from * point.place.homogeneous();
    const Vec2 pixel = mapped(to, point.pixel);
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      Eigen::Matrix<double, 9, 1> row = Eigen::Matrix<double, 9, 1>::Zero();
      row.segment<3>(3 * axis) = place;
      row.tail<3>() = -pixel[axis] * place;
      square += row * row.transpose();
    }
  }
  if (!square.allFinite()) return Map::Constant(NAN);  // all at one point
  const Eigen::VectorXd least = symmetric_eigen(square).vectors.col(0);
  const Map map = to.inverse() * least.reshaped<Eigen::RowMajor>(3, 3) * from;
  return map / map(2, 2);
}

}  // namespace

Vec2 distorted(const Camera& camera, const Vec2& ideal) {
  const Vec2 direction = direction_of(camera, ideal);
  const Bend bend(camera, direction);
  return pixel_of(camera, bend.radial * direction + bend.tangential);
}

Vec2 undistorted(const Camera& camera, const Vec2& seen) {
  constexpr int max_rounds = 100;
  const Vec2 bent = direction_of(camera, seen);
  Vec2 direction = bent;
  for (int round = 0; round < max_rounds; ++round) {
    const Bend bend(camera, direction);
    if (!(bend.radial > 0)) return seen;  // where the picture is folded over itself nothing is taken out
    const Vec2 next = (bent - bend.tangential) / bend.radial;
    const bool done = (next - direction).norm() < 1e-15;
    direction = next;
    if (done) break;
  }
  return pixel_of(camera, direction);
}

Camera fit_camera(const std::vector<BoardSight>& sights, int width, int height, std::vector<double>& errors) {
  if (sights.size() < min_pictures)
    throw InvalidInput("a camera is found from " + std::to_string(min_pictures) +
                       " pictures of the board or more, better 10 to 20 under different angles");
  const std::optional<opencv::Fit> fit = opencv::calibrated(sights, width, height);
  if (!fit) throw InvalidInput("no camera fits these pictures; is the board flat, and are they all from one camera?");
  errors = fit->errors;
  Camera camera{.width = width, .height = height, .pictures = static_cast<int>(sights.size())};
  std::tie(camera.fx, camera.fy, camera.cx, camera.cy) = std::tuple_cat(fit->matrix);
  std::tie(camera.k1, camera.k2, camera.p1, camera.p2) = std::tuple_cat(fit->lens);
  camera.focal_error = std::max(fit->focal_errors[0], fit->focal_errors[1]);
  camera.reprojection_error = fit->reprojection_error;
  if (!std::isfinite(camera.reprojection_error) || !(camera.focal_error < max_focal_error * camera.fx) ||
      !(tilt_between(fit->rotations) > min_tilt))
    throw InvalidInput(
        "these pictures do not determine the focal length: take the board under different angles, tilted by "
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

PlaneView::PlaneView(std::optional<Camera> camera, double mm_per_pixel) : camera_(camera) {
  to_plane_ = Eigen::Vector3d(mm_per_pixel, -mm_per_pixel, 1).asDiagonal();
  fitted_ = to_picture_ = to_plane_.inverse();
}

PlaneView::PlaneView(std::optional<Camera> camera, const std::vector<PlanePoint>& points) : camera_(camera) {
  if (points.size() < 4) throw InvalidInput("a plane is found from four points or more");
  fitted_ = first_guess(points);
  const Eigen::Index n = 2 * points.size();
  Eigen::Matrix<double, Eigen::Dynamic, 8> rows(n, 8);
  Eigen::VectorXd miss(n);
  for (int round = 0;; ++round) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Eigen::Index i = 2 * k;
      rows.middleRows<2>(i) = by_entries(fitted_, points[k].place);
      miss.segment<2>(i) = points[k].pixel - mapped(fitted_, points[k].place);
    }
    const Eigen::Matrix<double, 8, 1> size = rows.colwise().norm().cwiseInverse();
    rows *= size.asDiagonal();  // entries of the map differ in size
    const MinimumNorm solver(rows, 1e-6);
    if (!rows.allFinite() || solver.rank() < 8)
      throw InvalidInput("the points of the plane lie on a line: its perspective cannot be found");
    if (round == 5) {
      // an exact fit of four points does not show their errors
      const double variance = n > 8 ? miss.squaredNorm() / static_cast<double>(n - 8) : 0;
      covariance_ = variance * size.asDiagonal() * inverse_of(rows.transpose() * rows) * size.asDiagonal();
      break;
    }
    Eigen::Matrix<double, 9, 1> change = Eigen::Matrix<double, 9, 1>::Zero();
    change.head<8>() = size.cwiseProduct(solver.solve(miss));
    fitted_ += change.reshaped<Eigen::RowMajor>(3, 3);
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
