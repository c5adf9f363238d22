#pragma once

#include "model/block_mesh.hpp"
#include "random/draw.hpp"
#include "random/generator.hpp"

namespace softkin::random_robots {

/// What may be odd about a robot.
enum class Oddity {
  inverted,     // vertices moved far enough to turn elements over
  sliver,       // an element of next to no volume
  repeated,     // an element twice
  cracked,      // vertices doubled, so that elements part
  overlapping,  // a second block in the same place
  loose,        // a part that hangs on one vertex, or on none
  isolated,     // vertices of no element
  bad_cells,    // vertices that are not there, or twice in one element
  far_away,     // far from the origin, or of absurd size
  not_finite,
  materials,  // Poisson's ratios and moduli at their ends
  supports,   // too few, none, single axes, far displacements
  loads,      // absurd forces and gravity
  actuators,  // ranges, points, surfaces and regions that are not sensible
  commands,   // at the ends of ranges and outside
  rigid,
  voids,
  interrupted,
  impatient,  // few iterations allowed
  curved,     // order 2: edge nodes moved
  count
};

/// A case in the making. The mesh is of cells of about 1 until it is scaled.
struct Making {
  explicit Making(std::uint64_t seed) : draw(seed), later(seed ^ 0x6C61746572) { made.seed = seed; }

  Draw draw;
  Draw later;  // of what came to be drawn later: the rest of a seed's robot stays as it was
  RandomCase made;
  std::vector<Oddity> odd;
  std::array<int, 3> cells{1, 1, 1};
  Vec3 size{1, 1, 1};  // of the block
  bool physical = true, has_chamber = false, has_layer = false;
  double modulus = 1;  // of the first material [MPa]

  [[nodiscard]] bool is(Oddity oddity) const { return std::find(odd.begin(), odd.end(), oddity) != odd.end(); }
  [[nodiscard]] Mesh& mesh() { return made.spec.mesh; }
  [[nodiscard]] double longest() const { return size.maxCoeff(); }
};

/// Some robots are bags of film alone, flat at rest, on a floor too: the whole case; false: not this one.
[[nodiscard]] bool make_film(Making& m);
void make_mesh(Making& m);   // with its regions, before it is scaled
void spoil_mesh(Making& m);  // what is odd about it
void make_materials(Making& m);
void make_supports(Making& m);  // with rigid and void regions
void make_actuators(Making& m);
/// Brings the robot to its size and place.
void scale_robot(Making& m);
void make_loads(Making& m);  // of a robot that has its size
void make_commands(Making& m);
void make_options(Making& m);
/// Of some physical robots, after their commands.
void make_magnetism(Making& m);
/// Parts of some physical robots grow; after their commands, before supports turn.
void make_growth(Making& m);
/// Families of fibres in materials of some physical robots that do not grow.
void make_families(Making& m);
/// A liquid around some robots that have a weight; after all that gives them one.
void make_submerged(Making& m);
/// A part of some physical robots is a thousand times as stiff as the rest.
void make_stiff(Making& m);
/// Some physical robots come to rest on a floor; after all that changes the mesh.
void make_floor(Making& m);
/// Some target shapes have weights that do not depend on the mesh.
void make_weights(Making& m);
/// Rotates some supports by commanded angles.
void make_turns(Making& m);
void make_tractions(Making& m);
/// Moments on rigid ends; they and some pressures are commanded. After all that commands but loads.
void make_wrenches(Making& m);
/// Threads through some robots and around them, before what is spoilt.
void make_fibres(Making& m);
/// Sheets on faces of the body.
void make_layers(Making& m);
void make_mixed(Making& m);
/// Some chambers that would be commanded by volume are sealed with gas or liquid; after all that changes the mesh.
void make_sealed(Making& m);
/// Gives some cables friction, also in sheaths.
void make_friction(Making& m);

}  // namespace softkin::random_robots
