#pragma once

#include <cstddef>
#include <cstdint>
#include <softkin/io/scanner.hpp>

namespace softkin {

/// The number types of VTK files.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] std::size_t size_of(NumberType type);
[[nodiscard]] bool is_integer(NumberType type);

/// Numbers out of a scanner, as text or binary (swap: not in this machine's byte order).
class NumberReader {
 public:
  NumberReader(Scanner& scanner, bool binary, bool swap) : scanner_(scanner), binary_(binary), swap_(swap) {}

  /// A finite number of any type.
  double real(NumberType type, const char* what);
  /// A number of an integer type, which must fit 64 bits with sign.
  std::int64_t integer(NumberType type, const char* what);
  /// Fails unless count numbers can still follow.
  void require(std::uint64_t count, NumberType type, const char* what) const;

 private:
  template <class T>
  double next_real(const char* what);
  template <class T>
  std::int64_t next_integer(const char* what);

  Scanner& scanner_;
  bool binary_, swap_;
};

}  // namespace softkin
