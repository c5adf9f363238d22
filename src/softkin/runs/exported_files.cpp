#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/runs/exported_files.hpp>
#include <softkin/runs/map_export.hpp>
#include <softkin/runs/map_export_text.hpp>
#include <softkin/runs/map_file.hpp>

namespace softkin::runs {

namespace {

/// "arm_fk(), ...; tables: 1216 bytes of flash ...": how it is called, and what the header says that it takes.
std::string c_summary(const MapData& data, const std::string& header) {
  const std::string text = c_name(data) + "_fk(), ...";
  const std::size_t from = header.find("Tables: "), end = header.find(" No heap.", from);
  return end == std::string::npos ? text : text + "; t" + header.substr(from + 1, end - from - 2);
}

ExportedFile exported_file(const std::string& file, std::string text, const std::string& what) {
  constexpr double kilo = 1000;
  const std::string size = number(static_cast<double>(text.size()) / kilo, 3) + " kB";
  return {file, std::move(text), size + (what.empty() ? "" : "; " + what)};
}

}  // namespace

std::string MapExport::js_types() const {
  return js.empty() ? "" : std::filesystem::path(js).replace_extension(".d.mts").string();
}

std::vector<ExportedFile> exported_files(const std::filesystem::path& map, const MapExport& to) {
  if (!to.js.empty()) (void)js_script();  // or it throws, whatever the map is
  const MapData data = read_map(map);
  std::vector<ExportedFile> all;
  try {
    if (!to.c.empty()) {
      const std::string header = map_c_header(data, to.floats ? CNumbers::floats : CNumbers::doubles);
      all.push_back(exported_file(to.c, header, c_summary(data, header)));
    }
    if (!to.numpy.empty()) all.push_back(exported_file(to.numpy, map_npz(data), ""));
    if (to.js.empty()) return all;
    all.push_back(
        exported_file(to.js, map_js_module(data), data.shape ? "" : "without the shape, which the map lacks"));
    all.push_back(exported_file(to.js_types(), map_js_types(data), "types"));
  } catch (const InvalidInput& error) {
    throw InvalidInput({map.string()}, error.what());
  }
  return all;
}

}  // namespace softkin::runs
