#include <algorithm>
#include <cmath>
#include <softkin/calibration/robot_report_parts.hpp>

namespace softkin::calibration {

std::vector<Index> markers_of(const RobotFitReport& r) {
  std::vector<Index> markers;
  for (const PoseColumn& column : r.fit.named.columns)
    if (column.marker >= 0 && std::find(markers.begin(), markers.end(), column.marker) == markers.end())
      markers.push_back(column.marker);
  return markers;
}

bool has_dots(const RobotFitReport& r) {
  return !r.poses.dots.names.empty();
}

const std::string& marker_name(const RobotFitReport& r, Index marker) {
  return r.model.markers[marker].name;
}

std::pair<Vec3, Vec3> places_of(const RobotFitReport& r, Index pose, Index marker) {
  Vec3 there = Vec3::Constant(std::nan("")), here = there;
  for (Index c = 0; c < std::ssize(r.fit.named.columns); ++c) {
    const PoseColumn& column = r.fit.named.columns[c];
    if (column.marker != marker) continue;
    there[column.axis] = r.fit.named.values(pose, c);
    here[column.axis] = r.fit.computed.values(pose, c);
  }
  return {there, here};
}

Vec3 dot_place(const RobotFitReport& r, Index pose, std::size_t dot) {
  const UnnamedDots& dots = r.poses.dots;
  Vec3 place = Vec3::Constant(std::nan(""));
  for (std::size_t axis = 0; axis < dots.axes.size(); ++axis)
    place[dots.axes[axis]] = dots.places(pose, dot * dots.axes.size() + axis);
  return place;
}

bool kept(const RobotFitReport& r, Index pose) {
  return !r.options.kept.empty() && r.options.kept[pose];
}

}  // namespace softkin::calibration
