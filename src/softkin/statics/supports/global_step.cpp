#include <Eigen/Geometry>
#include <algorithm>
#include <softkin/core/dense.hpp>
#include <softkin/energy/rotation.hpp>
#include <softkin/statics/supports/global_step.hpp>

namespace softkin::supports {

using namespace energy;

GlobalStep::GlobalStep(const Model& model, const Eigen::SparseMatrix<double>& matrix, const std::vector<Index>& order)
    : region_of_(model.rest.rows(), -1),
      fixed_(model.held.fixed),
      rest_(model.rest),
      held_(model.held.at),
      turning_(model) {
  add_regions(model);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Index> free;
    for (Index v = 0; v < rest_.rows(); ++v)
      if (!fixed_[v][axis] && region_of_[v] < 0) free.push_back(v);
    const auto same = std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.free == free; });
    if (same != groups_.end()) {
      same->axes.push_back(axis);
    } else {
      groups_.emplace_back();
      groups_.back().axes = {axis};
      groups_.back().free = std::move(free);
    }
  }
  for (Group& group : groups_) make_group(matrix, order, group);
}

void GlobalStep::add_regions(const Model& model) {
  regions_ = movable_bodies(model, fixed_, held_);
  for (std::size_t r = 0; r < regions_.size(); ++r)
    for (const Index v : regions_[r].vertices) {
      region_of_[v] = r;
      fixed_[v] = {false, false, false};
    }
}

void GlobalStep::make_group(const Eigen::SparseMatrix<double>& matrix, const std::vector<Index>& order, Group& group) {
  const Index handles = 4 * std::ssize(regions_);
  const Index count = group.free.size();
  std::vector<Index> place(rest_.rows(), -1);
  for (Index i = 0; i < count; ++i) place[group.free[i]] = i;
  Points basis = Points::Zero(rest_.rows(), 3);
  for (const RigidBody& region : regions_)
    for (std::size_t i = 0; i < region.vertices.size(); ++i) basis.row(region.vertices[i]) = region.offsets.row(i);
  const auto handle_row = [&](Index v) { return Eigen::Vector4d(1, basis(v, 0), basis(v, 1), basis(v, 2)); };

  group.coupling = Eigen::MatrixXd::Zero(count, handles);
  group.schur = Eigen::MatrixXd::Zero(handles, handles);
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](Index i, Index j, double value) {  // the full matrix, both triangles
    if (place[i] >= 0 && place[j] >= 0) {
      if (place[i] >= place[j]) entries.emplace_back(place[i], place[j], value);
    } else if (place[i] >= 0 && region_of_[j] >= 0) {
      group.coupling.block<1, 4>(place[i], 4 * region_of_[j]) += value * handle_row(j).transpose();
    } else if (region_of_[i] >= 0 && region_of_[j] >= 0) {
      group.schur.block<4, 4>(4 * region_of_[i], 4 * region_of_[j]) +=
          value * handle_row(i) * handle_row(j).transpose();
    }
  };
  for (Index j = 0; j < matrix.cols(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, j); it; ++it) {
      const Index i = it.row();
      add(i, j, it.value());
      if (i != j) add(j, i, it.value());
    }
  group.follow = Eigen::MatrixXd::Zero(count, handles);
  if (count == 0) return;
  Eigen::SparseMatrix<double> free_part(count, count);
  free_part.setFromTriplets(entries.begin(), entries.end());
  std::vector<Index> own_order;
  for (const Index v : order)
    if (place[v] >= 0) own_order.push_back(place[v]);
  group.factor.emplace_back(free_part, own_order);
  Team alone(1);
  for (Index h = 0; h < handles; h += 3) {
    Points columns = Points::Zero(count, 3);
    const Index width = std::min<Index>(3, handles - h);
    columns.leftCols(width) = group.coupling.middleCols(h, width);
    group.factor.front().solve(columns, alone);
    group.follow.middleCols(h, width) = columns.leftCols(width);
  }
  group.schur -= group.coupling.transpose() * group.follow;
}

void GlobalStep::place(const RigidBody& region, const Pose& pose, Points& positions) const {
  for (std::size_t i = 0; i < region.vertices.size(); ++i)
    positions.row(region.vertices[i]) = (pose.center + pose.rotation * region.offsets.row(i).transpose()).transpose();
}

GlobalStep::Handles GlobalStep::handles_of(const Points& residual) const {
  Handles sums = Handles::Zero(4 * std::ssize(regions_), 3);
  for (std::size_t r = 0; r < regions_.size(); ++r)
    for (std::size_t i = 0; i < regions_[r].vertices.size(); ++i) {
      const auto pull = residual.row(regions_[r].vertices[i]);
      sums.row(4 * r) += pull;
      sums.middleRows<3>(4 * r + 1) += regions_[r].offsets.row(i).transpose() * pull;
    }
  return sums;
}

GlobalStep::Handles GlobalStep::handles_of(const std::vector<Pose>& poses) const {
  Handles handles(4 * std::ssize(poses), 3);
  for (std::size_t r = 0; r < poses.size(); ++r) {
    handles.row(4 * r) = poses[r].center.transpose();
    handles.middleRows<3>(4 * r + 1) = poses[r].rotation.transpose();
  }
  return handles;
}

/// J of one coordinate of the handles: dH = J (slide, turn) to first order, center moves by the slide, column k of R by
/// turn x R_k.
Eigen::MatrixXd GlobalStep::tangent_of(const std::vector<Pose>& poses, int axis) const {
  const Index count = poses.size();
  Eigen::MatrixXd tangent = Eigen::MatrixXd::Zero(4 * count, 6 * count);
  for (std::size_t r = 0; r < poses.size(); ++r) {
    const Index row = 4 * r, column = 6 * r;
    if (regions_[r].slides[axis]) tangent(row, column + axis) = 1;
    for (int k = 0; k < 3; ++k)
      for (int about = 0; about < 3; ++about)
        if (regions_[r].turns[about])
          tangent(row + 1 + k, column + 3 + about) = Vec3::Unit(about).cross(poses[r].rotation.col(k))[axis];
  }
  return tangent;
}

/// Slides and turns that minimise the quadratic to first order of the poses.
Eigen::VectorXd GlobalStep::gauss_newton_move(const Handles& slope, const std::vector<Pose>& poses) const {
  const Index unknowns = 6 * std::ssize(poses);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  for (const Group& group : groups_)
    for (const int axis : group.axes) {
      const Eigen::MatrixXd tangent = tangent_of(poses, axis);
      normal += tangent.transpose() * group.schur * tangent;
      right += tangent.transpose() * slope.col(axis);
    }
  for (Index i = 0; i < unknowns; ++i)
    if (normal(i, i) == 0) normal(i, i) = 1;  // held: its row, column and right side are zero
  return solve_symmetric(normal, right);
}

/// Minimises sum_axis (dH' S dH - 2 dH' requested) over the poses, dH = H - H at the start.
void GlobalStep::move_poses(const Handles& requested, std::vector<Pose>& poses) const {
  const Handles start = handles_of(poses);
  const auto slope_at = [&](const Handles& handles, double& value) {
    const Handles moved = handles - start;
    Handles slope = requested;
    for (const Group& group : groups_)
      for (const int axis : group.axes) slope.col(axis) -= group.schur * moved.col(axis);
    value = -(moved.cwiseProduct(slope + requested)).sum();
    return slope;
  };
  double value = 0;
  Handles slope = slope_at(start, value);
  constexpr int max_rounds = 20;
  for (int round = 0; round < max_rounds; ++round) {
    const Eigen::VectorXd move = gauss_newton_move(slope, poses);
    bool better = false;
    double scale = 1;
    for (; scale > 1e-3 && !better; scale /= 2) {
      std::vector<Pose> trial = poses;
      for (std::size_t r = 0; r < poses.size(); ++r) {
        trial[r].center += scale * move.segment<3>(6 * r);
        trial[r].rotation = rotation_about(scale * move.segment<3>(6 * r + 3)) * trial[r].rotation;
      }
      double trial_value = 0;
      const Handles trial_slope = slope_at(handles_of(trial), trial_value);
      if (!(trial_value < value)) continue;
      better = true;
      poses = std::move(trial);
      slope = trial_slope;
      value = trial_value;
    }
    if (!better || move.cwiseAbs().maxCoeff() < 1e-12) return;
  }
}

void GlobalStep::step(const Points& residual, Points& positions, std::vector<Pose>& poses, Team& team) const {
  Handles requested = handles_of(residual);
  std::vector<Points> moves;
  for (const Group& group : groups_) {
    const Index count = group.free.size();
    Points& move = moves.emplace_back(Points::Zero(count, 3));
    for (Index i = 0; i < count; ++i)
      for (const int axis : group.axes) move(i, axis) = residual(group.free[i], axis);
    if (count > 0) group.factor.front().solve(move, team);
    if (!regions_.empty())
      for (const int axis : group.axes) requested.col(axis) -= group.coupling.transpose() * move.col(axis);
  }
  if (!regions_.empty()) {
    const Handles before = handles_of(poses);
    move_poses(requested, poses);
    const Handles moved = handles_of(poses) - before;
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (const int axis : groups_[g].axes) moves[g].col(axis) -= groups_[g].follow * moved.col(axis);
    for (std::size_t r = 0; r < regions_.size(); ++r) place(regions_[r], poses[r], positions);
  }
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (Index i = 0; i < std::ssize(groups_[g].free); ++i)
      for (const int axis : groups_[g].axes) positions(groups_[g].free[i], axis) += moves[g](i, axis);
}

std::vector<Pose> GlobalStep::poses(const Points& positions) const {
  std::vector<Pose> poses;
  for (const RigidBody& region : regions_) {
    const Vec3 center = center_of(region, positions);
    poses.push_back({center, rotation_of(region, positions, center)});
  }
  return poses;
}

std::vector<Pose> GlobalStep::project(const Eigen::VectorXd& actuation, Points& positions) const {
  for (Index v = 0; v < rest_.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis)
      if (fixed_[v][axis]) positions(v, axis) = held_(v, axis);
  turning_.place(actuation, 1, positions);
  std::vector<Pose> all = poses(positions);
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    for (int axis = 0; axis < 3; ++axis)
      if (!regions_[r].slides[axis])
        all[r].center[axis] = regions_[r].rest_center[axis] + regions_[r].displacement[axis];
    place(regions_[r], all[r], positions);
  }
  return all;
}

double GlobalStep::free_norm(const Points& residual, const std::vector<Pose>& poses) const {
  double squares = 0;
  for (const Group& group : groups_)
    for (const Index v : group.free)
      for (const int axis : group.axes) squares += residual(v, axis) * residual(v, axis);
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    const RigidBody& region = regions_[r];
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    for (std::size_t i = 0; i < region.vertices.size(); ++i) {
      const Vec3 pull = residual.row(region.vertices[i]).transpose();
      force += pull;
      torque += (poses[r].rotation * region.offsets.row(i).transpose()).cross(pull);
    }
    const double size = region.offsets.rowwise().norm().maxCoeff();
    for (int axis = 0; axis < 3; ++axis) {
      if (region.slides[axis]) squares += force[axis] * force[axis];
      if (region.turns[axis]) squares += torque[axis] * torque[axis] / (size * size);
    }
  }
  return std::sqrt(squares);
}

}  // namespace softkin::supports
