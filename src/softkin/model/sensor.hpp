#pragma once

#include <softkin/model/model.hpp>

namespace softkin {

/// length: of a curve that is drawn on the body or runs in it, as a strain gauge or an optical fibre measures it.
/// angle: by which one section is turned against another about an axis, as a bend sensor measures it.
/// direction: of an axis that turns with a section, as an inertial or magnetic tracker measures it.
enum class SensorKind { length, angle, direction };

/// A sensor as the user describes it.
struct SensorSpec {
  std::string name;                       // for columns of tables
  SensorKind kind = SensorKind::length;   // what it measures
  std::vector<Vec3> points;               // length: corners of the curve at rest [mm], at least two
  std::array<std::string, 2> sections{};  // angle: regions, from the first to the second; direction: the first alone
  Vec3 axis{0, 0, 1};                     // both: at rest, not 0; it turns with the first section
  std::string robot{};                    // of several: whose elements carry it; empty: the nearest
  Origin origin{};                        // of its entry, for messages
};

/// A region that turns as its vertices do: markers on stems along x, y and z.
struct TurningSection {
  std::array<Marker, 3> along;  // they turn as the section does

  /// R, the rotation from rest that fits the vertices best.
  [[nodiscard]] Mat3 rotation(const Points& positions) const;
  /// Its derivative along moves of the vertices, #V by 3.
  [[nodiscard]] Mat3 velocity(const Points& positions, const Points& moves) const;
};

/// A compiled sensor: a number as a function of the shape, or three.
struct Sensor {
  std::string name;                          // for columns of tables
  SensorKind kind = SensorKind::length;      // what it measures
  std::vector<FibrePlace> places;            // length: along the curve
  std::array<TurningSection, 2> sections{};  // angle; direction: the first
  Vec3 axis{0, 0, 1};                        // both: of length 1

  /// positions  #V by 3 [mm]
  /// component  of a direction: along which axis of space
  /// returns    length: sum of length_at_rest |sum of slope x| [mm]. angle: of R = R_1^T R_2, the turn about the axis,
  ///            2 atan2(axis . (R_32 - R_23, R_13 - R_31, R_21 - R_12), 1 + tr R), in (-360, 360], 0 at rest [degrees].
  ///            direction: of R axis, R the rotation of the section [-]
  /// source     the twist of the unit quaternion of R, whose vector part is (R_32 - R_23, ...) / 4 over its scalar part
  [[nodiscard]] double at(const Points& positions, int component = 0) const;

  /// How it changes where the vertices move: its derivative along moves, #V by 3 [its unit per unit of moves].
  [[nodiscard]] double velocity(const Points& positions, const Points& moves, int component = 0) const;
};

}  // namespace softkin
