#pragma once

#include <filesystem>
#include <map>
#include <softkin/model/mesh/mesh.hpp>
#include <string>
#include <utility>
#include <vector>

namespace softkin {

/// Legacy .vtk unstructured grid, versions 2.0 to 5.1, ASCII and binary. Cells: tetrahedra (of order 1 or 2)
/// and wedges; triangles, quads, lines and vertices only as parts of regions, triangles of order 2 by their corners.
/// Integer cell arrays of one component with at most 1000 distinct values become regions "ARRAY_VALUE"; where a value
/// covers cells of several dimensions, the highest has that name and the others "ARRAY_VALUE_2d", "_1d", "_0d". Other
/// arrays are not read. Wedges keep the order of their vertices.
///
/// throws  InvalidInput naming file and line (byte in binary files)
[[nodiscard]] Mesh read_vtk(const std::filesystem::path& path);

/// XML .vtu of one piece: ascii, binary (base64) and appended (raw, base64), zlib-compressed or not. Cells and regions
/// as in read_vtk; where the file names them (as write_vtu does), by that name.
///
/// throws  InvalidInput naming file and line (byte in appended data)
[[nodiscard]] Mesh read_vtu(const std::filesystem::path& path);

/// The points of a .vtu alone, in the file's order. Throws as read_vtu.
[[nodiscard]] Points read_vtu_points(const std::filesystem::path& path);

/// Vectors in the cells of a .vtu.
struct CellVectors {
  Points centers, values;  // #cells by 3: means of a cell's vertices, in the file's unit; values of the array
};
/// A cell array of three components by its name. Throws as read_vtu, and where there is no such array
[[nodiscard]] CellVectors read_vtu_cell_vectors(const std::filesystem::path& path, const std::string& array);

/// A named array over points or cells: count * components values.
struct Field {
  std::string name;            // printable, once in its place
  int components = 1;          // values of each point or cell
  std::vector<double> values;  // those of the first point or cell, of the second, ...
};

/// What ParaView shows: cells are the tetrahedra, then the prisms, the triangles and the single points.
struct VtuContent {
  Points points;                                 // [mm]
  std::vector<Tetrahedron> tetrahedra;           // corners
  std::vector<EdgeNodes> edge_nodes;             // order 2: of every tetrahedron, and no prisms; order 1: empty
  std::vector<Prism> prisms;                     // corners
  std::vector<Triangle> triangles{};             // of a surface
  bool cloud = false;                            // every point is a cell of its own too
  std::vector<Field> point_fields, cell_fields;  // over points, over cells
  std::vector<Index> cell_regions;               // per cell, index into region_names or -1; empty: none
  std::vector<std::string> region_names;         // by their numbers
  std::vector<std::pair<std::string, double>> constants{};  // numbers of the whole, by name
  std::vector<Field> arrays{};                              // of the whole: any number of values
};

/// Writes a .vtu that ParaView, meshio and read_vtu read: arrays in base64, zlib-compressed, fields as Float64. Regions
/// are the cell array "region" (Int32); the field array "region_NAME" has the number of each as its only value.
///
/// throws  InvalidInput naming the field, cell or region: no points, a value that is not finite, a length other than
///         count * components, a vertex or region outside its range, tetrahedra of two orders or of order 2 beside
///         prisms, names that are empty, repeated or not printable; constants and arrays are field arrays
void write_vtu(const std::filesystem::path& path, const VtuContent& content);

/// The field arrays of a .vtu that hold real numbers, by name. Throws as read_vtu.
[[nodiscard]] std::map<std::string, std::vector<double>> read_vtu_arrays(const std::filesystem::path& path);
/// A point array of three components by its name. Throws as read_vtu, and where there is no such array
[[nodiscard]] Points read_vtu_point_vectors(const std::filesystem::path& path, const std::string& array);

/// Collection of .vtu files over a parameter; `file` is relative to the .pvd's folder.
struct PvdEntry {
  double time = 0;   // or another parameter
  std::string file;  // of the .vtu, relative to the collection's folder
};

/// Throws InvalidInput where a time is not finite or a file name is empty or not printable.
void write_pvd(const std::filesystem::path& path, const std::vector<PvdEntry>& entries);

}  // namespace softkin
