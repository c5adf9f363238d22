#include <gtest/gtest.h>

#include "scene_fixtures.hpp"

namespace softkin {
namespace {

const std::string head_of_scene = "softkin: 1\nunits: {length: cm}\nmesh: {file: a.msh}\n";

RobotSpec scene(const std::string& text) {
  return parse_scene(head_of_scene + text, "s.yaml", fake_files());
}

std::string refusal_of(const std::string& text) {
  try {
    (void)scene(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

template <class Shape>
const Shape& shape_of(const RobotSpec& spec, std::size_t obstacle) {
  return std::get<Shape>(spec.contact->obstacles.at(obstacle).shape);
}

TEST(SceneContact, BodiesAndMotions) {
  const RobotSpec spec = scene(
      "obstacles:\n"
      "  - {name: ball, sphere: {center: [1, 2, 3], radius: 2}, motion: [z, x]}\n"
      "bodies:\n"
      "  - {name: cube, box: [[0, 0, 0], [1, 2, 3]], density: 1200, friction: 0.7}\n"
      "  - {name: pill, capsule: {start: [0, 0, 1], end: [1, 0, 0], radius: 0.25}}\n");
  const ContactSpec& contact = *spec.contact;
  EXPECT_EQ(contact.obstacles.at(0).motion, (std::array<bool, 3>{true, false, true}));
  ASSERT_EQ(contact.bodies.size(), 2u);
  EXPECT_EQ(contact.bodies[0].density, 1200);
  EXPECT_EQ(contact.bodies[0].friction, 0.7);
  EXPECT_LT((std::get<Box>(contact.bodies[0].shape).high - Vec3(10, 20, 30)).norm(), 1e-12);
  EXPECT_EQ(contact.bodies[1].density, 0);
  EXPECT_EQ(contact.bodies[1].origin.text(), "s.yaml:8");
  EXPECT_NE(refusal_of("bodies:\n  - {name: a, halfspace: {point: [0, 0, 0], normal: [0, 0, 1]}}\n").find("halfspace"),
            std::string::npos);
  EXPECT_NE(refusal_of("bodies:\n  - {name: a, box: [[0, 0, 0], [1, 1, 1]], density: -1}\n")
                .find("'density' must not be negative"),
            std::string::npos);
  EXPECT_NE(refusal_of("obstacles:\n  - {name: a, box: [[0, 0, 0], [1, 1, 1]], motion: [x, x]}\n").find("given twice"),
            std::string::npos);
}

TEST(SceneContact, NoneOfIt) {
  EXPECT_FALSE(scene("").contact.has_value());
}

TEST(SceneContact, Defaults) {
  for (const char* text : {"contact: {}\n", "obstacles: []\n"}) {
    const RobotSpec spec = scene(text);
    ASSERT_TRUE(spec.contact.has_value());
    EXPECT_FALSE(spec.contact->distance_mm.has_value());
    EXPECT_EQ(spec.contact->friction, 0);
    EXPECT_TRUE(spec.contact->self);
    EXPECT_TRUE(spec.contact->pairs.empty());
    EXPECT_TRUE(spec.contact->obstacles.empty());
    EXPECT_EQ(spec.contact->origin.text(), "s.yaml:4");
  }
}

TEST(SceneContact, EveryKey) {
  const RobotSpec spec = scene(
      "contact: {distance: 0.01, friction: 0.4, self: false, pairs: [{a: skin, b: ball, friction: 0.8}]}\n"
      "obstacles:\n"
      "  - {name: floor, halfspace: {point: [0, 0, -6], normal: [0, 0, 3]}, friction: 0.3}\n"
      "  - {name: ball, sphere: {center: [1, 2, 3], radius: 2}}\n"
      "  - {name: rod, cylinder: {start: [0, 0, 0], end: [1, 0, 0], radius: 0.5}}\n"
      "  - {name: pill, capsule: {start: [0, 0, 1], end: [1, 0, 0], radius: 0.25}}\n"
      "  - {name: step, box: [[0, 0, 0], [1, 2, 3]], friction: 0}\n"
      "  - {name: cup, surface: cup.stl}\n"
      "  - {name: mug, surface: {file: mug.stl, unit: m}}\n");
  const ContactSpec& contact = *spec.contact;
  EXPECT_DOUBLE_EQ(*contact.distance_mm, 0.1);
  EXPECT_EQ(contact.friction, 0.4);
  EXPECT_FALSE(contact.self);
  ASSERT_EQ(contact.pairs.size(), 1u);
  EXPECT_EQ(contact.pairs[0].a, "skin");
  EXPECT_EQ(contact.pairs[0].b, "ball");
  EXPECT_EQ(contact.pairs[0].friction, 0.8);
  EXPECT_EQ(contact.pairs[0].origin.text(), "s.yaml:4");
  ASSERT_EQ(contact.obstacles.size(), 7u);
  EXPECT_EQ(contact.obstacles[0].name, "floor");
  EXPECT_EQ(contact.obstacles[0].friction, 0.3);
  EXPECT_EQ(contact.obstacles[0].origin.text(), "s.yaml:6");
  EXPECT_EQ(shape_of<Halfspace>(spec, 0).point, Vec3(0, 0, -60));
  EXPECT_EQ(shape_of<Halfspace>(spec, 0).normal, Vec3(0, 0, 1));
  EXPECT_FALSE(contact.obstacles[1].friction.has_value());
  EXPECT_EQ(shape_of<Sphere>(spec, 1).center, Vec3(10, 20, 30));
  EXPECT_EQ(shape_of<Sphere>(spec, 1).radius, 20);
  EXPECT_EQ(shape_of<Cylinder>(spec, 2).end, Vec3(10, 0, 0));
  EXPECT_EQ(shape_of<Cylinder>(spec, 2).radius, 5);
  EXPECT_EQ(shape_of<Capsule>(spec, 3).start, Vec3(0, 0, 10));
  EXPECT_EQ(shape_of<Capsule>(spec, 3).radius, 2.5);
  EXPECT_EQ(shape_of<Box>(spec, 4).high, Vec3(10, 20, 30));
  EXPECT_EQ(contact.obstacles[4].friction, 0);
  EXPECT_EQ(shape_of<TriangleSurface>(spec, 5).vertices(1, 0), 10);
  EXPECT_EQ(shape_of<TriangleSurface>(spec, 6).vertices(1, 0), 1000);
}

TEST(SceneContact, Refusals) {
  const auto expect = [](const std::string& text, const std::string& message) { EXPECT_EQ(refusal_of(text), message); };
  expect("contact:\n",
         "s.yaml:4: 'contact' must be a map with keys 'distance', 'friction', 'self', 'pairs', not empty");
  expect("contcat: {}\n", "s.yaml:4: unknown key 'contcat' in the scene; did you mean 'contact'?");
  expect("obstacle: []\n", "s.yaml:4: unknown key 'obstacle' in the scene; did you mean 'obstacles'?");
  expect("contact: {distnace: 1}\n", "s.yaml:4: unknown key 'distnace' in 'contact'; did you mean 'distance'?");
  expect("contact: {distance: 0}\n", "s.yaml:4: 'distance' must be greater than 0, not 0");
  expect("contact: {distance: .inf}\n", "s.yaml:4: 'distance' must be a finite number, not '.inf'");
  expect("contact:\n  friction: -0.1\n", "s.yaml:5: 'friction' must be 0 or more, not -0.1");
  expect("contact: {self: yes}\n", "s.yaml:4: 'self' must be one of 'false', 'true', not 'yes'");
  expect("contact: {pairs: [{a: x, b: y}]}\n", "s.yaml:4: entry 1 of 'pairs' needs key 'friction'");
  expect("contact: {pairs: [{a: x, b: y, friction: -1}]}\n", "s.yaml:4: 'friction' must be 0 or more, not -1");
  expect("obstacles: [{sphere: {center: [0, 0, 0], radius: 1}}]\n",
         "s.yaml:4: entry 1 of 'obstacles' needs key 'name'");
  expect("obstacles: [{name: a}]\n",
         "s.yaml:4: entry 1 of 'obstacles' needs one of 'box', 'sphere', 'cylinder', 'capsule', 'halfspace', "
         "'surface'");
  expect("obstacles:\n  - {name: a, box: [[0, 0, 0], [1, 1, 1]]}\n  - {name: a, box: [[0, 0, 0], [1, 1, 1]]}\n",
         "s.yaml:6: the name 'a' is taken; it is given in line 5");
  expect("obstacles: [{name: a, sphere: {center: [0, 0, 0], radius: 0}}]\n",
         "s.yaml:4: 'radius' must be greater than 0, not 0");
  expect("obstacles: [{name: a, box: [[0, 0, 0], [1, -1, 1]]}]\n",
         "s.yaml:4: 'box' has its low corner above its high corner in y");
  expect("obstacles: [{name: a, halfspace: {point: [0, 0, 0], normal: [0, 0, 0]}}]\n",
         "s.yaml:4: 'normal' must not be zero");
  expect("obstacles: [{name: a, capsule: {start: [0, 0, 0], end: [0, 0, 0], radius: 1}}]\n",
         "s.yaml:4: 'capsule' has its start at its end");
  expect("obstacles: [{name: a, surface: cup.obj}]\n", "s.yaml:4: cup.obj:7: no facet");
  expect("obstacles: [{name: a, friction: -1, box: [[0, 0, 0], [1, 1, 1]]}]\n",
         "s.yaml:4: 'friction' must be 0 or more, not -1");
}

}  // namespace
}  // namespace softkin
