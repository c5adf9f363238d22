#pragma once

#include <array>
#include <filesystem>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <vector>

namespace softkin {

/// A surface to draw: triangles over points [mm], one value per point for colour (empty: one plain colour).
struct PictureLayer {
  Points points;
  std::vector<Triangle> triangles;
  std::vector<double> values;
  std::array<double, 3> color{0.75, 0.75, 0.75};  // where there are no values
  double opacity = 1;                             // in (0, 1]; below 1: see-through, only its nearest surface shows
  bool edges = true;                              // draw the triangles' edges thinly, where they are large enough
  bool behind = false;                            // see-through: shows only where nothing solid does
};

/// A polyline over the layers, hidden by none of them; one point is a dot or a cross.
struct PictureMark {
  enum class Sign { dot, cross };

  Points points;      // [mm], at least one
  std::string label;  // next to its last point
  std::array<double, 3> color{0, 0, 0};
  Sign sign = Sign::dot;
};

struct PictureOptions {
  int width = 1280, height = 800;  // [pixel], each in [64, 8192]
  Vec3 view{-0.5, -1.0, 0.45};     // direction from the scene to the eye
  Vec3 up{0, 0, 1};                // upwards in the picture; not parallel to view
  std::string title;               // text above
  std::string value_label;         // text at the colour bar, with unit, e.g. "displacement [mm]"
};

/// Renders an orthographic view without any window system and writes a PNG: shading, colour bar, scale bar in mm.
///
/// The values of all layers have one colour map, from the smallest to the largest; a surface that faces the eye has the
/// map's very colour, the light comes from the upper left. The triangles fill 90 % of the area left to them; pictures
/// below 320 x 240 have no title, bars or axes and are all area. Text outside ASCII appears as empty boxes. A
/// see-through surface hides where it is not nearer than the solid one by 0.5 % of the layers' size: there both are the
/// same place. Marks count as part of what the picture has to hold.
///
/// throws  InvalidInput, naming the path and what is wrong: no triangle, or none with an area in this view; points or
///         values that are not finite, a mark without points; a value count other than the points'; triangles that
///         name no point; colour, opacity, width or height out of range; view and up zero or parallel; a path that
///         cannot be written
void write_picture(const std::filesystem::path& path, const std::vector<PictureLayer>& layers,
                   const PictureOptions& options = {}, const std::vector<PictureMark>& marks = {});

/// The content of the file. path: for messages alone
[[nodiscard]] std::string picture_png(const std::filesystem::path& path, const std::vector<PictureLayer>& layers,
                                      const PictureOptions& options = {}, const std::vector<PictureMark>& marks = {});

}  // namespace softkin
