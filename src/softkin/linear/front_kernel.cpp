#include <algorithm>
#include <cmath>
#include <softkin/linear/front_kernel.hpp>
#include <softkin/linear/front_rows.hpp>

namespace softkin::linear {

namespace {

constexpr Index block = 64;
#ifdef __AVX512F__
constexpr Index strip_panels = 3;  // 3 x 8 sums fill the vector registers
#else
constexpr Index strip_panels = 1;
#endif

/// Unit lower L and D of the pivot block in place; pivots below `least` in magnitude are replaced.
Index factor_corner(double* corner, Index stride, Index width, double least, double* diagonal) {
  Index negative = 0;
  for (Index c = 0; c < width; ++c) {
    double* column = corner + static_cast<std::ptrdiff_t>(c) * stride;
    double pivot = column[c];
    if (!(std::abs(pivot) >= least)) pivot = -least;
    negative += pivot < 0;
    diagonal[c] = pivot;
    const double inverse = 1 / pivot;
    for (Index k = c + 1; k < width; ++k) {
      double* target = corner + static_cast<std::ptrdiff_t>(k) * stride;
      const double scale = column[k] * inverse;
      for (Index r = k; r < width; ++r) target[r] -= scale * column[r];
    }
    for (Index r = c + 1; r < width; ++r) column[r] *= inverse;
  }
  return negative;
}

/// Rows of the front below the pivot block, `Panels` panels of them: L D = A L_corner^-T, L; both also into the panels.
template <int Panels>
void solve_strip(double* rows, Index stride, Index width, const double* corner, const double* diagonal, double* plain,
                 double* scaled) {
  for (Index c = 0; c < width; ++c) {
    double* column = rows + static_cast<std::ptrdiff_t>(c) * stride;
    Rows sum[Panels];
    for (int p = 0; p < Panels; ++p) sum[p] = load(column + 8 * p);
    const double* l = corner + c * block;
    for (Index k = 0; k < c; ++k)
      for (int p = 0; p < Panels; ++p) sum[p] -= l[k] * load(plain + (p * width + k) * panel_rows);
    const double inverse = 1 / diagonal[c];
    for (int p = 0; p < Panels; ++p) {
      store(plain + (p * width + c) * panel_rows, sum[p]);
      const Rows value = inverse * sum[p];
      store(scaled + (p * width + c) * panel_rows, value);
      store(column + 8 * p, value);
    }
  }
}

/// target (8 Panels rows by `columns` <= 8) -= scaled plain^T over `depth` columns of L.
template <int Panels>
void update_tile(const double* scaled, const double* plain, Index depth, double* target, Index stride, Index columns) {
  Rows sum[Panels][8] = {};
  for (Index k = 0; k < depth; ++k) {
    Rows left[Panels];
    for (int p = 0; p < Panels; ++p) left[p] = load(scaled + (p * depth + k) * panel_rows);
    const double* right = plain + k * panel_rows;
#pragma GCC unroll 8
    for (int c = 0; c < 8; ++c)
      for (int p = 0; p < Panels; ++p) sum[p][c] += right[c] * left[p];
  }
  if (columns == 8) {
#pragma GCC unroll 8
    for (int c = 0; c < 8; ++c)
      for (int p = 0; p < Panels; ++p) {
        double* at = target + c * static_cast<std::ptrdiff_t>(stride) + 8 * p;
        store(at, load(at) - sum[p][c]);
      }
    return;
  }
  Rows kept[8][Panels];
#pragma GCC unroll 8
  for (int c = 0; c < 8; ++c)
    for (int p = 0; p < Panels; ++p) kept[c][p] = sum[p][c];
  for (Index c = 0; c < columns; ++c)
    for (int p = 0; p < Panels; ++p) {
      double* at = target + c * static_cast<std::ptrdiff_t>(stride) + 8 * p;
      store(at, load(at) - kept[c][p]);
    }
}

/// visit.operator()<Panels>(first panel) over all panels, `strip_panels` at a time.
template <class Visit>
void each_strip(Index begin, Index end, const Visit& visit) {
  Index p = begin;
  for (; p + strip_panels <= end; p += strip_panels) visit.template operator()<static_cast<int>(strip_panels)>(p);
  for (; p < end; ++p) visit.template operator()<1>(p);
}

/// Loops over ranges of strips, on the team where there is enough to do.
template <class Body>
void share(Team& team, Index panels, double work, const Body& body) {
  constexpr double worthwhile = 4e6;  // multiplications
  if (team.size() == 1 || work < worthwhile) return body(0, panels);
  const Index strips = (panels + strip_panels - 1) / strip_panels;
  team.each(strips, [&](Index s) { body(s * strip_panels, std::min(panels, (s + 1) * strip_panels)); });
}

}  // namespace

Index factor_front(double* front, Index size, Index pivots, double least, double* diagonal, FrontWork& work,
                   Team& team) {
  const Index stride = front_stride(size);
  const auto at = [&](Index row, Index column) { return front + static_cast<std::ptrdiff_t>(column) * stride + row; };
  const std::size_t panels_most = static_cast<std::size_t>(size + panel_rows) * block;
  if (work.plain.size() < panels_most) {
    work.plain.resize(panels_most);
    work.scaled.resize(panels_most);
  }
  work.corner.resize(block * block);
  Index negative = 0;
  for (Index begin = 0; begin < pivots; begin += block) {
    const Index width = std::min(block, pivots - begin), first = begin + width, rest = size - first;
    negative += factor_corner(at(begin, begin), stride, width, least, diagonal + begin);
    if (rest == 0) continue;
    for (Index c = 0; c < width; ++c)
      for (Index k = 0; k < c; ++k) work.corner[c * block + k] = *at(begin + c, begin + k);
    const Index panels = (rest + panel_rows - 1) / panel_rows;
    const auto panel = [&](LargeVector<double>& all, Index p) {
      return all.data() + static_cast<std::ptrdiff_t>(p) * width * panel_rows;
    };
    const double depth = width, rows = rest;
    share(team, panels, rows * depth * depth, [&](Index low, Index high) {
      each_strip(low, high, [&]<int Panels>(Index p) {
        solve_strip<Panels>(at(first + panel_rows * p, begin), stride, width, work.corner.data(), diagonal + begin,
                            panel(work.plain, p), panel(work.scaled, p));
      });
    });
    share(team, panels, 0.5 * rows * rows * depth, [&](Index low, Index high) {
      each_strip(low, high, [&]<int Panels>(Index p) {
        const Index last = std::min(panels, p + Panels);
        for (Index q = 0; q < last; ++q)
          update_tile<Panels>(panel(work.scaled, p), panel(work.plain, q), width,
                              at(first + panel_rows * p, first + panel_rows * q), stride,
                              std::min(panel_rows, rest - panel_rows * q));
      });
    });
  }
  return negative;
}

}  // namespace softkin::linear
