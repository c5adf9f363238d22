#include <softkin/statics/physical/surface_load.hpp>

namespace softkin::physical {

void SurfaceLoad::add_cliques(linear::Cliques& cliques) {
  for (std::size_t f = 0; f < faces(); ++f) {
    slots_.push_back(cliques.slots.back());
    cliques.add(nodes_of_face(f));
  }
}

void SurfaceLoad::stiffness(const Iterate& at, const Demand& demand, bool projected, Term::Scratch& /*scratch*/,
                            LargeVector<double>& slots, Team& team) const {
  using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  team.pieces(static_cast<Index>(faces()), [&](Index begin, Index end) {
    for (auto f = static_cast<std::size_t>(begin); f < static_cast<std::size_t>(end); ++f) {
      const std::size_t count = nodes_of_face(f).size();
      const Blocks blocks = slopes(f, at.positions);
      double* out = slots.data() + 9 * slots_[f];
      const double share = projected ? 0 : demand.share / 2;  // a load has no positive part of its own
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j <= i; ++j, out += 9)
          Block(out, 3, 3) = share * (blocks[i][j] + blocks[j][i].transpose());
    }
  });
}

void SurfaceLoad::add_response(const Iterate& at, const Points& moves, const Term::Scratch& scratch,
                               Points& force) const {
  if (symmetric()) return;
  const double share = static_cast<const Scratch&>(scratch).share / 2;
  for (std::size_t f = 0; f < faces(); ++f) {
    const std::vector<Index>& nodes = nodes_of_face(f);
    const Blocks blocks = slopes(f, at.positions);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t j = 0; j < nodes.size(); ++j)
        force.row(nodes[i]) +=
            (share * (blocks[i][j] - blocks[j][i].transpose()) * vertex_at(moves, nodes[j])).transpose();
  }
}

}  // namespace softkin::physical
