#pragma once

#include <softkin/io/table/tensile_file.hpp>

namespace softkin {

/// The rows of a branch of a tensile test, with strains that ascend; how many were left out is in the notes.
[[nodiscard]] TensileCurve branch_of(const TensileCurve& curve, TensileBranch which);

/// Strains and stresses from where the strain is 0; rows before that are left out.
///
/// throws  InvalidInput where the beginning of the curve gives no such strain
void set_zero(TensileCurve& curve, TensileZero zero);

}  // namespace softkin
