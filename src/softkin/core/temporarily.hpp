#pragma once

#include <utility>

namespace softkin {

/// Another value of something while it lives; then again what was. what must outlive the object.
template <class Value>
class Temporarily {
 public:
  Temporarily(Value& what, Value value) : what_(what), before_(std::exchange(what, std::move(value))) {}
  ~Temporarily() { what_ = std::move(before_); }
  Temporarily(const Temporarily&) = delete;
  Temporarily& operator=(const Temporarily&) = delete;

 private:
  Value& what_;
  Value before_;
};

}  // namespace softkin
