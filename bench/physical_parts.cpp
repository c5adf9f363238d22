#include "physical_parts.hpp"

#include <algorithm>

#include "machine.hpp"

namespace softkin::bench {

namespace {

template <class Body>
double seconds_of(int repeat, const Body& body) {
  std::vector<double> times;
  for (int i = 0; i < repeat; ++i) {
    const double begin = now();
    body();
    times.push_back(now() - begin);
  }
  return median(times);
}

}  // namespace

PhysicalParts::PhysicalParts(const Model& model, const Actuation& actuation, const State& shape, int threads)
    : model_(model),
      team_(threads),
      system_(model),
      work_(system_),
      demand_{actuation, 1},
      at_{shape.positions, shape.multipliers} {
  for (Index a = 0; a < system_.actuators(); ++a) {
    active_.push_back(system_.measures().constrains(a));
    at_.multipliers[a] *= system_.measures().unit(a);
  }
  projected_ = factorise() > 0;
}

/// As at_ is; projected where that is not stable. returns negative eigenvalues of the exact stiffness
int PhysicalParts::factorise() {
  using Stiffness = physical::System::Stiffness;
  system_.evaluate(at_, demand_, active_, work_, balance_, team_);
  (void)system_.factorise(at_, demand_, active_, balance_, {}, work_, team_);
  const int negative = work_.saddle.spectrum().negative;
  if (negative > 0) (void)system_.factorise(at_, demand_, active_, balance_, {Stiffness::projected}, work_, team_);
  return negative;
}

PhysicalParts::Times PhysicalParts::measure(int repeat) {
  Times times;
  times.force = seconds_of(repeat, [&] { system_.evaluate(at_, demand_, active_, work_, balance_, team_); });
  const double whole =
      seconds_of(repeat, [&] { (void)system_.factorise(at_, demand_, active_, balance_, {}, work_, team_); });
  Eigen::MatrixXd none(unknowns(), 0);
  times.factor = seconds_of(repeat, [&] {
    (void)work_.saddle.factor().factorise(work_.stiffness.values, 0, work_.saddle.precision(), none, team_);
  });
  Eigen::VectorXd step, change;
  work_.saddle.step(balance_, step, change, team_);
  Eigen::MatrixXd column;
  times.solve = seconds_of(repeat, [&] {
    column.setOnes(unknowns(), 1);
    work_.saddle.factor().solve(column, team_);
  });
  Points moved = at_.positions;
  times.turn = seconds_of(repeat, [&] {
    moved = at_.positions;
    system_.advance(step, 1, work_, moved, team_);
  });

  physical::Body elastic(model_);
  linear::Cliques cliques;
  elastic.add_cliques(cliques);
  physical::Body::Scratch scratch = elastic.make_scratch();
  LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back()));
  Points gradient;
  (void)elastic.force(demand_, at_.positions, scratch, gradient, team_);
  times.stiffness =
      seconds_of(repeat, [&] { elastic.stiffness(demand_, at_.positions, false, scratch, slots, team_); });
  times.assembly = std::max(
      0.0, whole - times.stiffness - times.factor - static_cast<double>(work_.saddle.active().size()) * times.solve);
  return times;
}

Eigen::SparseMatrix<double> PhysicalParts::matrix() const {
  const linear::BlockColumns& columns = pattern();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(work_.stiffness.values.size());
  for (Index node = 0; node < columns.nodes(); ++node)
    for (Index e = columns.starts[node]; e < columns.starts[node + 1]; ++e) {
      const Index row = columns.rows[e], height = columns.width(row);
      for (Index c = 0; c < columns.width(node); ++c)
        for (Index r = row == node ? c : 0; r < height; ++r)
          entries.emplace_back(columns.unknowns[row] + r, columns.unknowns[node] + c,
                               work_.stiffness.values[columns.offsets[e] + c * height + r]);
    }
  Eigen::SparseMatrix<double> matrix(columns.size(), columns.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace softkin::bench
