// A namespace of its own for each target: the linker would take one of them for all.
#define SOFTKIN_JOINED(a, b) a##b
#define SOFTKIN_JOIN(a, b) SOFTKIN_JOINED(a, b)
#define Eigen SOFTKIN_JOIN(Eigen_, SOFTKIN_TARGET)

#include "dense_product.hpp"

#include <Eigen/Core>

namespace softkin::bench::SOFTKIN_TARGET {

template <class Number>
void multiply_dense(const Number* a, const Number* b, Number* c, Index size) {
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  Eigen::Map<Matrix>(c, size, size).noalias() =
      Eigen::Map<const Matrix>(a, size, size) * Eigen::Map<const Matrix>(b, size, size);
}

template void multiply_dense(const double*, const double*, double*, Index);
template void multiply_dense(const float*, const float*, float*, Index);

}  // namespace softkin::bench::SOFTKIN_TARGET
