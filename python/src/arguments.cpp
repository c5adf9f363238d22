#include "arguments.hpp"

#include <algorithm>
#include <map>

namespace softkin::python {

namespace {

bool is_letter(char c) {
  return c >= 'a' && c <= 'z';
}

/// Those that are not called as the option is.
const std::map<std::string, std::string>& renamed() {
  static const std::map<std::string, std::string> names{{"angle", "angles"},
                                                        {"atmosphere", "atmosphere_kPa"},
                                                        {"breakdown-field", "breakdown_kV_mm"},
                                                        {"force", "forces"},
                                                        {"height", "height_mm"},
                                                        {"max-step", "max_step_mm"},
                                                        {"modulus-b", "modulus_b_MPa"},
                                                        {"pressure", "scale"},
                                                        {"resume", "store"},
                                                        {"set", "command"},
                                                        {"shear-modulus", "shear_modulus_MPa"},
                                                        {"start", "start_s"},
                                                        {"stiffer", "stiffer_shape_ratio"},
                                                        {"sum", "sum_of"},
                                                        {"thickness", "thickness_mm"},
                                                        {"try", "tried"},
                                                        {"width", "width_mm"}};
  return names;
}

}  // namespace

std::string with_arguments(const std::string& message) {
  std::string text;
  std::size_t at = 0;
  while (at < message.size()) {
    const bool begins = at == 0 || message[at - 1] == ' ' || message[at - 1] == '(' || message[at - 1] == '\'';
    if (!begins || message.compare(at, 2, "--") != 0 || at + 2 == message.size() || !is_letter(message[at + 2])) {
      text += message[at++];
      continue;
    }
    std::size_t end = at + 2;
    while (end < message.size() && (is_letter(message[end]) || message[end] == '-')) ++end;
    std::string name = message.substr(at + 2, end - at - 2);
    if (const auto other = renamed().find(name); other != renamed().end()) name = other->second;
    std::replace(name.begin(), name.end(), '-', '_');
    text += name;
    at = end;
  }
  return text;
}

}  // namespace softkin::python
