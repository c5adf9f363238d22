#pragma once

#include <string>
#include <utility>
#include <vector>

namespace softkin {

/// A zip archive of files and their contents, not compressed; the same bytes whenever it is made.
///
/// source  PKWARE's APPNOTE 6.3, without extensions
/// throws  InvalidInput where it would be larger than 4 GiB, or has more than 65,535 files
[[nodiscard]] std::string zip_of(const std::vector<std::pair<std::string, std::string>>& files);

}  // namespace softkin
