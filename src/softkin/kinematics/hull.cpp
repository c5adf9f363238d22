#include <libqhull_r/libqhull_r.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/hull.hpp>

namespace softkin {

namespace {

constexpr double flat_below = 1e-6;  // of the largest extent

/// A run of Qhull, and the memory that it holds.
class Qhull {
 public:
  /// points: dimension values each; they must outlive the object.
  Qhull(std::vector<double>& points, int dimension) {
    // messages of Qhull must not reach the terminal
    const std::unique_ptr<FILE, int (*)(FILE*)> messages(::open_memstream(&said_, &said_size_), std::fclose);
    if (!messages) throw InvalidInput("out of memory for the hull");
    qh_zero(&qh_, messages.get());
    char command[] = "qhull Qt";
    const auto count = static_cast<int>(points.size()) / dimension;
    const int code = qh_new_qhull(&qh_, dimension, count, points.data(), False, command, nullptr, messages.get());
    if (code == 0) return;
    std::fflush(messages.get());
    const std::string text(said_, std::min<std::size_t>(said_size_, 120));
    release();
    throw InvalidInput("Qhull cannot make a hull of the points: " + text);
  }
  ~Qhull() { release(); }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  /// Point numbers of every facet: three in space, two in a plane.
  [[nodiscard]] std::vector<std::vector<Index>> facets() {
    std::vector<std::vector<Index>> all;
    for (facetT* facet = qh_.facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      std::vector<Index> corners;
      for (int i = 0; i < qh_setsize(&qh_, facet->vertices); ++i) {
        const auto* vertex = static_cast<const vertexT*>(facet->vertices->e[i].p);
        corners.push_back(qh_pointid(&qh_, vertex->point));
      }
      all.push_back(std::move(corners));
    }
    return all;
  }

 private:
  void release() {
    int used = 0, total = 0;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &used, &total);
    std::free(said_);
    said_ = nullptr;
  }

  qhT qh_{};
  char* said_ = nullptr;
  std::size_t said_size_ = 0;
};

/// Centre and principal axes, the widest first, and the extent along each.
struct Frame {
  Vec3 centre;
  Mat3 axes;
  Vec3 extents;
};

Frame frame_of(const Points& points) {
  Frame frame;
  frame.centre = points.colwise().mean();
  const Points centred = points.rowwise() - frame.centre.transpose();
  const Mat3 spread = centred.transpose() * centred;
  frame.axes = symmetric_eigen(spread).vectors.rowwise().reverse();
  const Points turned = centred * frame.axes;
  frame.extents = (turned.colwise().maxCoeff() - turned.colwise().minCoeff()).transpose();
  return frame;
}

Vec3 normal_of(const Points& vertices, const Triangle& t) {
  const Vec3 a = vertices.row(t[0]), b = vertices.row(t[1]), c = vertices.row(t[2]);
  return 0.5 * (b - a).cross(c - a);
}

/// Numbers the points that are used from 0 on and keeps only these.
void keep_corners(const Points& points, Hull& hull) {
  std::map<Index, Index> numbers;
  for (const Triangle& triangle : hull.triangles)
    for (const Index corner : triangle) numbers.emplace(corner, 0);
  Index count = 0;
  hull.vertices.resize(numbers.size(), 3);
  for (auto& [point, number] : numbers) {
    hull.vertices.row(count) = points.row(point);
    number = count++;
  }
  for (Triangle& triangle : hull.triangles)
    for (Index& corner : triangle) corner = numbers[corner];
}

void add_solid(const Points& points, const Frame& frame, Hull& hull) {
  const Points centred = points.rowwise() - frame.centre.transpose();
  std::vector<double> values(centred.data(), centred.data() + centred.size());
  for (const std::vector<Index>& facet : Qhull(values, 3).facets()) {
    if (facet.size() != 3) throw InvalidInput("Qhull left a facet that is no triangle");
    Triangle triangle{facet[0], facet[1], facet[2]};
    // the centre is inside
    if (normal_of(centred, triangle).dot(centred.row(triangle[0]).transpose()) < 0) std::swap(triangle[1], triangle[2]);
    const Vec3 normal = normal_of(centred, triangle);
    hull.area += normal.norm();
    hull.volume += normal.dot(centred.row(triangle[0]).transpose()) / 3;
    hull.triangles.push_back(triangle);
  }
  keep_corners(points, hull);
}

void add_flat(const Points& points, const Frame& frame, Hull& hull) {
  using Plane = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
  const Plane flat = (points.rowwise() - frame.centre.transpose()) * frame.axes.leftCols<2>();
  std::vector<double> values(flat.data(), flat.data() + flat.size());
  std::vector<Index> corners;
  for (const std::vector<Index>& edge : Qhull(values, 2).facets())
    corners.insert(corners.end(), edge.begin(), edge.end());
  const auto angle = [&](Index corner) { return std::atan2(flat(corner, 1), flat(corner, 0)); };
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  std::sort(corners.begin(), corners.end(), [&](Index a, Index b) { return angle(a) < angle(b); });
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    hull.triangles.push_back({corners[0], corners[i], corners[i + 1]});
    hull.area += normal_of(points, hull.triangles.back()).norm();
  }
  keep_corners(points, hull);
}

}  // namespace

Hull convex_hull(const Points& points) {
  if (points.rows() == 0) throw InvalidInput("there are no points to make a hull of");
  if (!points.allFinite()) throw InvalidInput("a point of the hull is not finite");
  const Frame frame = frame_of(points);
  Hull hull;
  hull.extents = frame.extents;
  const double size = points.cwiseAbs().maxCoeff();
  const auto is_thin = [&](int axis) {
    return frame.extents[axis] <= std::max(flat_below * hull.extents[0], 1e-13 * size);
  };
  if (is_thin(0)) {
    hull.vertices = points.row(0);
  } else if (is_thin(1)) {
    hull.shape = HullShape::line;
    const Eigen::VectorXd along = points * frame.axes.col(0);
    Index low = 0, high = 0;
    along.minCoeff(&low);
    along.maxCoeff(&high);
    hull.vertices.resize(2, 3);
    hull.vertices << points.row(low), points.row(high);
  } else if (is_thin(2)) {
    hull.shape = HullShape::flat;
    add_flat(points, frame, hull);
  } else {
    hull.shape = HullShape::solid;
    add_solid(points, frame, hull);
  }
  return hull;
}

}  // namespace softkin
