#pragma once

#include <optional>
#include <softkin/vision/camera.hpp>
#include <softkin/vision/pictures.hpp>
#include <string>
#include <vector>

namespace softkin::vision {

/// What sets a robot apart from the ground behind it: a colour, or that it is darker or brighter.
struct SilhouetteLook {
  std::string name;              // as requested: "red", "#rrggbb", "dark", "bright"
  std::optional<Colour> colour;  // none: by brightness

  /// throws  InvalidInput: no such colour
  explicit SilhouetteLook(const std::string& requested);
};

/// The outer outline of a robot in a picture; holes have no part in it.
struct Silhouette {
  std::vector<Vec2> points;  // one after another along it, some 400 at most, without those at the frame [mm]
  double length = 0;         // of the whole outline [mm]
  double area = 0;           // that it encloses, holes too [mm^2]
  bool cut = false;          // does it reach the frame, beyond which the robot may go on?
};

/// The outline of the largest part of a picture that has a look, to a fraction of a pixel: where the picture is half of
/// the one and half of the other colour on both sides of it.
///
/// source  dark and bright by the threshold of Otsu, A threshold selection method from gray-level histograms, IEEE
///         Trans. SMC 9, 1979
/// throws  InvalidInput: no such part, or one that reaches all sides of the picture and so is the ground
[[nodiscard]] Silhouette find_silhouette(const RgbImage& picture, const SilhouetteLook& look, const PlaneView& view);

}  // namespace softkin::vision
