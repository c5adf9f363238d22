#include "columns.hpp"

#include <algorithm>

#include <softkin/model/names.hpp>
#include "mesh_text.hpp"
#include "terminal.hpp"

namespace softkin::cli {

namespace {

constexpr std::size_t longest_name = 16;
constexpr int command_decimals = 4;

}  // namespace

void Columns::add(const std::string& header, std::size_t width) {
  headers_.push_back(header);
  widths_.push_back(std::max(width, characters(header)));
}

void Columns::add_command(const Actuator& actuator) {
  const std::string name = characters(actuator.name) > longest_name ? "command" : actuator.name;
  add(name + " " + bracketed_unit(actuator), std::max(command(actuator.high).size(), command(actuator.low).size()));
}

std::string Columns::row(const std::vector<std::string>& cells) const {
  std::string line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t length = characters(cells[i]);
    line += std::string(length < widths_[i] ? widths_[i] - length : 0, ' ') + cells[i] + "  ";
  }
  return line;
}

std::string Columns::command(double value) {
  return decimal(value, command_decimals);
}

}  // namespace softkin::cli
