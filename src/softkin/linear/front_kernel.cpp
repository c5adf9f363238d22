#include <algorithm>
#include <softkin/linear/front_kernel.hpp>
#include <softkin/linear/kernels/front.hpp>

namespace softkin::linear {

namespace {

template <class Number>
Index run_factor_corner(const FrontBlock<Number>& block, Number least, Number* diagonal) {
  SOFTKIN_RUN_KERNEL(factor_corner(block, least, diagonal));
}
template <class Number>
Index run_strip_count(const FrontBlock<Number>& block) {
  SOFTKIN_RUN_KERNEL(strip_count(block));
}
template <class Number>
void run_solve_strips(const FrontBlock<Number>& block, Index low, Index high) {
  SOFTKIN_RUN_KERNEL(solve_strips(block, low, high));
}
template <class Number>
void run_update_strips(const FrontBlock<Number>& block, Index low, Index high) {
  SOFTKIN_RUN_KERNEL(update_strips(block, low, high));
}

/// Loops over ranges of strips, on the team where there is enough to do.
template <class Body>
void fraction(Team& team, Index strips, double work, const Body& body) {
  if (team.size() == 1 || work < worth_sharing) return body(0, strips);
  team.each(strips, [&](Index s) { body(s, s + 1); });
}

}  // namespace

template <class Number>
Index factor_front(const FrontPlace<Number>& front, Number least, Number* diagonal, FrontWork<Number>& work,
                   Team& team) {
  const Index size = front.size, pivots = front.pivots;
  const std::size_t most = static_cast<std::size_t>(front_panels(size)) * front_block;
  if (work.plain.size() < most) {
    work.plain.resize(most);
    work.scaled.resize(most);
  }
  work.corner.resize(corner_values);
  FrontBlock<Number> block{front.own,
                           front.left,
                           size,
                           pivots,
                           front_stride<Number>(size),
                           left_stride<Number>(size - pivots),
                           0,
                           0,
                           work.corner.data(),
                           work.plain.data(),
                           work.scaled.data()};
  Index negative = 0;
  for (block.begin = 0; block.begin < pivots; block.begin += front_block) {
    block.width = std::min(front_block, pivots - block.begin);
    negative += run_factor_corner(block, least, diagonal + block.begin);
    if (block.rest() == 0) continue;
    const Index strips = run_strip_count(block);
    const double depth = block.width, rows = block.rest();
    fraction(team, strips, rows * depth * depth, [&](Index low, Index high) { run_solve_strips(block, low, high); });
    fraction(team, strips, 0.5 * rows * rows * depth,
             [&](Index low, Index high) { run_update_strips(block, low, high); });
  }
  return negative;
}

template Index factor_front(const FrontPlace<double>&, double, double*, FrontWork<double>&, Team&);
template Index factor_front(const FrontPlace<float>&, float, float*, FrontWork<float>&, Team&);

}  // namespace softkin::linear
