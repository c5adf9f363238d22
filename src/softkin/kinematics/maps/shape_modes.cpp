#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/kinematics/maps/shape_modes.hpp>

namespace softkin::maps {

namespace {

double largest_vertex(const Eigen::MatrixXf& moves) {
  double largest = 0;
  for (Index s = 0; s < moves.cols(); ++s)
    for (Index v = 0; v + 2 < moves.rows(); v += 3)
      largest = std::max<double>(largest, moves.col(s).segment<3>(v).norm());
  return largest;
}

}  // namespace

MapShape shape_modes(const std::vector<const Sample*>& samples, double accuracy_mm) {
  constexpr double most = 32767;
  const Index count = samples.size();
  Eigen::MatrixXf left(samples.front()->state.positions.size(), count);  // remainder without the modes found yet
  for (Index s = 0; s < count; ++s) {
    const Points& at = samples[s]->state.positions;
    left.col(s) = Eigen::Map<const Eigen::VectorXd>(at.data(), at.size()).cast<float>();
  }
  MapShape shape;
  shape.mean = left.rowwise().mean();
  Eigen::MatrixXf modes(left.rows(), 0);  // orthonormal
  left.colwise() -= shape.mean;
  const Eigen::MatrixXd gram = (left.transpose() * left).cast<double>();
  const SymmetricEigen eigen = symmetric_eigen(gram);
  for (Index m = count; m-- > 0 && largest_vertex(left) > accuracy_mm;) {
    Eigen::VectorXf mode = left * eigen.vectors.col(m).cast<float>();
    mode -= modes * (modes.transpose() * mode);
    if (!(mode.norm() > 0)) break;
    mode.normalize();
    left -= mode * (mode.transpose() * left);
    modes.conservativeResize(Eigen::NoChange, modes.cols() + 1);
    modes.col(modes.cols() - 1) = mode;
  }
  shape.units = (modes.cwiseAbs().colwise().maxCoeff() / static_cast<float>(most)).cast<double>();
  shape.modes.resize(modes.rows(), modes.cols());
  for (Index m = 0; m < modes.cols(); ++m)
    shape.modes.col(m) = (modes.col(m).cast<double>() / shape.units[m]).array().round().cast<std::int16_t>();
  return shape;
}

RowMatrix random_commands(const MapData& data, Index count, std::uint64_t seed) {
  constexpr double steps = 9007199254740992.0;  // 2^53
  std::mt19937_64 generator(seed);
  RowMatrix commands(count, data.inputs.size());
  for (Index i = 0; i < count; ++i)
    for (Index j = 0; j < std::ssize(data.inputs); ++j) {
      const MapInput& input = data.inputs[j];
      const double fraction = static_cast<double>(generator() >> 11) / steps;
      commands(i, j) = input.low + fraction * (input.high - input.low);
    }
  return commands;
}

}  // namespace softkin::maps
