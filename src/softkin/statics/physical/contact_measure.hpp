#pragma once

#include <softkin/statics/contact_forces.hpp>
#include <softkin/statics/physical/friction.hpp>

namespace softkin::physical {

/// What the terms of a shape push with. The pressure on a vertex is the sum of the normal forces on it over the
/// deformed area that faces that sum: a triangle gives its area in equal parts to those of its vertices that carry
/// pressure for an area of their own. Where a vertex only stands guard, as between triangles that are much smaller than
/// most, its force goes to those around it, by the area of theirs that faces it, and it has the mean of their
/// pressures.
///
/// surfaces   of several parts
/// positions  of the ContactPoints
/// terms      of positions
/// holds      of the friction there, with their anchors
[[nodiscard]] ContactForces contact_forces(const ContactSurfaces& surfaces, const ContactPotential& potential,
                                           const Points& positions, const std::vector<ContactPotential::Term>& terms,
                                           const Friction& friction, const Friction::Holds& holds,
                                           const std::vector<Anchor>& anchors);

/// How their gradient changes along moves of the points, with what friction's normal forces change of it [N]; arguments
/// as above.
[[nodiscard]] Points contact_changes(const ContactPotential& potential, const Points& positions,
                                     const std::vector<ContactPotential::Term>& terms, const Friction& friction,
                                     const Friction::Holds& holds, const Points& moves);

}  // namespace softkin::physical
