#pragma once

#include <random>
#include <softkin/calibration/robot_fit.hpp>
#include <softkin/calibration/robot_outlines.hpp>
#include <softkin/runs/body_surface.hpp>

namespace softkin::calibration {

/// Joins lines to one path: each point is followed by the nearest one that was not visited.
inline std::vector<Eigen::Vector2d> one_after_another(const OutlineLines& lines, double spacing) {
  std::vector<Eigen::Vector2d> left, path;
  for (const auto& [begin, end] : lines)
    for (double at = 0; at < (end - begin).norm(); at += spacing)
      left.emplace_back(begin + at / (end - begin).norm() * (end - begin));
  while (!left.empty()) {
    auto next = left.begin();
    for (auto each = left.begin(); !path.empty() && each != left.end(); ++each)
      if ((*each - path.back()).squaredNorm() < (*next - path.back()).squaredNorm()) next = each;
    // points just behind the visible edge are left out
    if (path.empty() || (*next - path.back()).norm() > spacing / 4) path.push_back(*next);
    left.erase(next);
  }
  return path;
}

/// Gives poses the outlines that a robot has in them, with noise along x and y.
inline void show_outlines(MeasuredPoses& poses, const NumberedRobot& truth, double noise, unsigned seed = 1) {
  const RobotFit found = predict_poses(truth, poses, truth.start(), {});
  const SurfaceEdges surface(runs::body_surface(truth.model(truth.start())).triangles);
  const MeasuringFrame frame = truth.frame(truth.start());
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal(0, 1);
  poses.outlines = {"outlines.csv", {}};
  for (std::size_t pose = 0; pose < poses.commands.size(); ++pose) {
    const Points seen = (found.computed.equilibria[pose].state.positions * frame.rotation.transpose()).rowwise() +
                        frame.place.transpose();
    std::vector<Eigen::Vector2d> path = one_after_another(SeenOutline(surface, seen).lines(), 0.5);
    for (Eigen::Vector2d& point : path) point += noise * Eigen::Vector2d(normal(engine), normal(engine));
    poses.pictures.push_back(pose + 1);
    poses.outlines.points.push_back(std::move(path));
  }
}

}  // namespace softkin::calibration
