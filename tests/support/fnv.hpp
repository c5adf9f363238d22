#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>

namespace softkin::testing {

/// FNV-1a over the 8-byte words of numbers, as tests/io/read_shapes.py computes it.
class Fnv {
 public:
  Fnv& add(double value) { return add_word(std::bit_cast<std::uint64_t>(value)); }
  Fnv& add(std::int64_t value) { return add_word(static_cast<std::uint64_t>(value)); }

  [[nodiscard]] std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof(digits), "%016llx", static_cast<unsigned long long>(code_));
    return digits;
  }

 private:
  Fnv& add_word(std::uint64_t word) {
    code_ = (code_ ^ word) * 1099511628211ULL;
    return *this;
  }

  std::uint64_t code_ = 14695981039346656037ULL;
};

}  // namespace softkin::testing
