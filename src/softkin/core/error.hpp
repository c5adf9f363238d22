#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace softkin {

/// Where in the user's input something stands; prints as "file:line", "file: byte N" or "file".
struct Origin {
  std::string file;      // its name, as the user gave it; empty: not from a file
  std::size_t line = 0;  // from 1; 0: not known
  std::size_t byte = 0;  // from 0; used where binary is set
  bool binary = false;   // has the file no lines, so that byte counts

  [[nodiscard]] std::string text() const;  // as it is printed
};

/// Input that softkin refuses. what() is one sentence that begins with the origin, on one line and safe to print
/// whatever it repeats of a file.
class InvalidInput : public std::runtime_error {
 public:
  /// The message as it is; for input that stands in no file.
  explicit InvalidInput(const std::string& message);
  /// The message behind the origin's text().
  InvalidInput(const Origin& origin, const std::string& message);
};

/// The candidate nearest in spelling to name, or that it is the beginning of; "" where none is near.
[[nodiscard]] std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// "; did you mean 'x'?" with the nearest candidate, else "; known: a, b, c", else "".
[[nodiscard]] std::string suggest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace softkin
