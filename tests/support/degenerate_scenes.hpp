#pragma once

#include <softkin/model/robot_spec.hpp>

namespace softkin::testing {

/// Two bodies, 12 mm wide and of some tens of tetrahedra, that are to meet where normals of contact are not unique: tip
/// over tip, edge over edge, faces flush. All in exact alignment.
///
/// source  the cases of K. Erleben, Methodology for assessing mesh-based contact point methods, ACM TOG 37 (3), 2018,
///         in their arrangement as unit tests of incremental potential contact; shapes of our own
enum class DegenerateCase {
  spikes,          // tip over tip
  spike_on_wedge,  // tip over the middle of an edge
  wedges,          // edge over an edge of the same direction, ends flush
  crossed_wedges,  // edge over an edge across it; not one of the ten
  spike_in_crack,  // tip over the bottom of a groove, whose sides are parallel to two of its faces
  wedge_in_crack,  // edge over that bottom, sides parallel
  spike_in_hole,   // its four faces over the four edges of a square hole
  cliff_edges,     // a block over a step whose edges are flush with its own on all four sides
  internal_edges,  // a block whose corners and edges are over edges inside a plane, along which it also slides
  sliding_spike,   // tip over such an edge, along which it also slides
  sliding_wedge,   // edge over such an edge, across which it also slides
  count
};

struct DegenerateScene {
  RobotSpec robot;  // named as the case is
  Index upper = 0;  // the first vertex of the upper body
};

/// gap    by which the upper body would have to fall to touch the lower one, everywhere at once [mm]: 0 < gap <= 4
/// press  by which its top is moved down [mm]; those that slide move along x as far
[[nodiscard]] DegenerateScene degenerate_scene(DegenerateCase kind, double gap, double press);

}  // namespace softkin::testing
