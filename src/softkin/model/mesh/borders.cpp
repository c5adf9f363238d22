#include <map>
#include <softkin/model/mesh/borders.hpp>

namespace softkin {

std::vector<std::vector<Index>> borders_of(const std::vector<Triangle>& triangles,
                                           const std::vector<std::array<Index, 3>>& beside) {
  std::map<std::pair<Index, Index>, std::pair<int, Index>> edges;  // how many triangles, the vertex on it
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      auto& [count, middle] = edges[std::minmax(triangles[t][k], triangles[t][(k + 1) % 3])];
      ++count;
      middle = beside[t][k];
    }
  std::map<Index, std::vector<std::pair<Index, Index>>> next;  // of a vertex: others, and what is between
  for (const auto& [ends, edge] : edges) {
    if (edge.first != 1) continue;
    next[ends.first].emplace_back(ends.second, edge.second);
    next[ends.second].emplace_back(ends.first, edge.second);
  }
  std::vector<std::vector<Index>> lines;
  for (const auto& [first, unused] : next)
    while (!next[first].empty()) {
      std::vector<Index> line{first};
      for (Index at = first; !next[at].empty();) {
        const auto [to, middle] = next[at].back();
        next[at].pop_back();
        std::erase(next[to], std::pair(at, middle));
        if (middle >= 0) line.push_back(middle);
        line.push_back(to);
        at = to;
      }
      lines.push_back(std::move(line));
    }
  return lines;
}

}  // namespace softkin
