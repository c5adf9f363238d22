#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/statics/deformation.hpp>

namespace softkin {

namespace {

/// Columns: derivatives of the position along the element's own three directions (prism: at its centre).
Mat3 frame(const Points& p, const Tetrahedron& t) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.col(i) = (p.row(t[i + 1]) - p.row(t[0])).transpose();
  return m;
}

Mat3 frame(const Points& p, const Prism& e) {
  Mat3 m;
  for (int i = 0; i < 2; ++i)
    m.col(i) = 0.5 * (p.row(e[i + 1]) - p.row(e[0]) + p.row(e[i + 4]) - p.row(e[3])).transpose();
  m.col(2) = (p.row(e[3]) + p.row(e[4]) + p.row(e[5]) - p.row(e[0]) - p.row(e[1]) - p.row(e[2])).transpose() / 3;
  return m;
}

/// At a point of a tetrahedron of order 2.
Mat3 frame(const TetrahedronNodes& nodes, const Barycentric& l) {
  const Eigen::Matrix<double, 3, 4> along = nodes.transpose() * quadratic_slope(l);
  return along.rightCols<3>().colwise() - along.col(0);
}

using Strain = std::array<double, 3>;

Strain principal_strains(const Mat3& gradient) {
  Vec3 stretches = Eigen::JacobiSVD<Mat3>(gradient).singularValues();
  if (gradient.determinant() < 0) stretches[2] = -stretches[2];
  return {stretches[0] - 1, stretches[1] - 1, stretches[2] - 1};
}

template <class Element>
void append(const Model& model, const std::vector<Element>& elements, const std::vector<double>& volumes,
            const Points& positions, ElementDeformation& out) {
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const Mat3 gradient = frame(positions, elements[e]) * frame(model.rest, elements[e]).inverse();
    out.volume_ratio.push_back(signed_volume(positions, elements[e]) / volumes[e]);
    out.strain.push_back(principal_strains(gradient));
  }
}

/// The strain of largest magnitude.
double extreme(const Strain& strain) {
  return std::abs(strain[0]) >= std::abs(strain[2]) ? strain[0] : strain[2];
}

/// The four points with which the energy of a tetrahedron of order 2 is integrated.
std::array<Barycentric, 4> integration_points() {
  constexpr double a = 0.13819660112501051518;  // (5 - sqrt 5) / 20
  std::array<Barycentric, 4> points;
  for (int i = 0; i < 4; ++i) points[i] = Barycentric::Constant(a) + (1 - 4 * a) * Barycentric::Unit(i);
  return points;
}

void append_quadratic(const Model& model, const Points& positions, ElementDeformation& out) {
  const std::array<Barycentric, 4> points = integration_points();
  for (std::size_t e = 0; e < model.tetrahedra.size(); ++e) {
    const TetrahedronNodes now = nodes_of(positions, model.tetrahedra[e], model.edge_nodes[e]);
    const TetrahedronNodes rest = nodes_of(model.rest, model.tetrahedra[e], model.edge_nodes[e]);
    double least = std::numeric_limits<double>::infinity();
    Strain most{};
    for (int i = 0; i < 4; ++i) {
      const Barycentric corner = Barycentric::Unit(i);
      const Mat3 gradient = frame(now, points[i]) * frame(rest, points[i]).inverse();
      least = std::min(
          {least, gradient.determinant(), frame(now, corner).determinant() / frame(rest, corner).determinant()});
      const Strain strain = principal_strains(gradient);
      if (i == 0 || std::abs(extreme(strain)) > std::abs(extreme(most))) most = strain;
    }
    out.volume_ratio.push_back(least);
    out.strain.push_back(most);
  }
}

double mean_area(const Points& p, const Prism& e) {
  double sum = 0;
  for (int t = 0; t < 6; t += 3) {
    const Vec3 u = p.row(e[t + 1]) - p.row(e[t]), v = p.row(e[t + 2]) - p.row(e[t]);
    sum += 0.25 * u.cross(v).norm();
  }
  return sum;
}

double measure_of(const Model& model, const Actuator& actuator, const Points& positions) {
  double sum = 0;
  if (actuator.kind == ActuatorKind::cable) {
    for (std::size_t i = 1; i < actuator.points.size(); ++i)
      sum += (actuator.points[i].at(positions) - actuator.points[i - 1].at(positions)).norm();
  } else if (actuator.kind == ActuatorKind::dea) {
    for (const Index e : actuator.prisms) sum += mean_area(positions, model.prisms[e]);
  } else if (!actuator.surface.empty()) {
    Points points(static_cast<Index>(actuator.points.size()), 3);
    for (Index i = 0; i < points.rows(); ++i) points.row(i) = actuator.points[i].at(positions).transpose();
    sum = enclosed_volume(points, actuator.surface);
  } else if (!actuator.cavity.empty()) {
    sum = enclosed_volume(positions, actuator.cavity);
  } else {
    for (const Index e : actuator.tetrahedra) sum += signed_volume(positions, model.tetrahedra[e]);
  }
  return sum;
}

/// 1, 2 or 5 times a power of ten that cuts `range` into at most 40 bins.
double bin_width(double range) {
  const double least = std::max(range / 40, 1e-6);
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

struct Sample {
  double strain, volume;
  Index material;
};

std::vector<Sample> body_samples(const Model& model, const ElementDeformation& deformation) {
  std::vector<Sample> samples;
  const auto add = [&](const std::vector<ElementRole>& roles, const std::vector<double>& volumes, std::size_t first) {
    for (std::size_t e = 0; e < roles.size(); ++e) {
      if (roles[e].material < 0 || roles[e].actuator >= 0) continue;
      samples.push_back({extreme(deformation.strain[first + e]), volumes[e], roles[e].material});
    }
  };
  add(model.tetrahedron_roles, model.tetrahedron_volumes, 0);
  add(model.prism_roles, model.prism_volumes, model.tetrahedra.size());
  return samples;
}

}  // namespace

double achieved_ratio(const Model& model, const Actuator& actuator, const Points& positions) {
  // a surface's own rest volume, where the elements inside it fill it only roughly
  const double rest = actuator.surface.empty() ? actuator.rest_measure : measure_of(model, actuator, model.rest);
  return measure_of(model, actuator, positions) / rest;
}

ElementDeformation deformation_of(const Model& model, const Points& positions) {
  ElementDeformation deformation;
  if (model.edge_nodes.empty())
    append(model, model.tetrahedra, model.tetrahedron_volumes, positions, deformation);
  else
    append_quadratic(model, positions, deformation);
  append(model, model.prisms, model.prism_volumes, positions, deformation);
  return deformation;
}

StrainHistogram strain_histogram(const Model& model, const ElementDeformation& deformation) {
  StrainHistogram histogram;
  std::vector<Sample> samples = body_samples(model, deformation);
  if (samples.empty()) return histogram;
  double total = 0;
  histogram.least = histogram.greatest = samples.front().strain;
  for (const Sample& s : samples) {
    total += s.volume;
    histogram.least = std::min(histogram.least, s.strain);
    histogram.greatest = std::max(histogram.greatest, s.strain);
  }
  const double width = bin_width(histogram.greatest - histogram.least);
  const double first = std::floor(histogram.least / width);
  const auto bins = static_cast<std::size_t>(std::floor(histogram.greatest / width) - first) + 1;
  histogram.shares.assign(bins, 0);
  for (std::size_t i = 0; i <= bins; ++i) histogram.edges.push_back((first + static_cast<double>(i)) * width);
  for (const Sample& s : samples)
    histogram.shares[std::min(bins - 1, static_cast<std::size_t>(std::floor(s.strain / width) - first))] +=
        s.volume / total;

  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    if (!model.materials[m].linear_range) continue;
    double whole = 0, beyond = 0;
    for (const Sample& s : samples)
      if (s.material == static_cast<Index>(m)) {
        whole += s.volume;
        if (std::abs(s.strain) > *model.materials[m].linear_range) beyond += s.volume;
      }
    if (whole > 0)  // else it is that of a dea alone
      histogram.beyond.push_back({model.materials[m].region, *model.materials[m].linear_range, beyond / whole});
  }
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return std::abs(a.strain) < std::abs(b.strain); });
  double below = 0;
  for (const Sample& s : samples) {
    histogram.percentile_95 = std::abs(s.strain);
    if ((below += s.volume) >= 0.95 * total) break;
  }
  return histogram;
}

}  // namespace softkin
