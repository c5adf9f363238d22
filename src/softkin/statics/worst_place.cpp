#include <algorithm>
#include <cmath>
#include <softkin/statics/worst_place.hpp>
#include <span>

namespace softkin {

namespace {

/// An element with a smaller volume ratio than this ranks by that, else by its strain.
constexpr double crushed = 0.2;
constexpr double near_edges = 2;

double largest_strain(const std::array<double, 3>& strain) {
  return std::abs(strain[0]) >= std::abs(strain[2]) ? strain[0] : strain[2];
}

/// Number among all elements, tetrahedra first.
std::optional<std::size_t> worst_element(const Model& model, const ElementDeformation& deformation) {
  std::optional<std::size_t> worst;
  const auto is_worse = [&](std::size_t a, std::size_t b) {
    const double volume_a = std::min(crushed, deformation.volume_ratio[a]);
    const double volume_b = std::min(crushed, deformation.volume_ratio[b]);
    if (volume_a != volume_b) return volume_a < volume_b;
    return std::abs(largest_strain(deformation.strain[a])) > std::abs(largest_strain(deformation.strain[b]));
  };
  const auto look = [&](const std::vector<ElementRole>& roles, std::size_t first) {
    for (std::size_t e = 0; e < roles.size(); ++e)
      if (roles[e].material >= 0 && (!worst || is_worse(first + e, *worst))) worst = first + e;
  };
  look(model.elements.tetrahedron_roles, 0);
  look(model.elements.prism_roles, model.elements.tetrahedra.size());
  return worst;
}

class Surroundings {
 public:
  Surroundings(const Model& model, const Points& positions, std::span<const Index> corners)
      : model_(model), positions_(positions), corners_(corners) {
    for (const Index a : corners_)
      for (const Index b : corners_) edge_ = std::max(edge_, (positions.row(a) - positions.row(b)).norm());
  }

  void describe(WorstPlace& place) const {
    if (report_cables(place) || report_rigid(place) || report_chambers(place)) return;
    if (has([&](Index v) { return model_.held.fixed[v] != std::array<bool, 3>{}; })) place.beside = "what is held";
  }

 private:
  template <class Is>
  [[nodiscard]] bool has(const Is& is) const {
    return std::any_of(corners_.begin(), corners_.end(), is);
  }

  bool report_cables(WorstPlace& place) const {
    double nearest = near_edges * edge_;
    for (const Actuator& actuator : model_.actuators) {
      const auto* cable = actuator.as<CableDrive>();
      for (std::size_t i = 0; cable && i < cable->points.size(); ++i) {
        const double distance = (cable->points[i].at(positions_) - place.at).norm();
        if (distance >= nearest) continue;
        nearest = distance;
        const bool end = i == 0 || i + 1 == cable->points.size();
        place.beside =
            (end ? "the end of cable '" : "point " + std::to_string(i + 1) + " of cable '") + actuator.name + "'";
      }
    }
    return !place.beside.empty();
  }

  bool report_rigid(WorstPlace& place) const {
    for (const RigidRegion& rigid : model_.rigid)
      if (has([&](Index v) {
            return std::find(rigid.vertices.begin(), rigid.vertices.end(), v) != rigid.vertices.end();
          }))
        place.beside = "rigid region '" + rigid.name + "'";
    return !place.beside.empty();
  }

  bool report_chambers(WorstPlace& place) const {
    for (const Actuator& actuator : model_.actuators) {
      const auto* chamber = actuator.as<ChamberDrive>();
      const auto on_wall = [&](Index v) {
        return std::any_of(chamber->cavity.begin(), chamber->cavity.end(), [&](const CavityFace& face) {
          return std::find(face.corners.begin(), face.corners.end(), v) != face.corners.end();
        });
      };
      if (chamber && has(on_wall)) place.beside = "the wall of chamber '" + actuator.name + "'";
    }
    return !place.beside.empty();
  }

  const Model& model_;
  const Points& positions_;
  std::span<const Index> corners_;
  double edge_ = 0;  // longest [mm]
};

}  // namespace

std::optional<WorstPlace> worst_place(const Model& model, const Points& positions,
                                      const ElementDeformation& deformation) {
  const std::optional<std::size_t> worst = worst_element(model, deformation);
  if (!worst) return std::nullopt;
  WorstPlace place;
  place.prism = *worst >= model.elements.tetrahedra.size();
  const std::size_t e = place.prism ? *worst - model.elements.tetrahedra.size() : *worst;
  place.element = e;
  const ElementRole& role = (place.prism ? model.elements.prism_roles : model.elements.tetrahedron_roles)[e];
  if (role.region >= 0) place.region = model.elements.region_names[role.region];
  place.strain = largest_strain(deformation.strain[*worst]);
  place.volume_ratio = deformation.volume_ratio[*worst];
  const std::span<const Index> corners = place.prism ? std::span<const Index>(model.elements.prisms[e])
                                                     : std::span<const Index>(model.elements.tetrahedra[e]);
  place.at.setZero();
  for (const Index v : corners) place.at += positions.row(v).transpose() / static_cast<double>(corners.size());
  Surroundings(model, positions, corners).describe(place);
  return place;
}

}  // namespace softkin
