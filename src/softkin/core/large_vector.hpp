#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace softkin {

/// Memory for megabytes of numbers that are written before they are read: values without an initialiser stay
/// uninitialised, and pages are large where the system has them, which saves most of the time of first use and of
/// scattered access.
template <class Value>
struct LargeAllocator {
  using value_type = Value;
  LargeAllocator() = default;
  template <class Other>
  LargeAllocator(const LargeAllocator<Other>&) {}  // NOLINT: allocators convert

  Value* allocate(std::size_t count) {
    constexpr std::size_t page = std::size_t{1} << 21, line = 64;
    if (count > (std::size_t{1} << 60) / sizeof(Value)) throw std::bad_alloc();
    const std::size_t bytes = count * sizeof(Value), unit = bytes < 2 * page ? line : page;
    void* memory = std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit);
    if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
    if (unit == page) (void)madvise(memory, (bytes + unit - 1) / unit * unit, MADV_HUGEPAGE);
#endif
    return static_cast<Value*>(memory);
  }
  void deallocate(Value* memory, std::size_t) {
    std::free(memory);
  }
  template <class Other>
  void construct(Other*) {}
  template <class Other, class Argument>
  void construct(Other* at, Argument&& argument) {
    ::new (static_cast<void*>(at)) Other(static_cast<Argument&&>(argument));
  }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) {
    return true;
  }
};

template <class Value>
using LargeVector = std::vector<Value, LargeAllocator<Value>>;

}  // namespace softkin
