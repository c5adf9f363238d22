#pragma once

#include <string>
#include <vector>

namespace softkin::runs {

/// Short names of files for a legend: their stems where these differ, else their names, else with as many folders
/// before them as are needed to distinguish them; files of the same path are numbered.
///
/// tails    what is added to each, such as "@tip"; none, or as many as files
/// returns  as many as files
[[nodiscard]] std::vector<std::string> file_labels(const std::vector<std::string>& files,
                                                   const std::vector<std::string>& tails = {});

}  // namespace softkin::runs
