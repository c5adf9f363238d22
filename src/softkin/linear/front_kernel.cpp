#include <algorithm>
#include <cmath>
#include <softkin/linear/front_kernel.hpp>
#include <softkin/linear/front_rows.hpp>

namespace softkin::linear {

namespace {

constexpr Index block = front_block;
constexpr Index tile_columns = 8;
#ifdef __AVX512F__
constexpr Index strip_panels = 3;  // 3 x 8 sums fill the vector registers
#else
constexpr Index strip_panels = 1;
#endif

/// Unit lower L and D of the pivot block in place; pivots below `least` in magnitude are replaced.
template <class Number>
Index factor_corner(Number* corner, Index stride, Index width, Number least, Number* diagonal) {
  Index negative = 0;
  for (Index c = 0; c < width; ++c) {
    Number* column = corner + static_cast<std::ptrdiff_t>(c) * stride;
    Number pivot = column[c];
    if (!(std::abs(pivot) >= least)) pivot = -least;
    negative += pivot < 0;
    diagonal[c] = pivot;
    const Number inverse = 1 / pivot;
    for (Index k = c + 1; k < width; ++k) {
      Number* target = corner + static_cast<std::ptrdiff_t>(k) * stride;
      const Number scale = column[k] * inverse;
      for (Index r = k; r < width; ++r) target[r] -= scale * column[r];
    }
    for (Index r = c + 1; r < width; ++r) column[r] *= inverse;
  }
  return negative;
}

/// Rows of the front below the pivot block, `Panels` panels of them: L D = A L_corner^-T, L; both also into the panels.
template <int Panels, class Number>
void solve_strip(Number* rows, Index stride, Index width, const Number* corner, const Number* diagonal, Number* plain,
                 Number* scaled) {
  constexpr Index height = panel_rows<Number>;
  for (Index c = 0; c < width; ++c) {
    Number* column = rows + static_cast<std::ptrdiff_t>(c) * stride;
    Rows<Number> sum[Panels];
    for (int p = 0; p < Panels; ++p) sum[p] = load(column + height * p);
    const Number* l = corner + c * block;
    for (Index k = 0; k < c; ++k)
      for (int p = 0; p < Panels; ++p) sum[p] -= l[k] * load(plain + (p * width + k) * height);
    const Number inverse = 1 / diagonal[c];
    for (int p = 0; p < Panels; ++p) {
      store(plain + (p * width + c) * height, sum[p]);
      const Rows<Number> value = inverse * sum[p];
      store(scaled + (p * width + c) * height, value);
      store(column + height * p, value);
    }
  }
}

/// target (`Panels` panels of rows by `columns` <= 8) -= scaled plain^T over `depth` columns of L. What stands in the
/// columns from `fresh` on counts as zero.
template <int Panels, class Number>
void update_tile(const Number* scaled, const Number* plain, Index depth, Number* target, Index stride, Index columns,
                 Index fresh) {
  constexpr Index height = panel_rows<Number>;
  Rows<Number> sum[Panels][tile_columns] = {};
  for (Index k = 0; k < depth; ++k) {
    Rows<Number> left[Panels];
    for (int p = 0; p < Panels; ++p) left[p] = load(scaled + (p * depth + k) * height);
    const Number* right = plain + k * height;
#pragma GCC unroll 8
    for (int c = 0; c < tile_columns; ++c)
      for (int p = 0; p < Panels; ++p) sum[p][c] += right[c] * left[p];
  }
  if (columns == tile_columns && fresh <= 0) {
#pragma GCC unroll 8
    for (int c = 0; c < tile_columns; ++c)
      for (int p = 0; p < Panels; ++p) store(target + c * static_cast<std::ptrdiff_t>(stride) + height * p, -sum[p][c]);
    return;
  }
  if (columns == tile_columns && fresh >= columns) {
#pragma GCC unroll 8
    for (int c = 0; c < tile_columns; ++c)
      for (int p = 0; p < Panels; ++p) {
        Number* at = target + c * static_cast<std::ptrdiff_t>(stride) + height * p;
        store(at, load(at) - sum[p][c]);
      }
    return;
  }
  Rows<Number> kept[tile_columns][Panels];
#pragma GCC unroll 8
  for (int c = 0; c < tile_columns; ++c)
    for (int p = 0; p < Panels; ++p) kept[c][p] = sum[p][c];
  for (Index c = 0; c < columns; ++c)
    for (int p = 0; p < Panels; ++p) {
      Number* at = target + c * static_cast<std::ptrdiff_t>(stride) + height * p;
      store(at, c < fresh ? load(at) - kept[c][p] : -kept[c][p]);
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
  if (team.size() == 1 || work < worth_sharing) return body(0, panels);
  const Index strips = (panels + strip_panels - 1) / strip_panels;
  team.each(strips, [&](Index s) { body(s * strip_panels, std::min(panels, (s + 1) * strip_panels)); });
}

}  // namespace

template <class Number>
Index factor_front(Number* front, Index size, Index pivots, Number least, Number* diagonal, FrontWork<Number>& work,
                   Team& team) {
  constexpr Index height = panel_rows<Number>;
  const Index stride = front_stride<Number>(size);
  const auto at = [&](Index row, Index column) { return front + static_cast<std::ptrdiff_t>(column) * stride + row; };
  const std::size_t panels_most = static_cast<std::size_t>(size + height) * block;
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
    const Index panels = (rest + height - 1) / height;
    const auto panel = [&](LargeVector<Number>& all, Index p) {
      return all.data() + static_cast<std::ptrdiff_t>(p) * width * height;
    };
    const double depth = width, rows = rest;
    share(team, panels, rows * depth * depth, [&](Index low, Index high) {
      each_strip(low, high, [&]<int Panels>(Index p) {
        solve_strip<Panels>(at(first + height * p, begin), stride, width, work.corner.data(), diagonal + begin,
                            panel(work.plain, p), panel(work.scaled, p));
      });
    });
    share(team, panels, 0.5 * rows * rows * depth, [&](Index low, Index high) {
      each_strip(low, high, [&]<int Panels>(Index p) {
        const Index last = std::min(rest, height * (p + Panels));
        for (Index c = 0; c < last; c += tile_columns)
          update_tile<Panels>(panel(work.scaled, p), panel(work.plain, c / height) + c % height, width,
                              at(first + height * p, first + c), stride, std::min(tile_columns, rest - c),
                              begin == 0 ? pivots - first - c : tile_columns);
      });
    });
  }
  return negative;
}

template Index factor_front(double*, Index, Index, double, double*, FrontWork<double>&, Team&);
template Index factor_front(float*, Index, Index, float, float*, FrontWork<float>&, Team&);

}  // namespace softkin::linear
