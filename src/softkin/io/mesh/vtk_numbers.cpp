#include <cmath>
#include <cstdint>
#include <limits>
#include <softkin/io/mesh/vtk_numbers.hpp>
#include <string>
#include <utility>

namespace softkin {

std::size_t size_of(NumberType type) {
  switch (type) {
    case NumberType::int8:
    case NumberType::uint8:
      return 1;
    case NumberType::int16:
    case NumberType::uint16:
      return 2;
    case NumberType::int32:
    case NumberType::uint32:
    case NumberType::float32:
      return 4;
    default:
      return 8;
  }
}

bool is_integer(NumberType type) {
  return type != NumberType::float32 && type != NumberType::float64;
}

template <class T>
double NumberReader::next_real(const char* what) {
  if (!binary_) return scanner_.real(what);
  const double value = scanner_.binary<T>(what, swap_);
  if (!std::isfinite(value)) scanner_.fail(std::string(what) + " must be a finite number");
  return value;
}

template <class T>
std::int64_t NumberReader::next_integer(const char* what) {
  constexpr std::int64_t high = std::numeric_limits<std::int64_t>::max();
  constexpr bool wide = std::cmp_greater(std::numeric_limits<T>::max(), high);
  if (!binary_)
    return scanner_.integer(what, static_cast<std::int64_t>(std::numeric_limits<T>::min()),
                            wide ? high : static_cast<std::int64_t>(std::numeric_limits<T>::max()));
  const T value = scanner_.binary<T>(what, swap_);
  if (std::cmp_greater(value, high))
    scanner_.fail(std::string(what) + " is " + std::to_string(value) + ", which does not fit 64 bits with sign");
  return static_cast<std::int64_t>(value);
}

double NumberReader::real(NumberType type, const char* what) {
  if (type == NumberType::float32) return next_real<float>(what);
  if (type == NumberType::float64) return next_real<double>(what);
  return static_cast<double>(integer(type, what));
}

std::int64_t NumberReader::integer(NumberType type, const char* what) {
  switch (type) {
    case NumberType::int8:
      return next_integer<std::int8_t>(what);
    case NumberType::uint8:
      return next_integer<std::uint8_t>(what);
    case NumberType::int16:
      return next_integer<std::int16_t>(what);
    case NumberType::uint16:
      return next_integer<std::uint16_t>(what);
    case NumberType::int32:
      return next_integer<std::int32_t>(what);
    case NumberType::uint32:
      return next_integer<std::uint32_t>(what);
    case NumberType::int64:
      return next_integer<std::int64_t>(what);
    case NumberType::uint64:
      return next_integer<std::uint64_t>(what);
    default:
      scanner_.fail(std::string(what) + " must be of an integer type");
  }
}

void NumberReader::require(std::uint64_t count, NumberType type, const char* what) const {
  const std::size_t digit_and_blank = 2;
  scanner_.require(count, binary_ ? size_of(type) : digit_and_blank, what);
}

}  // namespace softkin
