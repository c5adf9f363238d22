#pragma once

#include <memory>
#include <softkin/model/model.hpp>

namespace softkin::physical {

/// The pressures of elements that keep their volume by them (energy/pressure.hpp), a vertex more for each behind those
/// of the robot, whose x is the pressure over `unit` and whose y and z are held: what knows of vertices knows of them.
/// One for each corner, material and what lets it grow: where two of them meet, stress jumps.
struct Pressures {
  Index first = 0;                       // of the vertices
  std::vector<Index> corners;            // of each: where it stands
  std::vector<std::array<Index, 4>> of;  // vertices by tetrahedron and corner; -1: it has none
  double unit = 1;                       // [MPa/mm]: makes them about as large as moves

  [[nodiscard]] Index count() const { return corners.size(); }
};

/// None where no material is mixed. like: of a robot with other numbers; null: none
[[nodiscard]] std::unique_ptr<const Pressures> pressures_of(const Model& model, const Pressures* like);

/// The model with these vertices.
[[nodiscard]] std::unique_ptr<const Model> with_vertices(const Model& model, const Pressures& pressures);

/// The law of a mixed material without that part of its bulk modulus which the pressures stand for. What is left, up to
/// two shear moduli, locks nothing, and makes the stiffness without them positive where the body is stable.
struct SplitLaw {
  ElasticLaw law;
  double softness = 0;   // of the pressures [1/MPa]
  double smoothing = 0;  // of linear tetrahedra [1/MPa]
};
[[nodiscard]] SplitLaw split(const ElasticLaw& law, bool quadratic);

}  // namespace softkin::physical
