#include <algorithm>
#include <cmath>
#include <softkin/core/dense.hpp>
#include <softkin/energy/target_shape_stiffness.hpp>
#include <softkin/linear/krylov.hpp>
#include <softkin/statics/target_shape/element_sets.hpp>
#include <softkin/statics/target_shape/newton_tangent.hpp>

namespace softkin::target_shape {

using namespace energy;

namespace {

double entry(const Pack33& block, int row, int column, int lane) {
  const Pack3& values = block.row[row];
  return column == 0 ? values.x[lane] : column == 1 ? values.y[lane] : values.z[lane];
}

template <int K>
void copy(const TargetStiffness<K>& stiffness, int lane, double* slots) {
  for (const Pack33& block : stiffness.block)
    for (int r = 0; r < 3; ++r) {
      *slots++ = block.row[r].x[lane];
      *slots++ = block.row[r].y[lane];
      *slots++ = block.row[r].z[lane];
    }
}

/// Columns kept before GMRES starts anew, and how often it may.
constexpr int krylov_columns = 40, krylov_rounds = 1;

}  // namespace

NewtonMatrix::NewtonMatrix(const Model& model, const System& system)
    : system_(system), pattern_(model.rest.rows(), make_cliques(model)) {}

linear::Cliques NewtonMatrix::make_cliques(const Model& model) {
  linear::Cliques cliques;
  const ElementSets& sets = system_.sets();
  const Index vertices = model.rest.rows();
  std::vector<Index> members;
  sets.each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    for (Index e = 0; e < set.count; ++e) {
      members.clear();
      Triangle triangle;
      for (int i = 0; i < K; ++i) {
        const Index node = set.nodes[e / lanes][i][e % lanes];
        if (node < vertices) {
          members.push_back(node);
          continue;
        }
        const EmbeddedPoint& point = *sets.points[node - vertices];
        for (std::size_t k = 0; k < point.vertices.size(); ++k) {
          auto found = std::find(members.begin(), members.end(), point.vertices[k]);
          if (found == members.end()) found = members.insert(found, point.vertices[k]);
          if constexpr (K == 3)
            triangle.parts[i].push_back({static_cast<Index>(found - members.begin()), point.weights[k]});
        }
      }
      slots_.push_back(cliques.slots.back());
      cliques.add(members);
      if constexpr (K == 3) triangles_.push_back(std::move(triangle));
    }
  });
  slots_.push_back(cliques.slots.back());
  return cliques;
}

/// Block (a, b) of the clique: the sum of weight_ia weight_jb K_ij over the triangle's points.
void NewtonMatrix::add_triangle(const Triangle& triangle, const TargetStiffness<3>& stiffness, int lane,
                                double* slots) const {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Pack33& block = stiffness.block[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
      Mat3 values;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) values(r, c) = i >= j ? entry(block, r, c, lane) : entry(block, c, r, lane);
      for (const auto& [a, a_weight] : triangle.parts[i])
        for (const auto& [b, b_weight] : triangle.parts[j]) {
          if (b > a) continue;
          double* slot = slots + 9 * (static_cast<std::int64_t>(a) * (a + 1) / 2 + b);
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) slot[3 * r + c] += a_weight * b_weight * values(r, c);
        }
    }
}

void NewtonMatrix::assemble(const System::Scratch& local, bool projected, LargeVector<double>& slots,
                            Team& team) const {
  slots.resize(9 * static_cast<std::size_t>(slots_.back()));
  std::size_t index = 0, element = 0, triangle = 0;
  system_.sets().each([&]<int K, class Block>(const ElementSet<K, Block>& set) {
    const auto store_block = [&](const TargetStiffness<K>& stiffness, Index block) {
      const Index count = std::min<Index>(lanes, set.count - lanes * block);
      for (Index l = 0; l < count; ++l) {
        const std::size_t e = element + static_cast<std::size_t>(lanes * block + l);
        double* target = slots.data() + 9 * slots_[e];
        if constexpr (K == 3) {
          std::fill(target, slots.data() + 9 * slots_[e + 1], 0.0);
          add_triangle(triangles_[triangle + static_cast<std::size_t>(lanes * block + l)], stiffness, l, target);
        } else {
          copy<K>(stiffness, l, target);
        }
      }
    };
    team.pieces(set.block_count(), [&](Index begin, Index end) {
      Shape<K> shape;
      TargetStiffness<K> stiffness;
      for (Index b = begin; b < end; ++b) {
        load<K>(local.nodes, set.nodes[b], shape);
        center<K>(shape);
        const PackRotation& rotation = local.rotations[index][b];
        if constexpr (std::is_same_v<Block, BodyBlock<K>>)
          stiffness_of_body<K>(set.blocks[b], shape, rotation, projected, stiffness);
        else
          stiffness_of_actuation<K>(set.blocks[b], local.ratios[index][b], system_.redistributes(set.actuator), shape,
                                    rotation, projected, stiffness);
        store_block(stiffness, b);
      }
    });
    element += set.count;
    if constexpr (K == 3) triangle += set.count;
    ++index;
  });
}

Unknowns::Unknowns(const Model& robot, const System& target_shapes)
    : model(robot),
      system(target_shapes),
      matrix(robot, target_shapes),
      freedoms(robot, matrix.pattern()),
      reduced(freedoms, matrix.pattern()),
      symbolic(std::make_shared<const linear::FrontTree>(linear::make_front_tree(reduced.columns()))),
      symmetric(target_shapes.is_gradient()) {}

Tangent::Tangent(const Unknowns& unknowns)
    : unknowns_(unknowns), factor_(unknowns.symbolic), work_(unknowns.system.make_scratch()) {
  linear::require_memory(*unknowns.symbolic, sizeof(double));
  const Index size = unknowns.freedoms.size();
  column_.resize(size, 1);
  turned_.resize(size);
  unturned_.resize(size);
  origin_ = Points::Zero(unknowns.model.rest.rows(), 3);
  if (!unknowns.symmetric) basis_.assign(krylov_columns + 1, Eigen::VectorXd(size));
}

bool Tangent::factorise_values(double shift, Team& team, SolveReport& report) {
  const linear::BlockColumns& columns = unknowns_.reduced.columns();
  shift_ = shift;
  double largest = 0;
  shifted_ = values_;
  for (Index node = 0; node < columns.nodes(); ++node) {
    const Index width = columns.width(node);
    double* block = shifted_.data() + columns.offsets[columns.starts[node]];
    for (Index i = 0; i < width; ++i) {
      double& diagonal = block[i * (width + 1)];
      diagonal += shift * std::abs(diagonal);
      largest = std::max(largest, std::abs(diagonal));
    }
  }
  if (!std::isfinite(largest)) return false;
  constexpr double negligible = 1e-14;
  ++report.factorisations;
  const linear::Pivots pivots = factor_.factorise(shifted_, negligible * largest, team, &slots_);
  return pivots.negative == 0;
}

bool Tangent::factorise(const System::Scratch& local, const Points& positions, bool projected, Team& team,
                        SolveReport& report) {
  constexpr double first_shift = 1e-8, last_shift = 1e4, growth = 10;
  gradient_ = -local.residual;
  const auto assemble = [&](bool positive) {
    unknowns_.matrix.assemble(local, positive, slots_, team);
    unknowns_.reduced.reduce(unknowns_.matrix.pattern(), slots_, gradient_, positions, values_, team);
  };
  bool definite = false;
  if (!projected) {
    assemble(false);
    definite = factorise_values(0, team, report);
  }
  if (!definite) {
    ++report.projections;
    assemble(true);
    definite = factorise_values(0, team, report);
  }
  if (!definite) ++report.shifts;
  for (double shift = first_shift; !definite && shift < last_shift; shift *= growth)
    definite = factorise_values(shift, team, report);
  if (definite && !unknowns_.symmetric) update_coupling(local, positions, team);
  return definite;
}

void Tangent::update_coupling(const System::Scratch& local, const Points& positions, Team& team) {
  unknowns_.system.redistributions(local, work_, redistributions_, team);
  const Index count = redistributions_.size();
  sources_.resize(factor_.size(), count);
  targets_.resize(factor_.size(), count);
  if (count == 0) return;
  for (Index i = 0; i < count; ++i) {
    unknowns_.freedoms.reduce(redistributions_[i].source, positions, sources_.col(i));
    unknowns_.freedoms.reduce(redistributions_[i].target, positions, targets_.col(i));
  }
  factor_.solve(sources_, team);
  const Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(count, count) + targets_.transpose() * sources_;
  capacitance_ = inverse_of(inverse);
  if (!capacitance_.allFinite()) capacitance_.setZero();  // GMRES does without the coupling
}

void Tangent::reduce(const Points& residual, const Points& positions, Eigen::VectorXd& out) const {
  out.resize(unknowns_.freedoms.size());
  unknowns_.freedoms.reduce(residual, positions, out);
}

void Tangent::precondition(Eigen::VectorXd& vector, Team& team) {
  column_.col(0) = vector;
  factor_.solve(column_, team);
  vector = column_.col(0);
  if (sources_.cols() > 0) vector -= sources_ * (capacitance_ * (targets_.transpose() * vector));
}

/// K v: minus the residual's change, and what a turn of the arms of rigid regions does to their torque.
void Tangent::multiply(const System::Scratch& local, const Points& positions, const Eigen::VectorXd& vector,
                       Eigen::VectorXd& product, Team& team) {
  const supports::Freedoms& freedoms = unknowns_.freedoms;
  freedoms.expand(vector, positions, moved_);
  unknowns_.system.residual_change(local, moved_, work_, team);
  freedoms.reduce(work_.residual, positions, product);
  product = -product;
  if (unknowns_.model.rigid.empty()) return;
  // reduce() is linear in the arms: at the moves instead of the positions it gives the torques' change
  freedoms.reduce(local.residual, moved_, turned_);
  freedoms.reduce(local.residual, origin_, unturned_);
  product -= turned_ - unturned_;
}

bool Tangent::solve(const System::Scratch& local, const Points& positions, const Eigen::VectorXd& right,
                    double tolerance, Team& team, Eigen::VectorXd& step) {
  if (unknowns_.symmetric) {
    step = right;
    return true;
  }
  const auto product = [&](const Eigen::VectorXd& in, Eigen::VectorXd& out) {
    multiply(local, positions, in, out, team);
    precondition(out, team);
  };
  return linear::gmres(product, right, tolerance, krylov_rounds, basis_, step);
}

}  // namespace softkin::target_shape
