#include <algorithm>
#include <softkin/statics/physical/node_loads.hpp>

namespace softkin::physical {

void NodeLoads::add_cliques(linear::Cliques& cliques) {
  for (std::size_t f = 0; f < parts(); ++f) {
    slots_.push_back(cliques.slots.back());
    cliques.add(nodes_of_part(f));
  }
}

void NodeLoads::stiffness(const Iterate& at, const LoadState& load_state, bool projected, Term::Scratch& /*scratch*/,
                          LargeVector<double>& slots, Team& team) const {
  using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  team.pieces(parts(), [&](Index begin, Index end) {
    for (std::size_t f = begin; f < static_cast<std::size_t>(end); ++f) {
      const std::size_t count = nodes_of_part(f).size();
      double* out = slots.data() + 9 * slots_[f];
      const double fraction = projected ? 0 : scale(f, load_state) / 2;  // a load has no positive part of its own
      if (fraction == 0) {
        std::fill_n(out, 9 * count * (count + 1) / 2, 0.0);
        continue;
      }
      const Blocks blocks = slopes(f, at.positions);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j <= i; ++j, out += 9)
          Block(out, 3, 3) = fraction * (blocks[i][j] + blocks[j][i].transpose());
    }
  });
}

void NodeLoads::add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch,
                             Points& force) const {
  if (symmetric()) return;
  for (std::size_t f = 0; f < parts(); ++f) {
    const double fraction = scale(f, static_cast<const Scratch&>(scratch).load_state) / 2;
    if (fraction == 0) continue;
    const std::vector<Index>& nodes = nodes_of_part(f);
    const Blocks blocks = slopes(f, at.positions);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t j = 0; j < nodes.size(); ++j)
        force.row(nodes[i]) +=
            (fraction * (blocks[i][j] - blocks[j][i].transpose()) * vertex_at(moves, nodes[j])).transpose();
  }
}

}  // namespace softkin::physical
