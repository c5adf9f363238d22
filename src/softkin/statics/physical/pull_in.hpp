#pragma once

#include <softkin/model/model.hpp>
#include <softkin/statics/physical/iterate.hpp>
#include <string>

namespace softkin::physical {

/// Where a way ends along which voltages rise: "; the voltage of ..." for each of them, with its value, and where its
/// layer has the largest field; "" where none rises.
///
/// from, here  demands at the begin and at the end of the way
/// positions   the last equilibrium, #V by 3 [mm]
[[nodiscard]] std::string pull_in_text(const Model& model, const Demand& from, const Demand& here,
                                       const Points& positions);

}  // namespace softkin::physical
