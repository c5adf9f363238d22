#pragma once

#include <softkin/model/model.hpp>
#include <softkin/model/paths.hpp>

namespace softkin::drive {

/// Gives chambers that are commanded by volume, and whose pressures have no other source, those of their measured
/// curves: of the branch that the scene names.
///
/// throws  InvalidInput naming file:line where a curve does not reach a row's ratio
void take_curve_pressures(const Model& model, Commands& commands);

}  // namespace softkin::drive
