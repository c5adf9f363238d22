#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softkin::runs {

/// What a map is written to for other programs. An empty file name: not that.
struct MapExport {
  std::string c, numpy, js;
  bool floats = false;  // in C

  /// Those of the module, beside it: robot.d.mts of robot.mjs.
  [[nodiscard]] std::string js_types() const;
};

struct ExportedFile {
  std::string file, text;
  std::string what;  // "35.6 kB; arm_fk(), ...; tables: 1216 bytes of flash ..."
};

/// throws  InvalidInput naming the map, or where softkin was built without the page that a module takes its code from
[[nodiscard]] std::vector<ExportedFile> exported_files(const std::filesystem::path& map, const MapExport& to);

}  // namespace softkin::runs
