#pragma once

#include <filesystem>
#include <softkin/model/mesh.hpp>

namespace softkin {

/// Legacy .vtk unstructured grid, ASCII and binary. Integer cell arrays become regions "ARRAY_VALUE".
[[nodiscard]] Mesh read_vtk(const std::filesystem::path& path);

/// XML .vtu: ascii, binary (base64) and appended (raw, base64), zlib-compressed or not. Regions as in read_vtk;
/// where the file names them (as write_vtu does), by that name.
[[nodiscard]] Mesh read_vtu(const std::filesystem::path& path);

/// A named array over points or cells: count * components values.
struct Field {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

/// A deformed robot as ParaView shows it: cells are the tetrahedra, then the prisms.
struct VtuContent {
  Points points;  // [mm]
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Prism> prisms;
  std::vector<Field> point_fields, cell_fields;
  std::vector<Index> cell_regions;  // per cell, index into region_names or -1; empty: none
  std::vector<std::string> region_names;
};

void write_vtu(const std::filesystem::path& path, const VtuContent& content);

/// Collection of .vtu files over a parameter; `file` is relative to the .pvd's folder.
struct PvdEntry {
  double time = 0;
  std::string file;
};
void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries);

}  // namespace softkin
