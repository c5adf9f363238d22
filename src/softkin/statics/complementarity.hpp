#pragma once

#include <Eigen/Core>

namespace softkin {

/// The x >= 0 with matrix x + offset >= 0 of which, entry by entry, one is zero.
///
/// matrix   with positive principal minors
/// returns  zero where nothing is found, as may be with another matrix
/// source   Murty 1974: Bard's scheme with the least index, finite for every P-matrix
[[nodiscard]] Eigen::VectorXd complementary(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& offset);

}  // namespace softkin
