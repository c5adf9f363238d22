#include <softkin/io/table/csv.hpp>
#include <softkin/io/table/path_table.hpp>

namespace softkin {

Points read_path(const std::filesystem::path& path) {
  const CsvTable table = read_csv(path);
  for (const std::string& column : table.columns)
    if (column != "x_mm" && column != "y_mm" && column != "z_mm")
      table.fail_header("unknown column '" + column + "'; a path has x_mm, y_mm, z_mm");
  Points corners(table.rows.size(), 3);
  for (Index axis = 0; axis < 3; ++axis) {
    const std::string name = std::string(1, "xyz"[axis]) + "_mm";
    const auto column = table.find(name);
    if (!column) table.fail_header("the column '" + name + "' is missing");
    for (Index row = 0; row < corners.rows(); ++row) corners(row, axis) = table.rows[row][*column];
  }
  return corners;
}

}  // namespace softkin
