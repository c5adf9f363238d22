#pragma once

#include <filesystem>
#include <memory>
#include <softkin/io/mesh/abaqus_cards.hpp>
#include <softkin/io/scanner.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin {

/// A keyword in capitals, with one blank where there are several.
[[nodiscard]] std::string abaqus_key(std::string_view text);
/// The fields of a line: cut at commas outside of quotes, without the blanks around them.
[[nodiscard]] std::vector<std::string_view> abaqus_fields(std::string_view line);
/// Without the double quotes around it.
[[nodiscard]] std::string without_quotes(std::string_view text);

/// The lines of an Abaqus deck that are neither blank nor a comment; in the place of *INCLUDE those of the file that it
/// names. Names are relative to the deck's folder and cannot leave it.
class AbaqusLines {
 public:
  explicit AbaqusLines(const std::filesystem::path& deck);

  /// The next line, without the blanks around it, and where it stands; false: the deck ends. text stays valid.
  /// throws  InvalidInput naming the line of *INCLUDE, where its file is not there, lies outside of the deck's folder
  ///         or includes itself, or where too many files are included
  bool next(std::string_view& text, AbaqusLine& place);

  /// The deck, then what it includes; of a file that is read twice both times.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }
  [[nodiscard]] Origin origin(AbaqusLine line) const { return {files_[line.file], line.line}; }

 private:
  struct Open {
    std::filesystem::path path;
    std::uint32_t file;
    std::unique_ptr<Scanner> scanner;
  };

  void include(std::string text, AbaqusLine place);
  [[nodiscard]] std::filesystem::path inside_folder(const std::string& name, AbaqusLine place) const;
  [[noreturn]] void fail(AbaqusLine place, const std::string& message) const;

  std::filesystem::path folder_;
  std::vector<std::string> files_;
  std::vector<Open> open_;                        // each includes the next one
  std::vector<std::unique_ptr<Scanner>> closed_;  // whose text is still in use
};

}  // namespace softkin
