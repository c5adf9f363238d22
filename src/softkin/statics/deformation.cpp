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
    const Strain strain = principal_strains(gradient);
    out.strain.push_back(strain);
    out.range.push_back({strain[2], strain[0]});
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
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    const TetrahedronNodes now = nodes_of(positions, model.elements.tetrahedra[e], model.elements.edge_nodes[e]);
    const TetrahedronNodes rest = nodes_of(model.rest, model.elements.tetrahedra[e], model.elements.edge_nodes[e]);
    double least = std::numeric_limits<double>::infinity();
    Strain most{};
    std::array<double, 2> range{};
    for (int i = 0; i < 4; ++i) {
      const Barycentric corner = Barycentric::Unit(i);
      const Mat3 gradient = frame(now, points[i]) * frame(rest, points[i]).inverse();
      least = std::min(
          {least, gradient.determinant(), frame(now, corner).determinant() / frame(rest, corner).determinant()});
      const Strain strain = principal_strains(gradient);
      if (i == 0 || std::abs(extreme(strain)) > std::abs(extreme(most))) most = strain;
      range = i == 0 ? std::array{strain[2], strain[0]}
                     : std::array{std::min(range[0], strain[2]), std::max(range[1], strain[0])};
    }
    out.volume_ratio.push_back(least);
    out.strain.push_back(most);
    out.range.push_back(range);
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

double length_of(const CableDrive& cable, const Points& positions) {
  double sum = 0;
  for (std::size_t i = 1; i < cable.points.size(); ++i)
    sum += (cable.points[i].at(positions) - cable.points[i - 1].at(positions)).norm();
  return sum;
}

double volume_of(const Model& model, const ChamberDrive& chamber, const Points& positions) {
  if (!chamber.surface.empty()) {
    Points points(chamber.points.size(), 3);
    for (Index i = 0; i < points.rows(); ++i) points.row(i) = chamber.points[i].at(positions).transpose();
    return enclosed_volume(points, chamber.surface);
  }
  if (!chamber.cavity.empty()) return enclosed_volume(positions, chamber.cavity);
  double sum = 0;
  for (const Index e : chamber.tetrahedra) sum += signed_volume(positions, model.elements.tetrahedra[e]);
  return sum;
}

/// Length [mm], area [mm^2] or volume [mm^3]; 0 of what has none.
double measure_of(const Model& model, const Actuator& actuator, const Points& positions) {
  if (const auto* cable = actuator.as<CableDrive>()) return length_of(*cable, positions);
  if (const auto* chamber = actuator.as<ChamberDrive>()) return volume_of(model, *chamber, positions);
  double sum = 0;
  if (const auto* dea = actuator.as<DeaDrive>())
    for (const Index e : dea->prisms) sum += mean_area(positions, model.elements.prisms[e]);
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
  double strain;
  std::array<double, 2> range;
  double volume;
  Index material;
};

template <class Element>
Vec3 centroid(const Points& positions, const Element& element) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : element) sum += vertex_at(positions, v);
  return sum / static_cast<double>(element.size());
}

/// Elements of a material that no actuator deforms.
bool is_body(const ElementRole& role) {
  return role.material >= 0 && role.actuator < 0;
}

/// Of an element, tetrahedra first, then prisms.
const ElementRole& role_of(const Model& model, std::size_t element) {
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  return element < tetrahedra ? model.elements.tetrahedron_roles[element]
                              : model.elements.prism_roles[element - tetrahedra];
}

Vec3 centroid_of(const Model& model, const Points& positions, std::size_t element) {
  const std::size_t tetrahedra = model.elements.tetrahedra.size();
  return element < tetrahedra ? centroid(positions, model.elements.tetrahedra[element])
                              : centroid(positions, model.elements.prisms[element - tetrahedra]);
}

std::vector<Sample> body_samples(const Model& model, const ElementDeformation& deformation) {
  std::vector<Sample> samples;
  const auto add = [&](const std::vector<ElementRole>& roles, const std::vector<double>& volumes, std::size_t first) {
    for (std::size_t e = 0; e < roles.size(); ++e) {
      if (!is_body(roles[e])) continue;
      samples.push_back(
          {extreme(deformation.strain[first + e]), deformation.range[first + e], volumes[e], roles[e].material});
    }
  };
  add(model.elements.tetrahedron_roles, model.elements.tetrahedron_volumes, 0);
  add(model.elements.prism_roles, model.elements.prism_volumes, model.elements.tetrahedra.size());
  return samples;
}

}  // namespace

double achieved_ratio(const Model& model, const Actuator& actuator, const Points& positions) {
  // a surface's own rest volume, where the elements inside it fill it only roughly
  const auto* chamber = actuator.as<ChamberDrive>();
  const bool by_surface = chamber && !chamber->surface.empty();
  const double rest = by_surface ? measure_of(model, actuator, model.rest) : actuator.rest_measure;
  return measure_of(model, actuator, positions) / rest;
}

ElementDeformation deformation_of(const Model& model, const Points& positions) {
  ElementDeformation deformation;
  if (model.elements.edge_nodes.empty())
    append(model, model.elements.tetrahedra, model.elements.tetrahedron_volumes, positions, deformation);
  else
    append_quadratic(model, positions, deformation);
  append(model, model.elements.prisms, model.elements.prism_volumes, positions, deformation);
  return deformation;
}

std::vector<Reaction> reactions(const Model& model, const Points& positions, const ElementDeformation& deformation) {
  std::vector<Reaction> all;
  if (deformation.reactions.rows() == 0) return all;
  for (const Support& support : model.held.supports) {
    Reaction& reaction = all.emplace_back();
    for (const Index v : support.vertices)
      reaction.center += vertex_at(positions, v) / static_cast<double>(support.vertices.size());
  }
  for (Index v = 0; v < positions.rows(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const Index s = model.held.support_of[v][axis];
      if (s < 0) continue;
      const Vec3 force = deformation.reactions(v, axis) * Vec3::Unit(axis);
      all[s].force += force;
      all[s].moment += (vertex_at(positions, v) - all[s].center).cross(force);
    }
  std::vector<Vec3> centers;
  for (const Reaction& reaction : all) centers.push_back(reaction.center);
  std::vector<std::vector<ChamberForce>> chambers = chamber_forces(model, positions, centers, deformation.multipliers);
  for (std::size_t s = 0; s < all.size(); ++s) all[s].chambers = std::move(chambers[s]);
  return all;
}

std::optional<StressExtremes> stress_extremes(const Model& model, const Points& positions,
                                              const ElementDeformation& deformation) {
  const ElementStress& stress = deformation.stress;
  std::size_t most = 0, greatest = 0, least = 0;
  bool any = false;
  for (std::size_t e = 0; e < stress.von_mises.size(); ++e) {
    if (!is_body(role_of(model, e))) continue;
    if (!any || stress.von_mises[e] > stress.von_mises[most]) most = e;
    if (!any || stress.principal[e][0] > stress.principal[greatest][0]) greatest = e;
    if (!any || stress.principal[e][2] < stress.principal[least][2]) least = e;
    any = true;
  }
  if (!any) return std::nullopt;
  const auto extreme = [&](double value, std::size_t e) {
    const Index region = role_of(model, e).region;
    return StressExtremes::Extreme{value, centroid_of(model, positions, e),
                                   region < 0 ? "" : model.elements.region_names[region]};
  };
  return StressExtremes{extreme(stress.von_mises[most], most), extreme(stress.principal[greatest][0], greatest),
                        extreme(stress.principal[least][2], least)};
}

StrainHistogram strain_histogram(const Model& model, const ElementDeformation& deformation) {
  StrainHistogram histogram;
  std::vector<Sample> samples = body_samples(model, deformation);
  if (samples.empty()) return histogram;
  double total = 0;
  double lowest = samples.front().strain, highest = lowest;  // of what the bins hold
  histogram.least = samples.front().range[0];
  histogram.greatest = samples.front().range[1];
  for (const Sample& s : samples) {
    total += s.volume;
    histogram.least = std::min(histogram.least, s.range[0]);
    histogram.greatest = std::max(histogram.greatest, s.range[1]);
    lowest = std::min(lowest, s.strain);
    highest = std::max(highest, s.strain);
  }
  const double width = bin_width(highest - lowest);
  const double first = std::floor(lowest / width);
  const auto bins = static_cast<std::size_t>(std::floor(highest / width) - first) + 1;
  histogram.fractions.assign(bins, 0);
  for (std::size_t i = 0; i <= bins; ++i) histogram.edges.push_back((first + static_cast<double>(i)) * width);
  for (const Sample& s : samples)
    histogram.fractions[std::min(bins - 1, static_cast<std::size_t>(std::floor(s.strain / width) - first))] +=
        s.volume / total;

  for (std::size_t m = 0; m < model.elements.materials.size(); ++m) {
    if (!model.elements.materials[m].linear_range) continue;
    double whole = 0, beyond = 0;
    for (const Sample& s : samples)
      if (s.material == static_cast<Index>(m)) {
        whole += s.volume;
        if (std::abs(s.strain) > *model.elements.materials[m].linear_range) beyond += s.volume;
      }
    if (whole > 0)  // else it is that of a dea alone
      histogram.beyond.push_back(
          {model.elements.materials[m].region, *model.elements.materials[m].linear_range, beyond / whole});
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
