#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <string>

namespace softkin::physical {

/// Describes the end of a path along which voltages rise: "; the voltage of ..." for each of them, with its value, and
/// where its layer has the largest field; "" where none rises.
///
/// from, here  load states at the start and at the end of the path
/// positions   the last equilibrium, #V by 3 [mm]
[[nodiscard]] std::string pull_in_text(const Model& model, const LoadState& from, const LoadState& here,
                                       const Points& positions);

}  // namespace softkin::physical
