#pragma once

#include <softkin/model/model.hpp>

namespace softkin::physical {

/// Refuses a robot at rest from which contact cannot start. Contact keeps surfaces apart that are apart: what touches,
/// crosses or lies inside at rest would stay so.
///
/// surfaces   as triangles; what is nearer than 1e-9 of the robot's diagonal touches. Only those that may touch; of a
///            triangle and an edge with a common vertex nothing is looked at
/// inside     a vertex of each piece of a surface, by the parity of a ray through the other; an obstacle with a rim has
///            no inside; of a half-space every vertex
/// too close  a vertex of the robot and a triangle of it nearer than twice the contact distance that face each other
///            across empty space: the way from the vertex to the nearest point of the triangle leaves the outside of
///            the one and meets the outside of the other within 60 degrees of their normals. Neighbours do not count:
///            where the way to that point along edges to a corner of the triangle, and straight from there, is at most
///            6 times the distance and the triangle's longest edge
/// throws     InvalidInput at the part's origin with the place [mm] and a cure
void check_contact_at_rest(const Model& model);

/// Refuses a shape to start from whose surfaces pass through each other.
///
/// throws  InvalidInput with the place [mm]
void check_contact_of_start(const Model& model, const Points& positions);

}  // namespace softkin::physical
