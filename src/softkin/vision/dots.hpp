#pragma once

#include <softkin/vision/camera.hpp>
#include <softkin/vision/pictures.hpp>

namespace softkin::vision {

/// Where a marker is.
struct MarkerPlace {
  Vec2 pixel = Vec2::Zero();  // as seen [px]
  Vec2 place = Vec2::Zero();  // [mm]
  double error = 0;           // standard error along an axis, from the picture's noise and the plane's fit [mm]
};

/// The one round dot of a colour in a picture, to a fraction of a pixel.
///
/// The centre is that of the fraction of dot colour, from 0 on the ground around it to 1 in its middle, over the area
/// of the plane that each pixel sees: blur does not move it, and neither do perspective and lens.
///
/// name    of the marker, for messages
/// throws  InvalidInput naming the marker: no such dot, two that could be it, too near to the frame, over-exposed
[[nodiscard]] MarkerPlace find_dot(const RgbImage& picture, const Colour& colour, const PlaneView& view,
                                   const std::string& name);

}  // namespace softkin::vision
