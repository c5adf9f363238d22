#include <Eigen/Geometry>
#include <softkin/kinematics/maps/measure_gradient.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>

namespace softkin::maps {

namespace {

class Gradient {
 public:
  explicit Gradient(const Points& positions) : positions_(positions), rows_(Points::Zero(positions.rows(), 3)) {}

  [[nodiscard]] Points take() { return std::move(rows_); }

  void add(const CableDrive& cable) {
    for (std::size_t i = 1; i < cable.points.size(); ++i) {
      const Vec3 across = cable.points[i].at(positions_) - cable.points[i - 1].at(positions_);
      if (!(across.norm() > 0)) continue;
      add(cable.points[i], across.normalized());
      add(cable.points[i - 1], -across.normalized());
    }
  }

  void add(const Model& model, const ChamberDrive& chamber) {
    for (const Triangle& t : chamber.surface) {
      std::array<Vec3, 3> corners;
      for (int i = 0; i < 3; ++i) corners[i] = chamber.points[t[i]].at(positions_);
      for (int i = 0; i < 3; ++i) add(chamber.points[t[i]], corners[(i + 1) % 3].cross(corners[(i + 2) % 3]) / 6);
    }
    if (!chamber.surface.empty()) return;
    for (const CavityFace& face : chamber.cavity) face.edges[0] < 0 ? add(face.corners) : add_curved(face);
    if (!chamber.cavity.empty()) return;
    for (const Index e : chamber.tetrahedra) {
      const Tetrahedron& t = model.elements.tetrahedra[e];
      for (const Triangle& side : {Triangle{t[0], t[2], t[1]}, Triangle{t[0], t[1], t[3]}, Triangle{t[1], t[2], t[3]},
                                   Triangle{t[0], t[3], t[2]}})
        add(side);
    }
  }

  void add(const Model& model, const DeaDrive& layer) {
    for (const Index e : layer.prisms) {
      const Prism& prism = model.elements.prisms[e];
      for (int first = 0; first < 6; first += 3) add_half_area({prism[first], prism[first + 1], prism[first + 2]});
    }
  }

 private:
  [[nodiscard]] Vec3 at(Index vertex) const { return positions_.row(vertex).transpose(); }

  void add(const EmbeddedPoint& point, const Vec3& slope) {
    for (std::size_t k = 0; k < point.vertices.size(); ++k)
      rows_.row(point.vertices[k]) += (point.weights[k] * slope).transpose();
  }

  /// Volume of the cone from the origin to a flat face.
  void add(const Triangle& t) {
    for (int i = 0; i < 3; ++i) rows_.row(t[i]) += (at(t[(i + 1) % 3]).cross(at(t[(i + 2) % 3])) / 6).transpose();
  }

  /// The same of a curved face: the integral of x . (dx/du x dx/dv) / 3.
  void add_curved(const CavityFace& face) {
    const std::array<Index, 6> nodes{face.corners[0], face.corners[1], face.corners[2],
                                     face.edges[0],   face.edges[1],   face.edges[2]};
    for (const TrianglePoint& p : triangle_rule()) {
      Vec3 x = Vec3::Zero(), u = x, v = x;
      for (int i = 0; i < 6; ++i) {
        x += p.shape[i] * at(nodes[i]);
        u += p.along_u[i] * at(nodes[i]);
        v += p.along_v[i] * at(nodes[i]);
      }
      for (int i = 0; i < 6; ++i)
        rows_.row(nodes[i]) +=
            (p.weight / 3 * (p.shape[i] * u.cross(v) + p.along_u[i] * v.cross(x) + p.along_v[i] * x.cross(u)))
                .transpose();
    }
  }

  /// Half the area of a triangle.
  void add_half_area(const Triangle& t) {
    const Vec3 normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).stableNormalized();
    for (int i = 0; i < 3; ++i)
      rows_.row(t[i]) += 0.25 * normal.cross(at(t[(i + 2) % 3]) - at(t[(i + 1) % 3])).transpose();
  }

  const Points& positions_;
  Points rows_;
};

}  // namespace

Points measure_gradient(const Model& model, const Actuator& actuator, const Points& positions) {
  Gradient gradient(positions);
  if (const auto* cable = actuator.as<CableDrive>()) gradient.add(*cable);
  if (const auto* chamber = actuator.as<ChamberDrive>()) gradient.add(model, *chamber);
  if (const auto* layer = actuator.as<DeaDrive>()) gradient.add(model, *layer);
  return gradient.take();
}

}  // namespace softkin::maps
