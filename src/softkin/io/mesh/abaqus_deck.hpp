#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <softkin/io/scanner.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace softkin {

[[nodiscard]] std::string upper_case(std::string_view text);

/// Walks an Abaqus input file keyword by keyword; knows of comments, letter case, blanks and continued keyword lines.
class AbaqusDeck {
 public:
  explicit AbaqusDeck(const std::filesystem::path& path);

  bool next_keyword();  // passes over data lines that are left; false: the file ends
  bool next_data();     // next data line of this keyword; false: there is none

  [[nodiscard]] const std::string& keyword() const { return keyword_; }  // in capitals, single blanks, without '*'
  [[nodiscard]] bool has(const std::string& parameter) const { return parameters_.contains(parameter); }
  [[nodiscard]] std::string value(const std::string& parameter) const;     // "" where there is none
  [[nodiscard]] std::string required(const std::string& parameter) const;  // fails where there is none
  void allow(std::initializer_list<const char*> parameters) const;         // fails on any other, or one twice

  [[nodiscard]] const std::vector<std::string_view>& fields() const { return fields_; }  // of the data line
  [[nodiscard]] bool continued() const { return continued_; }                     // the data line ends in a comma
  [[nodiscard]] std::int64_t integer(std::size_t field, const char* what) const;  // from 1 to 2^31 - 1
  [[nodiscard]] double real(std::size_t field, const char* what) const;

  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] Origin origin(std::size_t line) const { return {file_, line}; }
  [[noreturn]] void fail(const std::string& message) const { throw InvalidInput(origin(line_), message); }

 private:
  bool peek();
  void read_parameters(std::string_view text);
  void add_parameter(std::string_view text);

  std::string file_;
  Scanner scanner_;
  bool peeked_ = false;
  std::string_view next_;  // the line ahead, valid where peeked_
  std::size_t next_line_ = 0;
  std::size_t line_ = 0;
  std::string keyword_;
  std::map<std::string, std::string> parameters_;
  std::string repeated_;  // a parameter that stands twice
  std::vector<std::string_view> fields_;
  bool continued_ = false;
};

}  // namespace softkin
