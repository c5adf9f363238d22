#include <algorithm>
#include <array>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/field_samples.hpp>

namespace softkin {

namespace {

/// What samples are of.
struct SampleKind {
  const char *name, *array;
  std::array<const char*, 6> columns;
};
constexpr SampleKind flux_densities{
    "a flux density", "flux_density_mT", {"x_mm", "y_mm", "z_mm", "bx_mT", "by_mT", "bz_mT"}};
constexpr SampleKind directions{"a direction", "direction", {"x_mm", "y_mm", "z_mm", "dx", "dy", "dz"}};
constexpr double same = 1e-4;  // of a grid's step: files have few digits

FieldSamples samples_of_csv(const std::filesystem::path& path, const SampleKind& of) {
  const CsvTable table = read_csv(path);
  for (const std::string& column : table.columns)
    if (std::find(of.columns.begin(), of.columns.end(), column) == of.columns.end())
      table.fail_header("unknown column '" + column + "'; " + of.name + " has x_mm, y_mm, z_mm, " + of.columns[3] +
                        ", " + of.columns[4] + ", " + of.columns[5]);
  const Index count = table.rows.size();
  FieldSamples samples{path.string(), Points(count, 3), Points(count, 3), true, table.lines};
  for (Index i = 0; i < 6; ++i) {
    const char* name = of.columns[i];
    const auto column = table.find(name);
    if (!column) table.fail_header(std::string("the column '") + name + "' is missing");
    Points& to = i < 3 ? samples.places : samples.values;
    for (Index row = 0; row < count; ++row) to(row, i % 3) = table.rows[row][*column];
  }
  return samples;
}

[[noreturn]] void fail(const FieldSamples& samples, std::size_t row, const std::string& message) {
  throw InvalidInput({.file = samples.file, .line = row < samples.lines.size() ? samples.lines[row] : 0}, message);
}

/// Where the planes of a grid are along an axis.
void find_planes(const FieldSamples& samples, Index axis, GridField& grid) {
  std::vector<double> at(samples.places.col(axis).begin(), samples.places.col(axis).end());
  std::sort(at.begin(), at.end());
  const double rounding = 1e-9 * (at.back() - at.front());
  at.erase(std::unique(at.begin(), at.end(), [&](double a, double b) { return b - a <= rounding; }), at.end());
  const Index count = at.size();
  const std::string name(1, "xyz"[axis]);
  if (count < 4)
    throw InvalidInput({samples.file},
                       "a grid needs at least 4 places along " + name + ", not " + std::to_string(count));
  const double step = (at.back() - at.front()) / (count - 1);
  for (Index i = 0; i < count; ++i)
    if (std::abs(at[i] - at.front() - i * step) > same * step)
      throw InvalidInput({samples.file}, "the grid is not regular: along " + name + " " + number(at[i]) +
                                             " mm stands where " + number(at.front() + i * step) + " mm would; its " +
                                             std::to_string(count) + " places reach from " + number(at.front()) +
                                             " to " + number(at.back()) + " mm");
  grid.low[axis] = at.front();
  grid.step[axis] = step;
  grid.counts[axis] = count;
}

FieldSamples read_samples(const std::filesystem::path& path, const SampleKind& of) {
  const std::string extension = path.extension().string();
  if (extension == ".csv") return samples_of_csv(path, of);
  if (extension != ".vtu")
    throw InvalidInput({path.string()},
                       std::string(of.name) + " is read from a .csv or a .vtu file, not from '" + extension + "'");
  CellVectors cells = read_vtu_cell_vectors(path, of.array);
  return {path.string(), std::move(cells.centers), std::move(cells.values), false, {}};
}

}  // namespace

FieldSamples read_field_samples(const std::filesystem::path& path) {
  return read_samples(path, flux_densities);
}

FieldSamples read_directions(const std::filesystem::path& path) {
  return read_samples(path, directions);
}

GridField grid_of(const FieldSamples& samples) {
  GridField grid;
  grid.file = samples.file;
  std::size_t points = 1;
  for (Index axis = 0; axis < 3; ++axis) {
    find_planes(samples, axis, grid);
    points *= grid.counts[axis];
  }
  const std::size_t rows = samples.places.rows();
  const std::string size = std::to_string(grid.counts[0]) + " x " + std::to_string(grid.counts[1]) + " x " +
                           std::to_string(grid.counts[2]) + " places";
  if (rows < points)
    throw InvalidInput({samples.file}, "the grid of " + size + " needs " + std::to_string(points) + " rows, not " +
                                           std::to_string(rows));
  grid.per_ampere.resize(points);
  std::vector<bool> there(points);
  for (std::size_t row = 0; row < rows; ++row) {
    std::size_t place = 0;
    for (Index axis = 2; axis >= 0; --axis)
      place = place * static_cast<std::size_t>(grid.counts[axis]) +
              static_cast<std::size_t>(std::lround((samples.places(row, axis) - grid.low[axis]) / grid.step[axis]));
    if (there[place]) fail(samples, row, "this place of the grid of " + size + " is there twice");
    there[place] = true;
    grid.per_ampere[place] = samples.values.row(row).transpose();
  }
  return grid;
}

}  // namespace softkin
