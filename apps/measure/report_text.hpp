#pragma once

#include <nlohmann/json.hpp>
#include <softkin/io/plain_text.hpp>

#include "cli/terminal.hpp"

namespace softkin::cli {

using Json = nlohmann::ordered_json;

/// Rows as lines with aligned columns. alignment: 'l' or 'r' for each column; every row has as many cells.
[[nodiscard]] std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows,
                                               const std::string& alignment);

void print(const Json& json);

}  // namespace softkin::cli
