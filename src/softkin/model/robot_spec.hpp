#pragma once

#include <optional>
#include <softkin/core/error.hpp>
#include <softkin/model/mesh.hpp>
#include <variant>

namespace softkin {

// Shapes that select vertices (inside or on the boundary) and elements (centroid inside). Lengths in mm.
struct Box {
  Vec3 low, high;
};
struct Sphere {
  Vec3 center;
  double radius = 0;
};
struct Cylinder {  // finite, flat ends
  Vec3 start, end;
  double radius = 0;
};
struct Halfspace {  // the side to which the normal points
  Vec3 point, normal;
};
struct VertexList {
  std::vector<Index> vertices;  // from 0
};
struct ElementList {
  std::vector<Index> tetrahedra;  // from 0
};
using Selector = std::variant<Box, Sphere, Cylinder, Halfspace, VertexList, ElementList>;

/// A region by name, or a shape in its place.
struct RegionRef {
  std::variant<std::string, Selector> region;
  Origin origin;
};

/// A point by coordinates [mm], or the mean of a region (volume- or area-weighted) by its name.
struct PointRef {
  std::variant<Vec3, std::string> point;
  Origin origin;
};

struct RegionSpec {
  std::string name;
  Selector selector;
  Origin origin;
};

/// Later entries override earlier ones where their regions overlap. The region "all" is every element.
struct MaterialSpec {
  std::string region;
  double shape_ratio = 1;              // R_omega, 0 <= shape_ratio <= 1
  double weight = 1;                   // w of Eq. (9), > 0
  std::optional<double> linear_range;  // largest |principal strain| of the linear range [-], > 0
  Origin origin;
};

struct FixedSpec {
  RegionRef where;
  std::array<bool, 3> axes{true, true, true};
  Vec3 displacement{0, 0, 0};  // where it is held, from its place at rest [mm]; 0 along axes that are not held
};

enum class ActuatorKind { cable, dea, pneumatic };

struct ActuatorSpec {
  std::string name;
  ActuatorKind kind = ActuatorKind::pneumatic;
  std::optional<std::string> region;       // dea, pneumatic: the volume region of its elements
  std::optional<TriangleSurface> surface;  // pneumatic: cavity surface instead of a region [mm]
  std::vector<PointRef> points;            // cable: at least two, in order
  std::vector<PointRef> apexes;            // cable: third corner of each gap's triangle; none: found by compile()
  double low = 0, high = 0;                // range of the ratio [-], 0 < low <= high
  double rest = 1;                         // ratio where none is asked for [-]; a dea's prestretch
  double weight = 5;                       // w of Eq. (9), > 0
  bool least_norm = true;                  // false: every element takes the actuator's ratio
  Origin origin;
};

struct MarkerSpec {
  std::string name;
  PointRef at;
};

struct RigidSpec {
  RegionRef where;
  std::string name;
};

/// A robot as the user describes it: plain data, lengths in mm. compile() turns it into a Model.
struct RobotSpec {
  std::string name;  // the scene's file name, for messages
  Mesh mesh;         // in mm
  std::vector<RegionSpec> regions;
  std::vector<MaterialSpec> materials;
  std::vector<RegionRef> voids;
  std::vector<FixedSpec> fixed;
  std::vector<RigidSpec> rigid;
  std::vector<ActuatorSpec> actuators;
  std::vector<MarkerSpec> markers;
};

}  // namespace softkin
