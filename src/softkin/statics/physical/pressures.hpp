#pragma once

#include <memory>
#include <softkin/model/model.hpp>

namespace softkin::physical {

/// The pressures of mixed elements (energy/pressure.hpp). Each is an additional vertex after those of the robot, whose
/// x is the pressure over `unit` and whose y and z are fixed, so that code for vertices applies to pressures, too.
/// There is one for each corner, material and growth: stress is discontinuous where these meet.
struct Pressures {
  Index first = 0;                       // of the vertices
  std::vector<Index> corners;            // vertex at which each of them is located
  std::vector<std::array<Index, 4>> of;  // vertices by tetrahedron and corner; -1: it has none
  double unit = 1;                       // [MPa/mm]: scales pressures to the size of moves

  [[nodiscard]] Index count() const { return corners.size(); }
};

/// Returns none if no material is mixed. like: those of the same robot with other parameters; null: none
[[nodiscard]] std::unique_ptr<const Pressures> pressures_of(const Model& model, const Pressures* like);

/// Returns the model with these vertices added.
[[nodiscard]] std::unique_ptr<const Model> with_vertices(const Model& model, const Pressures& pressures);

/// The law of a mixed material without the part of its bulk modulus that the pressures represent. The rest, up to two
/// shear moduli, causes no locking, and keeps the stiffness without pressures positive where the body is stable.
struct SplitLaw {
  ElasticLaw law;
  double softness = 0;   // of the pressures [1/MPa]
  double smoothing = 0;  // of linear tetrahedra [1/MPa]
};
[[nodiscard]] SplitLaw split(const ElasticLaw& law, bool quadratic);

}  // namespace softkin::physical
