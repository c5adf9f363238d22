#pragma once

#include <optional>
#include <softkin/io/picture/picture.hpp>
#include <softkin/model/mesh/box_tree.hpp>
#include <softkin/model/model.hpp>

namespace softkin::runs {

/// The obstacles, see-through, so that they hide no robot: what of them is no farther from its box than half of the
/// box's diagonal. Of a half-space a square of its plane, a little larger than the robot's shadow on it.
///
/// positions  #V by 3 [mm]
/// robot      around all of it that is drawn [mm]
/// returns    none where nothing is so near
[[nodiscard]] std::optional<PictureLayer> obstacle_layer(const Model& model, const Points& positions,
                                                         const Bounds& robot);

/// The bodies where they are [mm]; none without any.
[[nodiscard]] std::optional<PictureLayer> body_layer(const Model& model, const Points& positions);

}  // namespace softkin::runs
