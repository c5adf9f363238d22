#include "tables.hpp"

#include <cmath>

#include "cli/terminal.hpp"
#include "report_text.hpp"

namespace softkin::cli {

std::string NumberTable::csv() const {
  std::string text;
  for (const std::string& comment : comments) text += "# " + printable(comment) + "\n";
  for (std::size_t i = 0; i < columns.size(); ++i) text += (i > 0 ? "," : "") + columns[i];
  text += "\n";
  for (const std::vector<double>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      text += (i > 0 ? "," : "") + (row[i] == std::floor(row[i]) ? number(row[i], 9) : decimal(row[i], decimals));
    text += "\n";
  }
  return text;
}

}  // namespace softkin::cli
