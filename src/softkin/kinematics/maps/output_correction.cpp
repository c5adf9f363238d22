#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <softkin/kinematics/maps/measure_gradient.hpp>
#include <softkin/kinematics/maps/output_correction.hpp>
#include <softkin/statics/deformation.hpp>

namespace softkin::maps {

namespace {

constexpr double dependent = 1e-9;  // pivots below this fraction of the largest: outputs that depend on each other
constexpr int max_iterations = 12;  // three or four are usual

}  // namespace

/// Outputs as functions of amounts of fields around a shape. Ratios are scaled to the largest move of a vertex [mm] in
/// their field.
struct OutputCorrection::Linearised {
  std::vector<Field> fields;            // that move markers and change ratios
  std::vector<Points> ratio_gradients;  // per ratio, of the scaled output
  Eigen::VectorXd scales;               // per output: of the scaled one over it
  MinimumNorm responses;

  void add(const Eigen::VectorXd& amounts, Points& positions) const {
    for (std::size_t b = 0; b < fields.size(); ++b)
      for (const auto& [vertex, move] : fields[b])
        positions.row(vertex) += amounts[static_cast<Index>(b)] * move.transpose();
  }
};

OutputCorrection::OutputCorrection(const Model& model, const MapData& data) : model_(model) {
  for (const Marker& marker : model.markers) {
    std::map<Index, double> weights;
    for (std::size_t k = 0; k < marker.point.vertices.size(); ++k)
      weights[marker.point.vertices[k]] += marker.point.weights[k];
    double squares = 0;
    for (const auto& [vertex, weight] : weights) squares += weight * weight;
    for (int axis = 0; axis < 3; ++axis) {
      Field& field = marker_fields_.emplace_back();
      for (const auto& [vertex, weight] : weights)
        field.emplace_back(vertex, (marker.arms.empty() ? weight / squares : 1) * Vec3::Unit(axis));
    }
  }
  for (std::size_t q = 0; q < data.outputs.size(); ++q)
    for (std::size_t a = 0; a < model.actuators.size(); ++a)
      if (data.outputs[q].name == model.actuators[a].name + "_ratio")
        ratios_.push_back({static_cast<Index>(a), static_cast<Index>(q)});
}

Index OutputCorrection::count() const {
  return std::ssize(marker_fields_) + std::ssize(ratios_);
}

/// Returns the missing changes of the outputs, unscaled: coordinates of markers, then ratios.
Eigen::VectorXd OutputCorrection::missing(const Eigen::VectorXd& values, const Points& positions) const {
  Eigen::VectorXd lacking(count());
  Index next = 0;
  for (const Marker& marker : model_.markers) {
    lacking.segment<3>(next) = values.segment<3>(next) - marker.at(positions);
    next += 3;
  }
  for (const Ratio& ratio : ratios_)
    lacking[next++] = values[ratio.output] - achieved_ratio(model_, model_.actuators[ratio.actuator], positions);
  return lacking;
}

/// Adds rotations of the region that carries a stem, about its mean: the marker at the end of the stem moves while
/// other markers fix the mean.
void OutputCorrection::add_rotations(const Points& positions, std::vector<Field>& fields) const {
  for (const Marker& marker : model_.markers) {
    if (marker.arms.empty()) continue;
    const Vec3 mean = marker.point.at(positions);
    double radius = marker.stem.norm();
    for (const Vec3& arm : marker.arms) radius = std::max(radius, arm.norm());
    for (int axis = 0; axis < 3; ++axis) {
      Field& field = fields.emplace_back();
      for (const Index v : marker.point.vertices)
        field.emplace_back(v, Vec3::Unit(axis).cross(positions.row(v).transpose() - mean) / radius);
    }
  }
}

OutputCorrection::Linearised OutputCorrection::linearised(const Points& positions) const {
  const Index markers = std::ssize(marker_fields_);
  Linearised found;
  found.fields = marker_fields_;
  add_rotations(positions, found.fields);
  found.scales = Eigen::VectorXd::Ones(count());
  for (std::size_t r = 0; r < ratios_.size(); ++r) {
    const Actuator& actuator = model_.actuators[ratios_[r].actuator];
    Points gradient = measure_gradient(model_, actuator, positions);
    const double size = gradient.norm(), largest = gradient.rowwise().norm().maxCoeff();
    if (size > 0) {
      // by a move of 1 mm of the vertex that moves most the measure changes by |g|^2 / max |g_v|
      gradient /= largest;
      const double by_field = size * size / largest, step = 1e-6 * model_.diagonal_mm;
      const double ratio = (achieved_ratio(model_, actuator, positions + step * gradient) -
                            achieved_ratio(model_, actuator, positions - step * gradient)) /
                           (2 * step);
      found.scales[markers + static_cast<Index>(r)] = ratio != 0 ? 1 / ratio : 0;
      Field& field = found.fields.emplace_back();
      for (Index v = 0; v < gradient.rows(); ++v)
        if (!gradient.row(v).isZero(0)) field.emplace_back(v, gradient.row(v).transpose());
      gradient *= largest / by_field;  // of the scaled output
    } else {
      found.fields.emplace_back();
      found.scales[markers + static_cast<Index>(r)] = 0;
    }
    found.ratio_gradients.push_back(std::move(gradient));
  }
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count(), std::ssize(found.fields));
  Points moves = Points::Zero(positions.rows(), 3);
  for (Index b = 0; b < matrix.cols(); ++b) {
    for (const auto& [vertex, move] : found.fields[b]) moves.row(vertex) = move.transpose();
    for (Index m = 0; 3 * m < markers; ++m) {
      const Marker& marker = model_.markers[m];
      matrix.block<3, 1>(3 * m, b) = marker.velocity(positions, moves);
    }
    for (std::size_t r = 0; r < ratios_.size(); ++r)
      for (const auto& [vertex, move] : found.fields[b])
        matrix(markers + static_cast<Index>(r), b) += found.ratio_gradients[r].row(vertex).dot(move);
    for (const auto& [vertex, move] : found.fields[b]) moves.row(vertex).setZero();
  }
  found.responses = MinimumNorm(matrix, dependent);
  return found;
}

void OutputCorrection::move_to(const Eigen::VectorXd& values, Points& positions) const {
  if (count() == 0) return;
  const double rounding = 1e-14 * model_.diagonal_mm;
  double before = std::numeric_limits<double>::infinity();
  const Linearised around = linearised(positions);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::VectorXd lacking = around.scales.cwiseProduct(missing(values, positions));
    const double largest = lacking.cwiseAbs().maxCoeff();
    // outputs that depend on each other may contradict each other: they come no nearer
    if (!(largest > rounding) || !(largest < before)) return;
    before = largest;
    around.add(around.responses.solve(lacking), positions);
  }
}

void OutputCorrection::move_at(const RowMatrix& slopes, const Points& positions, std::vector<Points>& moves) const {
  if (count() == 0) return;
  const Linearised around = linearised(positions);
  const Index markers = std::ssize(marker_fields_);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const Eigen::VectorXd wanted = slopes.row(static_cast<Index>(i)).transpose();
    Eigen::VectorXd lacking(count());
    for (Index m = 0; 3 * m < markers; ++m)
      lacking.segment<3>(3 * m) = wanted.segment<3>(3 * m) - model_.markers[m].velocity(positions, moves[i]);
    for (std::size_t r = 0; r < ratios_.size(); ++r) {
      const Index q = markers + static_cast<Index>(r);
      lacking[q] =
          around.scales[q] * wanted[ratios_[r].output] - around.ratio_gradients[r].cwiseProduct(moves[i]).sum();
    }
    around.add(around.responses.solve(lacking), moves[i]);
  }
}

}  // namespace softkin::maps
