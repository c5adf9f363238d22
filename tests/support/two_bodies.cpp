#include "support/two_bodies.hpp"

namespace softkin::testing {

namespace {

void add_held(RobotSpec& spec, const std::string& name, const std::vector<Index>& vertices, Index first,
              const Vec3& displacement) {
  Region region;
  region.name = name;
  region.dimension = 0;
  for (const Index v : vertices) region.vertices.push_back(first + v);
  sort_unique(region.vertices);
  spec.mesh.regions.push_back(std::move(region));
  spec.fixed.push_back({{name, {}}, {true, true, true}, displacement});
}

}  // namespace

RobotSpec two_bodies(const std::string& name, const PressedBody& lower, const PressedBody& upper,
                     const Vec3& displacement) {
  RobotSpec spec;
  spec.name = name;
  spec.formulation = Formulation::physical;
  const Index first = lower.vertices.rows();
  spec.mesh.vertices.resize(first + upper.vertices.rows(), 3);
  spec.mesh.vertices << lower.vertices, upper.vertices;
  spec.mesh.tetrahedra = lower.tetrahedra;
  for (Tetrahedron t : upper.tetrahedra) {
    for (Index& v : t) v += first;
    spec.mesh.tetrahedra.push_back(t);
  }
  MaterialSpec material;
  material.region = "all";
  material.shape_ratio.reset();
  material.elastic.emplace();
  material.elastic->youngs_modulus = 0.1;
  material.elastic->poisson_ratio = 0.4;
  spec.materials.push_back(material);
  add_held(spec, "bottom", lower.held, 0, Vec3::Zero());
  add_held(spec, "top", upper.held, first, displacement);
  return spec;
}

Points moved_from(Index first, const Points& positions, const Vec3& move) {
  Points moved = positions;
  moved.bottomRows(positions.rows() - first).rowwise() += move.transpose();
  return moved;
}

}  // namespace softkin::testing
