#include "report_text.hpp"

#include <softkin/io/json_text.hpp>
#include <softkin/io/table/table.hpp>

namespace softkin::cli {

std::vector<std::string> aligned(const std::vector<std::vector<std::string>>& rows, const std::string& alignment) {
  Table table;
  for (const char side : alignment) table.columns.push_back({.left = side == 'l'});
  for (const auto& row : rows) table.rows.emplace_back(row.begin(), row.end());
  return table.body();
}

void print(const Json& json) {
  print(json_text(json) + "\n");
}

}  // namespace softkin::cli
