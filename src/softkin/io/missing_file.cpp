#include <algorithm>
#include <softkin/core/error.hpp>
#include <softkin/io/file.hpp>
#include <softkin/io/missing_file.hpp>
#include <system_error>
#include <vector>

namespace softkin {

namespace fs = std::filesystem;

namespace {

bool mentions(const fs::path& text_file, const std::string& name) {
  constexpr std::size_t most = 1 << 20;  // scripts and READMEs are shorter
  try {
    return read_beginning(text_file, most).find(name) != std::string::npos;
  } catch (const InvalidInput&) {  // an unreadable file mentions nothing
    return false;
  }
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (fs::directory_iterator at(folder.empty() ? fs::path(".") : folder, failure), end; !failure && at != end;
       at.increment(failure))
    if (std::error_code of_file; at->is_regular_file(of_file)) files.push_back(folder / at->path().filename());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string source_of_missing(const fs::path& folder, const fs::path& file) {
  const std::string name = file.filename().string();
  if (name.empty()) return "";
  const std::vector<fs::path> files = files_in(folder);
  for (const fs::path& each : files)
    for (const auto& [ending, program] : {std::pair(".py", "python3 "), std::pair(".sh", "sh ")})
      if (each.extension() == ending && mentions(each, name)) return "'" + (program + each.string()) + "' makes it";
  const fs::path model = folder / (file.stem().string() + ".geo");
  if (file.extension() == ".msh" && std::find(files.begin(), files.end(), model) != files.end())
    return "'gmsh -3 " + model.string() + " -o " + file.string() + "' makes it";
  for (const fs::path& each : files)
    if (each.filename() == "README.md" && mentions(each, name)) return each.string() + " says where it comes from";
  return "";
}

}  // namespace softkin
