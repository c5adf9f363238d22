#pragma once

#include <filesystem>
#include <string>

namespace softkin {

/// Says where a file that is not there comes from, as far as the folder of what needs it shows: a script or a Gmsh
/// model that makes it, or a README that names it.
///
/// folder   of what needs the file
/// returns  "'python3 F/make_beam.py' makes it", "F/README.md says where it comes from"; "": the folder shows nothing
[[nodiscard]] std::string source_of_missing(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace softkin
