#pragma once

#include <bit>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace softkin::python {

// Pickles: the bytes of values one after another. A type lists its members once, in an overload of
// members(archive, value), for writing and reading. Pickles are read by the version of softkin that wrote them.

static_assert(std::endian::native == std::endian::little, "pickles are little-endian");

template <class T>
inline constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T, std::size_t N>
inline constexpr bool is_plain<std::array<T, N>> = is_plain<T>;

/// A value to read members into; specialised where a type has none by itself.
template <class T>
T blank() {
  return T();
}

class Writer {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (put(values), ...);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void raw(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  template <class T>
  void put(const T& value) {
    if constexpr (is_plain<T>)
      raw(&value, sizeof value);
    else
      members(*this, const_cast<T&>(value));  // which are only read here
  }
  template <class T>
  void put_list(const T& values) {
    put(static_cast<std::uint64_t>(values.size()));
    using Value = typename T::value_type;
    if constexpr (is_plain<Value>)
      raw(values.data(), values.size() * sizeof(Value));
    else
      for (const auto& value : values) put(value);
  }
  void put(const std::string& text) { put_list(text); }
  template <class T>
  void put(const std::vector<T>& values) {
    put_list(values);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class T>
  void put(const std::shared_ptr<const T>& value) {
    put(*value);
  }
  template <class T>
  void put(const std::map<std::string, T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    for (const auto& [key, value] : values) (*this)(key, value);
  }
  template <int Rows, int Columns, int Options>
  void put(const Eigen::Matrix<double, Rows, Columns, Options>& matrix) {
    put(static_cast<std::uint64_t>(matrix.rows()));
    put(static_cast<std::uint64_t>(matrix.cols()));
    raw(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
  }

  std::string bytes_;
};

/// throws  InvalidInput where the bytes end early or count more than there is
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  template <class... Values>
  void operator()(Values&... values) {
    (get(values), ...);
  }
  void finish() const { require(rest_.empty()); }

 private:
  static void require(bool good) {
    if (!good) throw InvalidInput("the pickle is damaged, or of another version of softkin");
  }
  void raw(void* data, std::size_t size) {
    require(size <= rest_.size());
    if (size > 0) std::memcpy(data, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  std::size_t count(std::size_t bytes_each) {
    std::uint64_t number = 0;
    get(number);
    require(number <= rest_.size() / bytes_each);
    return number;
  }

  template <class T>
  void get(T& value) {
    if constexpr (is_plain<T>)
      raw(&value, sizeof value);
    else
      members(*this, value);
  }
  template <class T>
  void get_list(T& values) {
    using Value = typename T::value_type;
    values.resize(count(is_plain<Value> ? sizeof(Value) : 1));
    if constexpr (is_plain<Value>)
      raw(values.data(), values.size() * sizeof(Value));
    else
      for (auto& value : values) get(value);
  }
  void get(std::string& text) { get_list(text); }
  template <class T>
  void get(std::vector<T>& values) {
    get_list(values);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool has = false;
    get(has);
    value.reset();
    if (has) get(value.emplace(blank<T>()));
  }
  template <class T>
  void get(std::shared_ptr<const T>& value) {
    auto read = std::make_shared<T>();
    get(*read);
    value = std::move(read);
  }
  template <class T>
  void get(std::map<std::string, T>& values) {
    for (std::size_t left = count(1); left > 0; --left) {
      std::string key;
      get(key);
      get(values.emplace(key, blank<T>()).first->second);
    }
  }
  template <int Rows, int Columns, int Options>
  void get(Eigen::Matrix<double, Rows, Columns, Options>& matrix) {
    std::uint64_t rows = 0, columns = 0;
    (*this)(rows, columns);
    const auto fits = [](std::uint64_t size, int fixed) {
      return fixed == Eigen::Dynamic || size == static_cast<std::uint64_t>(fixed);
    };
    require(fits(rows, Rows) && fits(columns, Columns));
    require(columns == 0 || rows <= rest_.size() / sizeof(double) / columns);
    matrix.resize(rows, columns);
    raw(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double));
  }

  std::string_view rest_;
};

}  // namespace softkin::python
