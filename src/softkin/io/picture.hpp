#pragma once

#include <filesystem>
#include <softkin/model/mesh.hpp>
#include <string>

namespace softkin {

/// A surface to draw: triangles over points [mm], one value per point for colour (empty: one plain colour).
struct PictureLayer {
  Points points;
  std::vector<Triangle> triangles;
  std::vector<double> values;
  std::array<double, 3> color{0.75, 0.75, 0.75};  // where there are no values
  double opacity = 1;                             // 1: solid; below: see-through, drawn after the solid layers
  bool edges = true;                              // draw the triangles' edges thinly
};

struct PictureOptions {
  int width = 1280, height = 800;  // [pixel]
  Vec3 view{-0.5, -1.0, 0.45};     // direction from the scene to the eye
  Vec3 up{0, 0, 1};
  std::string title;        // text above
  std::string value_label;  // text at the colour bar, with unit, e.g. "displacement [mm]"
};

/// Renders an orthographic view without any window system and writes a PNG: shading, colour bar, scale bar in mm.
void write_picture(const std::filesystem::path& path, const std::vector<PictureLayer>& layers,
                   const PictureOptions& options = {});

}  // namespace softkin
