#pragma once

#include <string>
#include <vector>

namespace softkin::runs {

/// Short names of files, by which a legend tells them apart: their stems where these differ, else their names, else as
/// many folders before those as it takes; what has one path several times is numbered.
///
/// tails    what is added to each, such as "@tip"; none, or as many as files
/// returns  as many as files
[[nodiscard]] std::vector<std::string> file_labels(const std::vector<std::string>& files,
                                                   const std::vector<std::string>& tails = {});

}  // namespace softkin::runs
