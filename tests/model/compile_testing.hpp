#pragma once

#include <gtest/gtest.h>
#include <functional>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

#include "model/block_mesh.hpp"

namespace softkin::testing {

/// The message with which compile() refuses, or "" where it does not.
inline std::string refusal(const RobotSpec& spec) {
  try {
    (void)compile(spec);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

/// A change that makes a valid robot invalid, and a part of its message.
struct BadCase {
  std::string what;
  std::function<void(RobotSpec&)> change;
  std::string fragment;
};

/// Every change alone turns `good`, which compiles, into one that is refused with the fragment.
inline void expect_refused(const RobotSpec& good, const std::vector<BadCase>& cases) {
  ASSERT_EQ(refusal(good), "");
  for (const BadCase& bad : cases) {
    SCOPED_TRACE(bad.what);
    RobotSpec spec = good;
    bad.change(spec);
    EXPECT_NE(refusal(spec).find(bad.fragment), std::string::npos)
        << "wanted: " << bad.fragment << "\ngot: " << refusal(spec);
  }
}

inline Origin line(std::size_t number) {
  return {.file = "robot.yaml", .line = number};
}

inline RegionRef named(const std::string& name, std::size_t number = 1) {
  return {name, line(number)};
}

inline RegionRef shaped(const Selector& selector, std::size_t number = 1) {
  return {selector, line(number)};
}

inline PointRef at(double x, double y, double z) {
  return {Vec3(x, y, z), line(5)};
}

inline PointRef mean(const std::string& region) {
  return {region, line(6)};
}

inline ActuatorSpec actuator(const std::string& name, DriveSpec drive, double low, double high) {
  ActuatorSpec spec;
  spec.name = name;
  spec.drive = std::move(drive);
  spec.low = low;
  spec.high = high;
  spec.origin = line(9);
  return spec;
}

inline ActuatorSpec cable(std::vector<PointRef> points, double low = 0.9, double high = 1) {
  return actuator("tendon", CableSpec{.points = std::move(points)}, low, high);
}

inline ActuatorSpec chamber(const std::string& region) {
  return actuator("air", PneumaticSpec{.region = region}, 0.5, 3);
}

/// Of pressures.
inline ActuatorCurve straight_curve() {
  return {"curve.yaml", CurveInput::pressure, 100, "", {MonotoneCurve({0, 1}, {1, 2}), {}}, {}};
}

inline bool has_note(const Model& model, const std::string& fragment) {
  for (const std::string& note : model.notes)
    if (note.find(fragment) != std::string::npos) return true;
  return false;
}

}  // namespace softkin::testing
