#pragma once

#include <string>
#include <vector>

namespace softkin {

/// A material of softkin's table that a scene names, for notes and reports.
struct NamedMaterial {
  /// One set of constants that the table has of it.
  struct Set {
    std::string name;               // "datasheet", "yeoh", ...
    double youngs_modulus_MPa = 0;  // at small strain
  };

  std::string name;       // "dragon-skin-30"
  std::string set;        // whose constants the scene has
  std::string source;     // of these
  std::vector<Set> sets;  // all of the material
};

}  // namespace softkin
