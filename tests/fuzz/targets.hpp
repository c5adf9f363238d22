#pragma once

#include <filesystem>
#include <softkin/core/types.hpp>
#include <softkin/model/model.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin::fuzz {

/// What the fuzzer made up: parts between lines "%%%", to be read from memory or from files of a temporary folder.
class Input {
 public:
  Input(std::string_view text, std::filesystem::path folder);

  [[nodiscard]] std::string part(std::size_t number) const;  // "" where there is none
  [[nodiscard]] std::size_t parts() const { return parts_.size(); }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  /// A file of that name that holds the part; where there is no such part, no file.
  [[nodiscard]] std::filesystem::path file(const std::string& name, std::size_t number = 0) const;

 private:
  std::vector<std::string_view> parts_;
  std::filesystem::path folder_;
};

/// What is fuzzed under one name. run returns or throws InvalidInput; anything else is a find.
struct Target {
  const char* name;
  const char* dictionary;  // NAME.dict
  void (*run)(const Input& input);
};

[[nodiscard]] std::vector<Target> mesh_targets();
[[nodiscard]] std::vector<Target> scene_targets();
[[nodiscard]] std::vector<Target> table_targets();
[[nodiscard]] std::vector<Target> result_targets();
/// Those of the program: softkin_fuzz has all of the above, softkin_fuzz_journals those of journals.
[[nodiscard]] std::vector<Target> all_targets();

/// Ends the program where what was read cannot be.
void require(bool holds, const char* what);
void require_finite(double value, const char* what);

// The robots that tables and reports are of.

/// A block: air, by volume, with a curve of pressures; tendon, by tension; markers tip and corner.
[[nodiscard]] const Model& finger();
/// Prisms: the dielectric elastomer skin, with a curve of voltages; marker tip.
[[nodiscard]] const Model& sheet();

}  // namespace softkin::fuzz
