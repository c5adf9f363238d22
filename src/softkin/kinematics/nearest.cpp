#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <numeric>
#include <softkin/core/error.hpp>
#include <softkin/kinematics/nearest.hpp>

namespace softkin {

struct NearestPoints::Tree {
  using Search = nanoflann::KDTreeEigenMatrixAdaptor<Rows>;

  explicit Tree(Rows rows) : points(std::move(rows)), search(points.cols(), points) {}

  Rows points;
  Search search;
};

NearestPoints::NearestPoints(Rows points) {
  if (points.rows() == 0 || points.cols() == 0) throw InvalidInput("there are no points to search");
  if (!points.allFinite()) throw InvalidInput("a point to be searched is not finite");
  tree_ = std::make_unique<Tree>(std::move(points));
}

NearestPoints::~NearestPoints() = default;
NearestPoints::NearestPoints(NearestPoints&&) noexcept = default;
NearestPoints& NearestPoints::operator=(NearestPoints&&) noexcept = default;

std::vector<NearestPoints::Found> NearestPoints::find(const Eigen::VectorXd& target, Index count) const {
  if (target.size() != tree_->points.cols())
    throw InvalidInput("the target has " + std::to_string(target.size()) + " coordinates, the points " +
                       std::to_string(tree_->points.cols()));
  if (!target.allFinite()) throw InvalidInput("the target is not finite");
  if (count < 1) throw InvalidInput("the number of points to find must be 1 or more");
  const auto most = std::min(static_cast<std::size_t>(count), static_cast<std::size_t>(tree_->points.rows()));
  std::vector<Eigen::Index> rows(most);
  std::vector<double> squares(most);
  tree_->search.query(target.data(), most, rows.data(), squares.data());
  std::vector<Found> found;
  for (std::size_t i = 0; i < most; ++i) found.push_back({static_cast<Index>(rows[i]), std::sqrt(squares[i])});
  return found;
}

namespace {

/// Per marker and axis, the root of the weight with which a coordinate counts; empty where a goal is not a position, or
/// two are of the same coordinate.
std::vector<double> scales_of(const Model& model, const std::vector<Goal>& goals) {
  std::vector<double> scales(3 * model.markers.size(), 0);
  for (const Goal& goal : goals) {
    const auto* position = std::get_if<PositionGoal>(&goal.what);
    if (position == nullptr) return {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!position->axes[axis]) continue;
      double& scale = scales[3 * static_cast<std::size_t>(position->marker) + axis];
      if (scale > 0) return {};
      scale = std::sqrt(goal.weight);
    }
  }
  return scales;
}

/// The coordinates that count, each by its scale.
Eigen::VectorXd scaled(const std::vector<double>& scales, const Points& markers) {
  Eigen::VectorXd result(std::count_if(scales.begin(), scales.end(), [](double scale) { return scale > 0; }));
  Index n = 0;
  for (std::size_t c = 0; c < scales.size(); ++c)
    if (scales[c] > 0) result[n++] = scales[c] * markers.data()[c];
  return result;
}

Points targets_of(const Model& model, const std::vector<Goal>& goals) {
  Points targets = Points::Zero(model.markers.size(), 3);
  for (const Goal& goal : goals) {
    const auto& position = std::get<PositionGoal>(goal.what);
    for (Index axis = 0; axis < 3; ++axis)
      if (position.axes[axis]) targets(position.marker, axis) = position.target[axis];
  }
  return targets;
}

double squared_error(const Goal& goal, const Points& markers) {
  if (const auto* position = std::get_if<PositionGoal>(&goal.what)) {
    double sum = 0;
    for (Index axis = 0; axis < 3; ++axis)
      if (position->axes[axis]) sum += std::pow(markers(position->marker, axis) - position->target[axis], 2);
    return sum;
  }
  if (const auto* plane = std::get_if<PlaneGoal>(&goal.what)) {
    const Vec3 from = markers.row(plane->marker).transpose() - plane->point;
    return std::pow(from.dot(plane->normal.stableNormalized()), 2);
  }
  if (std::holds_alternative<ForceGoal>(goal.what)) return 0;  // samples do not contain forces
  const auto& direction = std::get<DirectionGoal>(goal.what);
  const Vec3 line = (markers.row(direction.to) - markers.row(direction.from)).transpose();
  return std::pow(direction.lever_mm, 2) *
         (line.stableNormalized() - direction.direction.stableNormalized()).squaredNorm();
}

double squared_error(const std::vector<Goal>& goals, const Points& markers) {
  double sum = 0;
  for (const Goal& goal : goals) sum += goal.weight * squared_error(goal, markers);
  return sum;
}

}  // namespace

NearestSamples::NearestSamples(const Model& model, std::vector<WorkspaceSample> samples) : model_(model) {
  for (WorkspaceSample& sample : samples) {
    if (sample.status != Status::converged) continue;
    if (sample.markers.rows() != std::ssize(model.markers) || !sample.markers.allFinite())
      throw InvalidInput("sample " + std::to_string(sample.number) + " of the workspace has not the robot's markers");
    samples_.push_back(std::move(sample));
  }
  if (samples_.empty()) throw InvalidInput("no sample of the workspace has an equilibrium");
}

std::vector<Index> NearestSamples::find(const std::vector<Goal>& goals, Index count) {
  check_goals(model_, goals);
  if (std::all_of(goals.begin(), goals.end(), [](const Goal& g) { return std::holds_alternative<ForceGoal>(g.what); }))
    throw InvalidInput("samples of a workspace have places, not forces: none is nearest to a force");
  const std::vector<double> scales = scales_of(model_, goals);
  std::vector<Index> best;
  if (!scales.empty()) {
    if (!tree_ || scales != scales_) {
      NearestPoints::Rows rows;
      for (std::size_t i = 0; i < samples_.size(); ++i) {
        const Eigen::VectorXd row = scaled(scales, samples_[i].markers);
        if (i == 0) rows.resize(samples_.size(), row.size());
        rows.row(i) = row;
      }
      tree_ = std::make_unique<NearestPoints>(std::move(rows));
      scales_ = scales;
    }
    for (const auto& found : tree_->find(scaled(scales, targets_of(model_, goals)), count)) best.push_back(found.row);
    return best;
  }
  if (count < 1) throw InvalidInput("the number of samples to find must be 1 or more");
  std::vector<double> errors;
  for (const WorkspaceSample& sample : samples_) errors.push_back(squared_error(goals, sample.markers));
  best.resize(samples_.size());
  std::iota(best.begin(), best.end(), 0);
  const auto most = std::min<std::ptrdiff_t>(count, static_cast<std::ptrdiff_t>(best.size()));
  std::partial_sort(best.begin(), best.begin() + most, best.end(), [&](Index a, Index b) {
    const double left = errors[a], right = errors[b];
    return left < right || (left == right && a < b);
  });
  best.resize(most);
  return best;
}

}  // namespace softkin
