#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <softkin/core/types.hpp>
#include <string>
#include <vector>

namespace softkin::python {

namespace nb = nanobind;

// Arrays come in checked by the Python layer: C order, of these types. They go out as copies that own their memory, or
// read-only with the object that owns it.

template <class T, class... Extra>
using Array = nb::ndarray<nb::numpy, T, nb::c_contig, nb::device::cpu, Extra...>;
using PointsIn = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using VectorIn = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using TableIn = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using IndicesIn = nb::ndarray<const Index, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using CellsIn = nb::ndarray<const Index, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

using PointsOut = Array<const double, nb::shape<-1, 3>>;
using VectorOut = Array<double, nb::ndim<1>>;
using TableOut = Array<double, nb::ndim<2>>;
using IndicesOut = Array<Index, nb::ndim<1>>;
using CellsOut = Array<Index, nb::ndim<2>>;

[[nodiscard]] inline Points points_of(const PointsIn& array) {
  return Eigen::Map<const Points>(array.data(), array.shape(0), 3);
}

[[nodiscard]] inline Eigen::VectorXd vector_of(const VectorIn& array) {
  return Eigen::Map<const Eigen::VectorXd>(array.data(), array.shape(0));
}

[[nodiscard]] inline Vec3 vec3_of(const std::array<double, 3>& values) {
  return {values[0], values[1], values[2]};
}

[[nodiscard]] inline std::array<double, 3> array_of(const Vec3& values) {
  return {values.x(), values.y(), values.z()};
}

/// A view; owner keeps the points alive.
[[nodiscard]] inline PointsOut view_of(const Points& points, nb::handle owner) {
  return PointsOut(points.data(), {static_cast<std::size_t>(points.rows()), 3}, owner);
}

/// Rows of so many numbers each, as an array that owns its memory.
template <class T>
[[nodiscard]] Array<T, nb::ndim<2>> table_of(const T* data, std::size_t rows, std::size_t columns) {
  auto* copy = new T[std::max<std::size_t>(1, rows * columns)];
  std::copy(data, data + rows * columns, copy);
  const nb::capsule owner(copy, [](void* memory) noexcept { delete[] static_cast<T*>(memory); });
  return Array<T, nb::ndim<2>>(copy, {rows, columns}, owner);
}

template <class T>
[[nodiscard]] Array<T, nb::ndim<1>> list_of(const T* data, std::size_t count) {
  auto* copy = new T[std::max<std::size_t>(1, count)];
  std::copy(data, data + count, copy);
  const nb::capsule owner(copy, [](void* memory) noexcept { delete[] static_cast<T*>(memory); });
  return Array<T, nb::ndim<1>>(copy, {count}, owner);
}

[[nodiscard]] inline VectorOut vector_out(const Eigen::VectorXd& vector) {
  return list_of(vector.data(), vector.size());
}

template <std::size_t N>
[[nodiscard]] CellsOut cells_out(const std::vector<std::array<Index, N>>& cells) {
  return table_of(cells.empty() ? nullptr : cells.front().data(), cells.size(), N);
}

template <std::size_t N>
[[nodiscard]] TableOut rows_out(const std::vector<std::array<double, N>>& rows) {
  return table_of(rows.empty() ? nullptr : rows.front().data(), rows.size(), N);
}

}  // namespace softkin::python
