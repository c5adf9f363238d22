#pragma once

#include <filesystem>
#include <softkin/model/measurements.hpp>
#include <string>

namespace softkin {

/// Which rows of a tensile test count.
enum class TensileBranch {
  envelope,  // those whose strain exceeds all strains before: the first loading, through all cycles
  first,     // the loading of the first cycle
  last       // the loading of the last cycle: of a material that was stretched before
};

/// Where the strain is 0.
enum class TensileZero {
  file,   // as the file has it
  first,  // at the first row, whose stress is taken off all stresses
  toe     // where the straight line through the beginning of the curve has no stress: slack or a preload is taken out
};

/// How the file of a testing machine is read.
struct TensileLayout {
  std::string strain_column, stress_column;       // names in the file; empty: found by what they are called
  std::string strain_unit, stress_unit;           // "%", "kPa"; empty: as the columns state
  bool true_strain = false, true_stress = false;  // of columns that are named: logarithmic; over the present area
  double length_mm = 0, area_mm2 = 0;             // of the specimen, for columns of elongations and forces
  TensileBranch branch = TensileBranch::envelope;
  TensileZero zero = TensileZero::file;

  [[nodiscard]] bool is_default() const {
    return strain_column.empty() && stress_column.empty() && strain_unit.empty() && stress_unit.empty() &&
           length_mm == 0 && area_mm2 == 0 && branch == TensileBranch::envelope && zero == TensileZero::file;
  }
};

/// A tensile test as testing machines write it: cells separated by commas, semicolons or tabs, with decimal points or,
/// where cells are not separated by commas, decimal commas; lines before the header are passed over. Columns of nominal
/// (engineering) strain and stress are taken before true ones, which are converted at constant volume: strain =
/// exp(true strain) - 1, stress = true stress / (1 + strain). What was taken and left out is in the notes of the curve.
///
/// throws  InvalidInput naming file and line: no header with a strain and a stress, several columns that may be meant,
///         a unit that is missing or not known, a cell that is no number, fewer than five rows
[[nodiscard]] TensileCurve read_tensile_file(const std::filesystem::path& path, const TensileLayout& layout);

/// Is this the file of a testing machine: not a table whose first line names columns as softkin does (strain,
/// stress_mpa), but with a line somewhere that is a header of strains and stresses?
[[nodiscard]] bool is_machine_file(const std::string& text);

/// The same of the text of a file.
[[nodiscard]] TensileCurve parse_tensile_file(const std::string& file, const std::string& text,
                                              const TensileLayout& layout);

}  // namespace softkin
