#include <softkin/core/dense.hpp>
#include <softkin/linear/anderson.hpp>

namespace softkin::linear {

void Anderson::restart() {
  step_changes_.clear();
  image_changes_.clear();
  last_step_.resize(0, 3);
}

Points Anderson::next(const Points& x, const Points& image) {
  const Points step = image - x;
  const double length = step.norm();
  if (last_step_.size() > 0 && length > 2 * shortest_) {
    restart();
  }
  if (last_step_.size() > 0) {
    if (static_cast<int>(step_changes_.size()) == window_) {
      step_changes_.erase(step_changes_.begin());
      image_changes_.erase(image_changes_.begin());
    }
    step_changes_.push_back(step - last_step_);
    image_changes_.push_back(image - last_image_);
    shortest_ = std::min(shortest_, length);
  } else {
    shortest_ = length;
  }
  last_step_ = step;
  last_image_ = image;

  const Index count = step_changes_.size();
  if (count == 0) return image;
  Eigen::MatrixXd normal(count, count);
  Eigen::VectorXd right(count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j <= i; ++j) normal(i, j) = normal(j, i) = step_changes_[i].cwiseProduct(step_changes_[j]).sum();
    right[i] = step_changes_[i].cwiseProduct(step).sum();
  }
  Points mixed = image;
  const Eigen::VectorXd fraction = MinimumNorm(normal).solve(right);
  for (Index i = 0; i < count; ++i) mixed -= fraction[i] * image_changes_[i];
  return mixed;
}

}  // namespace softkin::linear
