#pragma once

#include <softkin/model/model.hpp>

namespace softkin::physical {

/// Rejects a robot whose surfaces touch, cross or lie inside each other at rest. Contact only keeps surfaces apart that
/// are apart: such surfaces would stay as they are.
///
/// surfaces   as triangles; surfaces nearer than 1e-9 of the robot's diagonal touch. Only pairs that may touch are
///            checked, and of these no triangle and edge with a common vertex
/// inside     a vertex of each piece of a surface, by the parity of a ray through the other; an obstacle with a rim has
///            no inside; of a half-space every vertex
/// too close  a vertex of the robot and a triangle of it nearer than twice the contact distance that face each other
///            across empty space: the line from the vertex to the nearest point of the triangle leaves the outside of
///            the one and meets the outside of the other within 60 degrees of their normals. Neighbours do not count:
///            where the path to that point along edges to a corner of the triangle, and straight from there, is at most
///            6 times the distance plus the triangle's longest edge
/// throws     InvalidInput at the part's origin with the place [mm] and a cure
void check_contact_at_rest(const Model& model);

/// Rejects a start shape whose surfaces pass through each other.
///
/// throws  InvalidInput with the place [mm]
void check_contact_of_start(const Model& model, const Points& positions);

}  // namespace softkin::physical
