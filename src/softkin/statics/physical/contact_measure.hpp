#pragma once

#include <softkin/statics/contact_forces.hpp>
#include <softkin/statics/physical/friction.hpp>

namespace softkin::physical {

/// Computes the contact forces of the terms of a shape. The pressure on a vertex is the sum of the normal forces on it
/// over the deformed area that faces that sum: a triangle gives its area in equal parts to those of its vertices that
/// carry pressure for an area of their own. A vertex without an area of its own, as between triangles that are much
/// smaller than most, passes its force to those around it, in proportion to their area that faces it, and gets the mean
/// of their pressures.
///
/// surfaces   of several parts
/// positions  of the ContactPoints
/// terms      of positions
/// holds      of the friction there, with their anchors
[[nodiscard]] ContactForces contact_forces(const ContactSurfaces& surfaces, const ContactPotential& potential,
                                           const Points& positions, const std::vector<ContactPotential::Term>& terms,
                                           const Friction& friction, const Friction::Holds& holds,
                                           const std::vector<Anchor>& anchors);

/// Returns the change of the gradient of these terms along moves of the points, including that by the normal forces of
/// friction [N]; arguments as above.
[[nodiscard]] Points contact_changes(const ContactPotential& potential, const Points& positions,
                                     const std::vector<ContactPotential::Term>& terms, const Friction& friction,
                                     const Friction::Holds& holds, const Points& moves);

}  // namespace softkin::physical
