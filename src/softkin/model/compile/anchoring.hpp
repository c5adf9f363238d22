#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// Refuses a robot that its fixed vertices do not hold: every part (connected through elements, rigid regions and the
/// triangles of cables) must be unable to move rigidly, to first order.
///
/// throws  InvalidInput at origin that names the first five such parts and how each can move
void check_anchoring(const Model& model, const Origin& origin);

}  // namespace softkin
