#pragma once

#include <limits>
#include <softkin/calibration/robot_parameters.hpp>
#include <softkin/calibration/seen_outline.hpp>
#include <softkin/model/measured_poses.hpp>

namespace softkin::calibration {

struct OutlineOptions {
  int points = 40;                    // to which the outline of a picture is thinned, evenly along it; > 0
  std::optional<double> within_mm{};  // farther off a point does not count; > 0; none: 5 % of the robot's diagonal
};

/// A point of a measured outline.
struct OutlinePoint {
  Eigen::Vector2d place{0, 0};    // [mm]
  Eigen::Vector2d outward{0, 0};  // normal of the outline, of length 1; 0: not known, as the point is alone
};

/// So many points of an outline, evenly along it; of fewer all. Where two that follow each other are far apart, five
/// times farther than most, the outline has a gap. Which side is outwards is by the area that all of them enclose.
[[nodiscard]] std::vector<OutlinePoint> thinned_outline(const std::vector<Eigen::Vector2d>& points, int count);

/// The distance of a measured point from the outline of the robot.
struct OutlineMiss {
  OutlinePlace nearest;
  double off_mm = std::numeric_limits<double>::quiet_NaN();  // > 0: outside; NaN: the robot has no outline there
  Eigen::Vector2d path{0, 0};                                // derivative of off_mm by the point
};

/// A point of an outline with its computed counterpart, for reports.
struct OutlineReading {
  Eigen::Vector2d measured{0, 0}, nearest{0, 0};  // [mm]
  double off_mm = std::numeric_limits<double>::quiet_NaN();
  bool counts = false;
};

using OutlineLines = std::vector<std::array<Eigen::Vector2d, 2>>;  // from end to end
using OutlineMisses = std::vector<std::vector<OutlineMiss>>;       // per pose, per point that is fitted to

/// The outlines of a robot in pictures as readings: how far each of their points is off the outline of the robot.
class RobotOutlines {
 public:
  /// throws  InvalidInput naming the file: a number of points or a distance that is not > 0; pictures and no other
  ///         reading, or a distance, and no outline; a robot without a surface
  RobotOutlines(const MeasuredPoses& poses, const Model& model, const OutlineOptions& options);

  [[nodiscard]] bool any() const { return surface_.has_value(); }
  [[nodiscard]] std::size_t points(Index pose) const { return any() ? points_[std::size_t(pose)].size() : 0; }
  [[nodiscard]] double requested_mm() const { return requested_mm_; }

  /// Of a pose, as the shape is seen along z of the measuring frame.
  [[nodiscard]] std::vector<OutlineMiss> misses(Index pose, const Points& positions, const MeasuringFrame& frame) const;
  [[nodiscard]] OutlineLines lines(const Points& positions, const MeasuringFrame& frame) const;

  /// Selects the points that are near enough: within the requested distance, or, while the numbers may be far from the
  /// solution, within three times the median distance in the poses that are fitted to. fitted: these poses; null: the
  /// requested distance. Has the selection changed?
  bool match(const OutlineMisses& misses, const std::vector<bool>* fitted);
  [[nodiscard]] bool counts(Index pose, std::size_t point) const { return counts_[std::size_t(pose)][point]; }
  [[nodiscard]] std::vector<OutlineReading> readings(Index pose, const std::vector<OutlineMiss>& misses) const;

 private:
  std::vector<std::vector<OutlinePoint>> points_;  // per pose
  std::optional<SurfaceEdges> surface_;
  double requested_mm_ = 0;
  std::vector<std::vector<bool>> counts_;
};

/// Derivatives of the misses of a pose by a number.
///
/// turns, shifts  of the measuring frame [per unit of the number]
/// moves          of the vertices, #V by 3 [mm per unit]; null: they do not move
/// equation       d off / d p = -path . d place / d p, the place being at a fixed fraction of its edge
[[nodiscard]] Eigen::VectorXd outline_slopes(const std::vector<OutlineMiss>& misses, const Points& positions,
                                             const MeasuringFrame& frame, const Mat3& turns, const Vec3& shifts,
                                             const Points* moves);

}  // namespace softkin::calibration
