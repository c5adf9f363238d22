#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/layers.hpp>

namespace softkin::physical {

namespace {

using Sheet = Eigen::Matrix<double, 3, 2>;
using Block3 = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

Sheet sheet_gradient(const LayerPlace& place, const Points& positions) {
  Sheet f = Sheet::Zero();
  for (std::size_t i = 0; i < place.vertices.size(); ++i)
    f += vertex_at(positions, place.vertices[i]) * place.slopes[i].transpose();
  return f;
}

Vec3 green_strain(const Sheet& f) {
  const Eigen::Matrix2d c = f.transpose() * f;
  return {(c(0, 0) - 1) / 2, (c(1, 1) - 1) / 2, c(0, 1)};
}

Eigen::Matrix2d as_matrix(const Vec3& stress) {
  Eigen::Matrix2d s;
  s << stress[0], stress[2], stress[2], stress[1];
  return s;
}

/// Derivative of the strain by a vertex of that slope.
Mat3 strain_slope(const Sheet& f, const Eigen::Vector2d& slope) {
  Mat3 b;
  b << slope[0] * f.col(0).transpose(), slope[1] * f.col(1).transpose(),
      (slope[0] * f.col(1) + slope[1] * f.col(0)).transpose();
  return b;
}

energy::SheetResponse respond(const SheetLaw& law, const Vec3& strain, double barrier) {
  return barrier > 0 && law.tension_only ? energy::smooth_sheet_response(law, strain, barrier)
                                         : energy::sheet_response(law, strain);
}

/// Returns the nearest symmetric matrix without compression.
Eigen::Matrix2d pulling(const Eigen::Matrix2d& stress) {
  const double mean = stress.trace() / 2, apart = std::hypot((stress(0, 0) - stress(1, 1)) / 2, stress(1, 0));
  if (mean >= apart) return stress;
  if (mean <= -apart) return Eigen::Matrix2d::Zero();
  return (mean + apart) / (2 * apart) * (stress - (mean - apart) * Eigen::Matrix2d::Identity());
}

/// Returns the order that sorts vertices.
std::vector<std::size_t> sorted_order(const std::vector<Index>& vertices) {
  std::vector<std::size_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return vertices[a] < vertices[b]; });
  return order;
}

/// The columns that parts of vertices add up to.
template <int Columns, class Bent>
Eigen::Matrix<double, 3, Columns> columns_of(const Bent& bent, const Points& positions) {
  Eigen::Matrix<double, 3, Columns> columns = Eigen::Matrix<double, 3, Columns>::Zero();
  for (std::size_t i = 0; i < bent.vertices.size(); ++i)
    columns += vertex_at(positions, bent.vertices[i]) * bent.parts[i].transpose();
  return columns;
}

template <class Bent, class Response>
void add_pull(const Bent& bent, const Response& response, Term::Sum& sum) {
  sum.energy += response.energy;
  const auto by_columns = response.gradient.reshaped(3, response.gradient.size() / 3);
  for (std::size_t i = 0; i < bent.vertices.size(); ++i)
    sum.gradient.row(bent.vertices[i]) += (by_columns * bent.parts[i]).transpose();
}

Eigen::MatrixXd positive(const Eigen::MatrixXd& matrix) {
  const SymmetricEigen parts = symmetric_eigen(matrix);
  return parts.vectors * parts.values.cwiseMax(0.0).asDiagonal() * parts.vectors.transpose();
}

/// Writes the blocks of the vertices, each of which is a sum over pairs of columns.
template <class Bent>
void put_stiffness(const Bent& bent, const Eigen::MatrixXd& hessian, double* out) {
  const Eigen::Index columns = hessian.cols() / 3;
  std::vector<Eigen::Matrix3Xd> left;
  for (const auto& parts : bent.parts) {
    left.emplace_back(3, hessian.cols()).setZero();
    for (Eigen::Index c = 0; c < columns; ++c) left.back() += parts[c] * hessian.middleRows<3>(3 * c);
  }
  for (std::size_t i = 0; i < left.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j, out += 9) {
      Mat3 block = Mat3::Zero();
      for (Eigen::Index c = 0; c < columns; ++c) block += bent.parts[j][c] * left[i].middleCols<3>(3 * c);
      Block3(out, 3, 3) = block;
    }
}

}  // namespace

Layers::Layers(const Model& model) : model_(model) {
  for (const auto& layer : model.reinforcement.layers) {
    add_membrane(*layer);
    add_bending(*layer);
  }
  std::vector<bool> held = vertices_of_elements(model);
  // sheets that bend have a shape of their own, but a flat bag is swollen at the start, as its film has far to go
  if (std::none_of(model.actuators.begin(), model.actuators.end(), flat_at_rest))
    for (const auto& layer : model.reinforcement.layers) {
      if (layer->bends.empty()) continue;
      for (const CavityFace& face : layer->faces)
        for (const Index v : nodes_of(face)) held[v] = true;
    }
  for (const Face& face : faces_)
    std::copy_if(face.vertices.begin(), face.vertices.end(), std::back_inserter(alone_),
                 [&](Index v) { return !held[v]; });
  sort_unique(alone_);
}

bool Layers::flat(const Points& positions) const {
  return std::all_of(alone_.begin(), alone_.end(), [&](Index v) { return positions.row(v) == model_.rest.row(v); });
}

void Layers::add_tension(const Points& moves, Points& forces) const {
  for (const Face& face : faces_)
    for (const LayerPlace* place : face.places) {
      const Sheet pull = place->area_mm2 * sheet_gradient(*place, moves);
      for (std::size_t i = 0; i < place->vertices.size(); ++i)
        forces.row(place->vertices[i]) += (pull * place->slopes[i]).transpose();
    }
}

double Layers::stiffness_N_mm() const {
  double most = 0;
  for (const Face& face : faces_) most = std::max(most, face.law->stiffness(0, 0) * face.thickness_mm);
  return most;
}

double Layers::mean_slope(const Points& moves) const {
  double sum = 0, area = 0;
  for (const Face& face : faces_)
    for (const LayerPlace* place : face.places) {
      sum += place->area_mm2 * sheet_gradient(*place, moves).norm();
      area += place->area_mm2;
    }
  return sum / area;
}

void Layers::add_membrane(const Layer& layer) {
  std::map<std::vector<Index>, std::size_t> known;
  for (const LayerPlace& place : layer.places) {
    std::vector<Index> vertices = place.vertices;
    std::sort(vertices.begin(), vertices.end());
    const auto [at, fresh] = known.emplace(vertices, faces_.size());
    if (fresh) faces_.push_back({&layer.law, layer.thickness_mm, std::move(vertices), {}, {}});
    faces_[at->second].places.push_back(&place);
    faces_[at->second].orders.push_back(sorted_order(place.vertices));
  }
}

void Layers::add_bending(const Layer& layer) {
  for (const LayerBend& bend : layer.bends) {
    Place place{{}, &bend.place};
    for (const std::size_t i : sorted_order(bend.vertices)) {
      place.vertices.push_back(bend.vertices[i]);
      place.parts.push_back(bend.parts[i]);
    }
    places_.push_back(std::move(place));
  }
  for (const LayerJoint& of : layer.joints) {
    Joint joint{{}, &of.joint};
    for (const LayerJoint::Side& side : of.sides)
      joint.vertices.insert(joint.vertices.end(), side.vertices.begin(), side.vertices.end());
    sort_unique(joint.vertices);
    joint.parts.assign(joint.vertices.size(), Eigen::Matrix<double, 6, 1>::Zero());
    for (std::size_t s = 0; s < 2; ++s)
      for (std::size_t i = 0; i < of.sides[s].vertices.size(); ++i) {
        const auto at = std::lower_bound(joint.vertices.begin(), joint.vertices.end(), of.sides[s].vertices[i]);
        joint.parts[at - joint.vertices.begin()].segment<3>(3 * s) = of.sides[s].parts[i];
      }
    joints_.push_back(std::move(joint));
  }
}

energy::BendingResponse<15> Layers::bend(const Place& place, const Points& positions, bool second) {
  return energy::bend(*place.of, columns_of<5>(place, positions), second);
}

energy::BendingResponse<18> Layers::bend(const Joint& joint, const Points& positions, bool second) {
  const Eigen::Matrix<double, 3, 6> columns = columns_of<6>(joint, positions);
  return energy::bend(*joint.of, columns.leftCols<3>(), columns.rightCols<3>(), second);
}

void Layers::evaluate(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& scratch, Sum& sum,
                      Team& /*team*/) const {
  const double barrier = static_cast<Scratch&>(scratch).barrier;
  Eigen::VectorXd& pulls = static_cast<Scratch&>(scratch).pulls;
  pulls.setZero(at.positions.rows());
  for (const Face& face : faces_)
    for (const LayerPlace* place : face.places) {
      const Sheet f = sheet_gradient(*place, at.positions);
      const energy::SheetResponse response = respond(*face.law, green_strain(f), barrier);
      const double volume = place->area_mm2 * face.thickness_mm;
      if (!std::isfinite(response.energy) || !response.stress.allFinite()) {  // rubber without area
        sum.forbidden = true;
        return;
      }
      sum.energy += volume * response.energy;
      const Sheet pull = volume * f * as_matrix(response.stress);
      for (std::size_t i = 0; i < place->vertices.size(); ++i) {
        const Vec3 force = pull * place->slopes[i];
        sum.gradient.row(place->vertices[i]) += force.transpose();
        pulls[place->vertices[i]] += force.norm();
      }
    }
  for (const Place& place : places_) add_pull(place, bend(place, at.positions, false), sum);
  for (const Joint& joint : joints_) add_pull(joint, bend(joint, at.positions, false), sum);
  sum.forbidden = sum.forbidden || !std::isfinite(sum.energy);
}

void Layers::add_cliques(linear::Cliques& cliques) {
  for (Face& face : faces_) {
    face.slot = cliques.slots.back();
    cliques.add(face.vertices);
  }
  for (Place& place : places_) {
    place.slot = cliques.slots.back();
    cliques.add(place.vertices);
  }
  for (Joint& joint : joints_) {
    joint.slot = cliques.slots.back();
    cliques.add(joint.vertices);
  }
}

namespace {

/// Stress and tangent of a sheet's stiffness, projected or not.
struct SheetStress {
  Eigen::Matrix2d stress;
  Mat3 tangent;
};

SheetStress stress_of(const SheetLaw& law, const Sheet& f, double barrier, bool projected) {
  const energy::SheetResponse response = respond(law, green_strain(f), barrier);
  const Eigen::Matrix2d stress = as_matrix(response.stress);
  if (!projected) return {stress, response.tangent};
  return {pulling(stress), law.rubber ? Mat3(positive(response.tangent)) : response.tangent};
}

/// Adds the stiffness of a place to blocks of its vertices; order: their numbers among the place's vertices.
void add_sheet_stiffness(const LayerPlace& place, const Sheet& f, const SheetStress& of, double volume,
                         const std::vector<std::size_t>& order, double* out) {
  std::vector<Mat3> slopes;
  for (const std::size_t i : order) slopes.push_back(strain_slope(f, place.slopes[i]));
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Mat3 left = volume * slopes[i].transpose() * of.tangent;
    for (std::size_t j = 0; j <= i; ++j, out += 9) {
      Mat3 block = left * slopes[j];
      block.diagonal().array() += volume * place.slopes[order[i]].dot(of.stress * place.slopes[order[j]]);
      Block3(out, 3, 3) += block;
    }
  }
}

}  // namespace

void Layers::stiffness(const Iterate& at, const LoadState& /*load_state*/, bool projected, Term::Scratch& scratch,
                       LargeVector<double>& slots, Team& team) const {
  const double barrier = static_cast<const Scratch&>(scratch).barrier;
  const auto room = [&](std::int64_t slot, std::size_t count) {
    double* const first = slots.data() + 9 * slot;
    std::fill_n(first, 9 * count * (count + 1) / 2, 0.0);
    return first;
  };
  team.pieces(faces_.size(), [&](Index begin, Index end) {
    for (Index n = begin; n < end; ++n) {
      const Face& face = faces_[n];
      double* const first = room(face.slot, face.vertices.size());
      for (std::size_t p = 0; p < face.places.size(); ++p) {
        const LayerPlace& place = *face.places[p];
        const Sheet f = sheet_gradient(place, at.positions);
        add_sheet_stiffness(place, f, stress_of(*face.law, f, barrier, projected), place.area_mm2 * face.thickness_mm,
                            face.orders[p], first);
      }
    }
  });
  const auto put = [&](const auto& bent) {
    const Eigen::MatrixXd hessian = bend(bent, at.positions, true).hessian;
    put_stiffness(bent, projected ? positive(hessian) : hessian, slots.data() + 9 * bent.slot);
  };
  team.pieces(places_.size(), [&](Index begin, Index end) {
    for (Index n = begin; n < end; ++n) put(places_[n]);
  });
  team.pieces(joints_.size(), [&](Index begin, Index end) {
    for (Index n = begin; n < end; ++n) put(joints_[n]);
  });
}

bool Layers::kinked() const {
  return std::any_of(faces_.begin(), faces_.end(), [](const Face& face) { return face.law->tension_only; });
}

void Layers::describe(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& /*scratch*/,
                      ElementDeformation& out, Team& /*team*/) const {
  for (const auto& layer : model_.reinforcement.layers) {
    LayerForces reported;
    double area = 0, wrinkled = 0, slack = 0;
    for (const LayerPlace& place : layer->places) {
      const Sheet f = sheet_gradient(place, at.positions);
      const Eigen::Matrix2d c = f.transpose() * f;
      const energy::SheetResponse response = energy::sheet_response(layer->law, green_strain(f));
      // force per present width: h F S F^T / J, of the eigenvalues of S C
      const Eigen::Matrix2d pull =
          layer->thickness_mm / std::sqrt(std::max(c.determinant(), 1e-300)) * as_matrix(response.stress) * c;
      const double mean = pull.trace() / 2, apart = std::sqrt(std::max(mean * mean - pull.determinant(), 0.0));
      if (area == 0 || mean + apart > reported.largest_N_mm) {
        reported.largest_N_mm = mean + apart;
        reported.where = Vec3::Zero();
        for (std::size_t i = 0; i < place.vertices.size(); ++i)
          reported.where += place.weights[i] * vertex_at(at.positions, place.vertices[i]);
      }
      reported.min_N_mm = area == 0 ? mean - apart : std::min(reported.min_N_mm, mean - apart);
      const double middle = c.trace() / 2, off = std::sqrt(std::max(middle * middle - c.determinant(), 0.0));
      const double stretch = std::sqrt(middle + off) - 1;
      reported.strain = area == 0 ? stretch : std::max(reported.strain, stretch);
      area += place.area_mm2;
      if (response.state == energy::SheetState::wrinkled) wrinkled += place.area_mm2;
      if (response.state == energy::SheetState::slack) slack += place.area_mm2;
    }
    reported.wrinkled = wrinkled / area;
    reported.slack = slack / area;
    out.layers.push_back(reported);
  }
}

}  // namespace softkin::physical
