#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/statics/supports/actuator_measures.hpp>

namespace softkin::supports {

namespace {

Mat3 cross_matrix(const Vec3& v) {
  Mat3 m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

/// Shape functions of a face and their derivatives along its two coordinates at a quadrature point.
template <int N>
struct FacePoint {
  double weight;
  double shape[N], along[N], across[N];
};

FacePoint<3> flat_point() {
  return {0.5, {1.0 / 3, 1.0 / 3, 1.0 / 3}, {-1, 1, 0}, {-1, 0, 1}};
}

/// Exact for x . (dx/ds x dx/dt), which is of degree 4.
const std::array<FacePoint<6>, 6>& curved_points() {
  static const std::array<FacePoint<6>, 6> points = [] {
    std::array<FacePoint<6>, 6> all{};
    for (std::size_t q = 0; q < all.size(); ++q) {
      const TrianglePoint& point = triangle_rule()[q];
      all[q].weight = point.weight;
      for (int i = 0; i < 6; ++i) {
        all[q].shape[i] = point.shape[i];
        all[q].along[i] = point.along_u[i];
        all[q].across[i] = point.along_v[i];
      }
    }
    return all;
  }();
  return points;
}

template <int N>
struct Surface {
  Vec3 x = Vec3::Zero(), along = Vec3::Zero(), across = Vec3::Zero();

  Surface(const FacePoint<N>& p, const Vec3* nodes) {
    for (int i = 0; i < N; ++i) {
      x += p.shape[i] * nodes[i];
      along += p.along[i] * nodes[i];
      across += p.across[i] * nodes[i];
    }
  }
};

/// Volume of the cone from the origin to a face: integral of x . (dx/ds x dx/dt) / 3, and its gradient.
template <int N>
double face_volume(const FacePoint<N>& p, const Vec3* nodes, Vec3* gradient) {
  const Surface<N> s(p, nodes);
  const double w = p.weight / 3;
  for (int i = 0; gradient && i < N; ++i)
    gradient[i] += w * (p.shape[i] * s.along.cross(s.across) + p.along[i] * s.across.cross(s.x) +
                        p.across[i] * s.x.cross(s.along));
  return w * s.x.dot(s.along.cross(s.across));
}

template <int N>
void face_second_derivative(const FacePoint<N>& p, const Vec3* nodes, Mat3 (&blocks)[6][6]) {
  const Surface<N> s(p, nodes);
  const double w = p.weight / 3;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j)
      blocks[i][j] -= cross_matrix(w * ((p.shape[i] * p.along[j] - p.along[i] * p.shape[j]) * s.across +
                                        (p.across[i] * p.shape[j] - p.shape[i] * p.across[j]) * s.along +
                                        (p.along[i] * p.across[j] - p.across[i] * p.along[j]) * s.x));
}

/// Lengths below this are taken for zero [mm]: a segment so short pulls nowhere.
constexpr double min_length = 1e-12;

double segment_length(const Vec3* nodes, Vec3* gradient) {
  const Vec3 across = nodes[1] - nodes[0];
  const double length = across.norm();
  if (gradient && length > min_length) {
    gradient[0] -= across / length;
    gradient[1] += across / length;
  }
  return length;
}

void segment_second_derivative(const Vec3* nodes, Mat3 (&blocks)[6][6]) {
  const Vec3 across = nodes[1] - nodes[0];
  const double length = across.norm();
  if (length <= min_length) return;
  const Mat3 bend = (Mat3::Identity() - across * across.transpose() / (length * length)) / length;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) blocks[i][j] += i == j ? bend : Mat3(-bend);
}

double term_value(int count, const Vec3* nodes, Vec3* gradient) {
  if (count == 2) return segment_length(nodes, gradient);
  if (count == 3) return face_volume<3>(flat_point(), nodes, gradient);
  double volume = 0;
  for (const FacePoint<6>& p : curved_points()) volume += face_volume<6>(p, nodes, gradient);
  return volume;
}

void term_second_derivative(int count, const Vec3* nodes, Mat3 (&blocks)[6][6]) {
  for (auto& row : blocks)
    for (Mat3& block : row) block.setZero();
  if (count == 2) return segment_second_derivative(nodes, blocks);
  if (count == 3) return face_second_derivative<3>(flat_point(), nodes, blocks);
  for (const FacePoint<6>& p : curved_points()) face_second_derivative<6>(p, nodes, blocks);
}

}  // namespace

ActuatorMeasures::ActuatorMeasures(const Model& model) : vertices_(model.rest.rows()), terms_(model.actuators.size()) {
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    const Index first = vertices_ + std::ssize(points_);
    if (const auto* cable = actuator.as<CableDrive>()) {
      for (const EmbeddedPoint& point : cable->points) points_.push_back(&point);
      for (Index i = 0; i + 1 < std::ssize(cable->points); ++i)
        terms_[a].push_back({2, {first + i, first + i + 1}, {}});
    }
    const auto* chamber = actuator.as<ChamberDrive>();
    if (!chamber) continue;
    for (const EmbeddedPoint& point : chamber->points) points_.push_back(&point);
    for (const Triangle& t : chamber->surface) terms_[a].push_back({3, {first + t[0], first + t[1], first + t[2]}, {}});
    for (const CavityFace& face : chamber->cavity) {
      const Triangle& c = face.corners;
      if (face.edges[0] < 0)
        terms_[a].push_back({3, {c[0], c[1], c[2]}, {}});
      else
        terms_[a].push_back({6, {c[0], c[1], c[2], face.edges[0], face.edges[1], face.edges[2]}, {}});
    }
  }
  for (Index a = 0; a < std::ssize(terms_); ++a)
    rest_.push_back(measures(a) && !flat_at_rest(model.actuators[a]) ? value(a, model.rest)
                                                                     : model.actuators[a].rest_measure);
  for (Index a = 0; a < std::ssize(terms_); ++a) {
    const Actuator& actuator = model.actuators[a];
    const auto* cable = actuator.as<CableDrive>();
    const bool stretches = actuator.is<DeaDrive>() || actuator.is<GrowthDrive>();
    const bool constrains = !stretches && drives(actuator) && actuator.control != Control::load;
    const bool given_load = !constrains && (measures(a) || under_voltage(actuator));
    roles_.push_back({constrains, given_load, cable && !cable->pushes, cable ? 1.0 : -1.0,
                      actuator.is<ChamberDrive>() ? 1e-3 : 1.0, actuator.factor, actuator.offset,
                      filling_of(actuator)});
    any_filling_ = any_filling_ || filling_of(actuator);
  }
}

Vec3 ActuatorMeasures::at(Index node, const Points& positions) const {
  return node < vertices_ ? Vec3(positions.row(node).transpose()) : points_[node - vertices_]->at(positions);
}

void ActuatorMeasures::spread(Index node, const Vec3& vector, Points& gradient) const {
  if (node < vertices_) {
    gradient.row(node) += vector.transpose();
    return;
  }
  const EmbeddedPoint& point = *points_[node - vertices_];
  for (std::size_t k = 0; k < point.vertices.size(); ++k)
    gradient.row(point.vertices[k]) += point.weights[k] * vector.transpose();
}

double ActuatorMeasures::value(Index actuator, const Points& positions, Points* gradient) const {
  if (gradient) gradient->setZero(positions.rows(), 3);
  double sum = 0;
  for (const Term& term : terms_[actuator]) {
    Vec3 nodes[6], slopes[6];
    for (int i = 0; i < term.count; ++i) {
      nodes[i] = at(term.nodes[i], positions);
      slopes[i].setZero();
    }
    sum += term_value(term.count, nodes, gradient ? slopes : nullptr);
    for (int i = 0; gradient && i < term.count; ++i) spread(term.nodes[i], slopes[i], *gradient);
  }
  return sum;
}

std::vector<std::vector<ActuatorMeasures::Part>> ActuatorMeasures::parts_of(const Term& term) const {
  std::vector<std::vector<Part>> parts;
  for (int i = 0; i < term.count; ++i) {
    auto& fractions = parts.emplace_back();
    if (term.nodes[i] < vertices_) {
      fractions.emplace_back(term.nodes[i], 1.0);
      continue;
    }
    const EmbeddedPoint& point = *points_[term.nodes[i] - vertices_];
    for (std::size_t k = 0; k < point.vertices.size(); ++k) fractions.emplace_back(point.vertices[k], point.weights[k]);
  }
  return parts;
}

void ActuatorMeasures::add_cliques(linear::Cliques& cliques) {
  for (std::size_t a = 0; a < terms_.size(); ++a) {
    std::map<std::vector<Index>, std::size_t> cliques_of_vertices;
    for (std::size_t t = 0; t < terms_[a].size(); ++t) {
      Term& term = terms_[a][t];
      term.parts = parts_of(term);
      std::vector<Index> vertices;
      for (const auto& fractions : term.parts)
        for (const Part& part : fractions) vertices.push_back(part.first);
      sort_unique(vertices);
      const auto [found, is_new] = cliques_of_vertices.try_emplace(vertices, cliques_.size());
      if (is_new) {
        cliques_.push_back({static_cast<Index>(a), cliques.slots.back(), vertices, {}});
        cliques.add(vertices);
      }
      cliques_[found->second].terms.push_back(t);
      for (auto& fractions : term.parts)
        for (Part& part : fractions)
          part.first =
              static_cast<Index>(std::lower_bound(vertices.begin(), vertices.end(), part.first) - vertices.begin());
    }
  }
}

void ActuatorMeasures::second_derivative(const Clique& clique, const Points& positions, double scale,
                                         const Eigen::VectorXd& fractions, LargeVector<double>& slots) const {
  using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  const auto count = static_cast<std::int64_t>(clique.vertices.size());
  double* out = slots.data() + 9 * clique.slot;
  std::fill(out, out + 9 * (count * (count + 1) / 2), 0.0);
  if (scale == 0) return;
  for (const Index t : clique.terms) {
    const Term& term = terms_[clique.actuator][t];
    Mat3 blocks[6][6];
    Vec3 nodes[6];
    for (int i = 0; i < term.count; ++i) nodes[i] = at(term.nodes[i], positions);
    term_second_derivative(term.count, nodes, blocks);
    const double fraction = fractions.size() > 0 ? scale * fractions[t] : scale;
    for (int i = 0; i < term.count; ++i)
      for (int j = 0; j < term.count; ++j)
        for (const auto& [row, row_weight] : term.parts[i])
          for (const auto& [column, column_weight] : term.parts[j])
            if (row >= column)
              Block(out + 9 * (static_cast<std::int64_t>(row) * (row + 1) / 2 + column)) +=
                  fraction * row_weight * column_weight * blocks[i][j];
  }
}

void ActuatorMeasures::second_derivatives(const Points& positions, const Eigen::VectorXd& scale,
                                          const std::vector<Eigen::VectorXd>& fractions, LargeVector<double>& slots,
                                          Team& team) const {
  team.pieces(cliques_.size(), [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index a = cliques_[i].actuator;
      second_derivative(cliques_[i], positions, scale[a], fractions[a], slots);
    }
  });
}

}  // namespace softkin::supports
