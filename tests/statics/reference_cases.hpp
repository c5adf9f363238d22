#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/statics/statics.hpp>
#include <sstream>

#include "statics/robots.hpp"
#include "support/skips.hpp"

/// table: of the reference solutions, by its name
#define SKIP_WITHOUT_TABLE(table) \
  if (softkin::testing::reference_file(table).empty()) GTEST_SKIP() << softkin::testing::absent_reference << (table)

namespace softkin::testing {

/// A file of the reference solutions: the small ones are in tests/reference, the others in the folder of the reference
/// data. Empty where it is absent.
inline std::filesystem::path reference_file(const std::string& name) {
  for (const std::filesystem::path& folder :
       {std::filesystem::path(SOFTKIN_SOURCE_DIR "/tests/reference"), reference_folder() / "fem"})
    if (std::filesystem::exists(folder / name)) return folder / name;
  return {};
}

/// A table of the reference solutions, columns by name. Cells may be nan, which softkin's own reader refuses.
class ReferenceTable {
 public:
  explicit ReferenceTable(const std::string& name) {
    std::ifstream file(reference_file(name));
    std::string line, cell;
    if (!std::getline(file, line)) throw InvalidInput("no table " + name);
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) columns_.push_back(cell);
    while (std::getline(file, line)) {
      rows_.emplace_back();
      for (std::istringstream cells(line); std::getline(cells, cell, ',');) rows_.back().push_back(std::stod(cell));
    }
  }

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  [[nodiscard]] double at(std::size_t row, const std::string& column) const {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    if (found == columns_.end()) throw InvalidInput("no column " + column);
    return rows_.at(row).at(found - columns_.begin());
  }
  [[nodiscard]] Vec3 point(std::size_t row, const std::string& name) const {
    return {at(row, name + "_x"), at(row, name + "_y"), at(row, name + "_z")};
  }

  /// The rows that a test solves, without the first, at rest, and the `lost` last ones: every `every`-th one and the
  /// last; all of them where the environment sets SOFTKIN_EVERY_ROW.
  [[nodiscard]] std::vector<std::size_t> chosen(std::size_t every, std::size_t lost = 0) const {
    const std::size_t end = rows_.size() - lost;
    if (std::getenv("SOFTKIN_EVERY_ROW")) every = 1;
    std::vector<std::size_t> rows;
    for (std::size_t row = every; row < end; row += every) rows.push_back(row);
    if (rows.empty() || rows.back() + 1 != end) rows.push_back(end - 1);
    return rows;
  }

 private:
  std::vector<std::string> columns_;
  std::vector<std::vector<double>> rows_;
};

enum class ReferenceLaw { lin, nh };

/// The material of the reference: St. Venant-Kirchhoff, or W = mu/2 (bar I1 - 3) + K/2 (J - 1)^2 of the same E and nu.
inline MaterialSpec reference_material(const std::string& region, ReferenceLaw law, double e, double nu) {
  ElasticSpec elastic;
  if (law == ReferenceLaw::lin) {
    elastic.law = Law::st_venant_kirchhoff;
    elastic.youngs_modulus = e;
    elastic.poisson_ratio = nu;
  } else {
    elastic.law = Law::mooney_rivlin;
    elastic.c10 = e / (4 * (1 + nu));
    elastic.c01 = 0;
    elastic.bulk_modulus = e / (3 * (1 - 2 * nu));
  }
  MaterialSpec material;
  material.region = region;
  material.shape_ratio.reset();
  material.elastic = elastic;
  return material;
}

/// A mesh of the reference as a robot without actuators.
inline RobotSpec reference_robot(const std::string& mesh, bool quadratic) {
  RobotSpec spec;
  spec.name = mesh;
  spec.formulation = Formulation::physical;
  const std::filesystem::path small = reference_file(mesh + ".vtu");
  spec.mesh = read_mesh(small.empty() ? reference_file(mesh + ".msh") : small);
  spec.mesh_options.quadratic = quadratic;
  spec.markers.push_back({"tip", {std::string("tip_marker"), {}}});
  return spec;
}

/// Largest differences from the reference over a sweep.
struct Deviation {
  double tip_mm = 0;
  double multiplier = 0;  // relative
  int rows = 0;

  void add(double distance, double relative) {
    tip_mm = std::max(tip_mm, distance);
    multiplier = std::max(multiplier, std::abs(relative));
    ++rows;
  }
  void print(const std::string& name) const {
    std::printf("  %-42s rows %2d, tip %.5f mm, multiplier %.5f %%\n", name.c_str(), rows, tip_mm, 100 * multiplier);
  }
};

}  // namespace softkin::testing
