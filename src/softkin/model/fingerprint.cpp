#include <softkin/model/fingerprint.hpp>

#include <bit>
#include <cstdint>
#include <cstdio>
#include <type_traits>

namespace softkin {

namespace {

class Hash {
 public:
  template <class... Values>
  void add(const Values&... values) {
    (put(values), ...);
  }

  [[nodiscard]] std::string text() const {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(state_));
    return digits;
  }

 private:
  void word(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) {
      state_ ^= (value >> shift) & 0xFF;
      state_ *= 0x100000001b3;
    }
  }
  void put(double value) { word(std::bit_cast<std::uint64_t>(value)); }
  template <class Whole>
  requires std::is_integral_v<Whole> || std::is_enum_v<Whole>
  void put(Whole value) { word(static_cast<std::uint64_t>(value)); }
  void put(const std::string& text) {
    put(text.size());
    for (const char c : text) put(c);
  }
  void put(const Points& points) {
    put(points.rows());
    for (Eigen::Index i = 0; i < points.size(); ++i) put(points.data()[i]);
  }
  template <class Item>
  void put(const std::vector<Item>& items) {
    put(items.size());
    for (const auto& item : items) put(item);
  }
  template <class Item, std::size_t N>
  void put(const std::array<Item, N>& items) {
    for (const Item& item : items) put(item);
  }
  void put(const std::optional<double>& value) { add(value.has_value(), value.value_or(0)); }
  void put(const ElementRole& role) { add(role.material, role.actuator, role.region); }
  void put(const ElasticLaw& e) { add(e.law, e.mu, e.lambda, e.c10, e.c01, e.c20, e.c30, e.bulk); }
  void put(const Material& m) { add(m.region, m.shape_ratio, m.weight, m.elastic, m.density, m.linear_range); }
  void put(const CavityFace& face) { add(face.corners, face.edges); }
  void put(const EmbeddedPoint& p) { add(p.vertices, p.weights); }
  void put(const CableGap& gap) { add(gap.segment, gap.apex); }
  void put(const Marker& marker) { add(marker.name, marker.point); }
  void put(const RigidRegion& region) { add(region.name, region.vertices); }
  void put(const Actuator& a) {
    add(a.name, a.kind, a.control, a.rest, a.weight, a.least_norm, a.tetrahedra, a.cavity, a.prisms, a.points,
        a.surface, a.gaps, a.rest_measure);
  }

  std::uint64_t state_ = 0xcbf29ce484222325;
};

}  // namespace

std::string fingerprint_of(const Model& model) {
  Hash hash;
  hash.add(model.formulation, model.rest, model.tetrahedra, model.edge_nodes, model.prisms, model.tetrahedron_roles,
           model.prism_roles, model.region_names, model.materials, model.actuators, model.markers, model.rigid,
           model.fixed, model.held, model.dead_load);
  return hash.text();
}

std::string fingerprint_of(const Points& positions) {
  Hash hash;
  hash.add(positions);
  return hash.text();
}

}  // namespace softkin
