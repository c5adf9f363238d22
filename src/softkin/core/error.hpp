#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace softkin {

/// Where in the user's input something stands; prints as "file:line", "file: byte N" or "file".
struct Origin {
  std::string file;
  std::size_t line = 0;  // from 1; 0: not known
  std::size_t byte = 0;  // from 0; used where binary is set
  bool binary = false;

  [[nodiscard]] std::string text() const;
};

/// Input that softkin refuses. what() is one sentence that begins with the origin, on one line and safe to print
/// whatever it repeats of a file.
class InvalidInput : public std::runtime_error {
 public:
  explicit InvalidInput(const std::string& message);
  InvalidInput(const Origin& origin, const std::string& message);
};

/// The candidate nearest in spelling to name, or that it is the beginning of; "" where none is near.
[[nodiscard]] std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// "; did you mean 'x'?" with the nearest candidate, else "; known: a, b, c", else "".
[[nodiscard]] std::string suggest_name(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace softkin
