#include "critical_path.hpp"

#include <algorithm>
#include <softkin/linear/front_kernel.hpp>

namespace softkin::bench {

namespace {

CriticalPath::Part part_of(const linear::Front& front) {
  CriticalPath::Part part;
  for (double begin = 0; begin < front.pivots(); begin += linear::front_block) {
    const double width = std::min<double>(linear::front_block, front.pivots() - begin);
    const double rest = front.size() - begin - width;
    part.alone += width * width * width / 6;
    const double panel = rest * width * width / 2, update = rest * rest * width / 2;
    (2 * panel < linear::worth_sharing ? part.alone : part.shared) += panel;
    (update < linear::worth_sharing ? part.alone : part.shared) += update;
  }
  return part;
}

/// The longest of the cores' days, where each takes the next piece when it is free.
double longest(const std::vector<double>& pieces, int cores) {
  std::vector<double> busy(cores);
  for (const double work : pieces) *std::min_element(busy.begin(), busy.end()) += work;
  return *std::max_element(busy.begin(), busy.end());
}

}  // namespace

double CriticalPath::speedup(int cores) const {
  double route = longest(piece_work, cores);
  for (const Part& part : top_parts) route += part.alone + part.shared / cores;
  return total / route;
}

CriticalPath critical_path(const linear::FrontTree& tree) {
  CriticalPath path;
  path.pieces = static_cast<int>(tree.pieces.size()) - 2;
  for (int p = 0; p < path.pieces; ++p) {
    double work = 0;
    for (Index f = tree.pieces[p]; f < tree.pieces[p + 1]; ++f) {
      const CriticalPath::Part part = part_of(tree.fronts[f]);
      work += part.alone + part.shared;
    }
    path.total += work;
    path.piece_work.push_back(work);
    path.heaviest = std::max(path.heaviest, work);
  }
  for (Index f = tree.pieces[path.pieces]; f < tree.pieces[path.pieces + 1]; ++f) {
    path.top_parts.push_back(part_of(tree.fronts[f]));
    path.top += path.top_parts.back().alone + path.top_parts.back().shared;
  }
  path.total += path.top;
  return path;
}

}  // namespace softkin::bench
