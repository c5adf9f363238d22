#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <softkin/io/file.hpp>

#include "scene_fixtures.hpp"

namespace softkin {
namespace {

const std::string finger_of_two =
    "softkin: 1\nunits: {length: cm}\nmesh: {file: parts.msh}\nregions: [{name: low, halfspace: {point: [0, 0, 0], "
    "normal: [0, 0, -1]}}]\nmaterials: [{shape_ratio: 0.5}, {region: body, shape_ratio: 1}]\nvoid: [body]\n"
    "fixed: [{region: base}, {sphere: {center: [0, 0, 0], radius: 0.001}, axes: x}]\nrigid: [low]\n"
    "actuators:\n"
    "  - {name: air, kind: pneumatic, region: all, range: [1, 2]}\n"
    "  - {name: bag, kind: pneumatic, surface: bag.stl, range: [1, 2]}\n"
    "markers: [{name: tip, point: [1, 2, 3]}, {name: end, region: tip}]\n"
    "feet: [{marker: tip, forward: 1, backward: 2}, {marker: end, forward: 3, backward: 4}]\n";

/// Loaders in the place of files, with scenes in robots/.
SceneFiles files_with(std::map<std::string, std::string> scenes) {
  SceneFiles files = fake_files();
  files.scene = [scenes = std::move(scenes)](const std::filesystem::path& path) {
    const auto found = scenes.find(path.string());
    if (found == scenes.end()) throw InvalidInput({path.string()}, "no such file");
    return found->second;
  };
  return files;
}

const std::map<std::string, std::string>& known_scenes() {
  static const std::string head = "softkin: 1\nmesh: {file: finger.msh}\n";
  static const std::map<std::string, std::string> scenes{
      {"robots/finger.yaml", finger_of_two},
      {"robots/plain.yaml", head},
      {"robots/physical.yaml", head + "materials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"},
      {"robots/second.yaml", "softkin: 1\nmesh: {file: finger.msh, order: 2}\n"},
      {"robots/heavy.yaml", head + "gravity: [0, 0, -9.81]\n"},
      {"robots/touching.yaml", head + "\nobstacles: []\n"},
      {"robots/several.yaml", "softkin: 1\nrobots: [{name: a, scene: several.yaml}]\n"},
      {"robots/half.yaml", head + "fixed: [{region: base, axes: x}]\n"},
      {"robots/none.yaml", head + "regions:\n  - {name: far, sphere: {center: [1e3, 0, 0], radius: 1}}\n"},
      {"robots/wrong.yaml", head + "materails: []\n"}};
  return scenes;
}

RobotSpec scene_of_robots(const std::string& text) {
  return parse_scene("softkin: 1\n" + text, "robots/pair.yaml", files_with(known_scenes()));
}

std::string robots_refusal(const std::string& text) {
  try {
    (void)scene_of_robots(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

TEST(SceneRobots, EachIsReadFromItsOwnSceneAndPlaced) {
  const RobotSpec spec = scene_of_robots(
      "units: {length: m}\nrobots:\n"
      "  - {name: left, scene: finger.yaml, place: {translate: [0, -0.02, 0]}}\n"
      "  - name: right\n"
      "    scene: finger.yaml\n"
      "    place: {rotate: {axis: [2, 0, 0], degrees: 180}, translate: [0, 0.02, 0]}\n");
  EXPECT_EQ(spec.name, "robots/pair.yaml");
  EXPECT_EQ(spec.formulation, Formulation::target_shape);
  ASSERT_EQ(spec.mesh.vertices.rows(), 10);
  EXPECT_LT((spec.mesh.vertices.row(4) - Eigen::RowVector3d(10, -10, 10)).norm(), 1e-12);  // of 10 mm
  EXPECT_LT((spec.mesh.vertices.row(9) - Eigen::RowVector3d(10, 10, -10)).norm(), 1e-12);
  EXPECT_EQ(spec.mesh.tetrahedra.at(2), (Tetrahedron{5, 6, 7, 8}));
  EXPECT_EQ(spec.mesh.triangles.at(1), (Triangle{5, 6, 7}));
  EXPECT_EQ(spec.mesh.regions.at(5).name, "right.tip");
  EXPECT_EQ(spec.mesh.regions.at(5).vertices, std::vector<Index>{9});
  ASSERT_EQ(spec.materials.size(), 4u);
  EXPECT_EQ(spec.materials[2].region, "right");
  EXPECT_EQ(spec.materials[3].region, "right.body");
  EXPECT_EQ(std::get<std::string>(spec.voids.at(1).region), "right.body");
  EXPECT_EQ(std::get<std::string>(spec.rigid.at(0).where.region), "left.low");
  EXPECT_EQ(spec.rigid.at(1).name, "right.low");
  EXPECT_EQ(spec.actuators.at(2).name, "right.air");
  EXPECT_EQ(spec.actuators.at(2).as<PneumaticSpec>()->region, "right");
  EXPECT_EQ(spec.actuators.at(2).origin.text(), "robots/finger.yaml:10");
  EXPECT_LT((spec.actuators.at(3).as<PneumaticSpec>()->surface->vertices.row(2) - Eigen::RowVector3d(0, 15, 0)).norm(),
            1e-12);
  EXPECT_EQ(spec.markers.at(2).name, "right.tip");
  EXPECT_LT((std::get<Vec3>(spec.markers.at(2).at.point) - Vec3(10, 0, -30)).norm(), 1e-12);
  EXPECT_EQ(std::get<std::string>(spec.markers.at(1).at.point), "left.tip");
  EXPECT_EQ(spec.feet.at(3).marker, "right.end");
  const auto& ball = std::get<Chosen>(std::get<Selector>(spec.fixed.at(3).where.region));
  EXPECT_EQ(ball.kind, "sphere of robot 'right'");
  EXPECT_EQ(ball.region.vertices, std::vector<Index>{5});
}

TEST(SceneRobots, WhatIsSaidOfTheWhole) {
  const RobotSpec spec = scene_of_robots(
      "robots: [{name: a, scene: plain.yaml}, {name: b, scene: plain.yaml}]\n"
      "formulation: physical\ngravity: [0, 0, -5]\n"
      "regions: [{name: last, vertices: [9]}]\nmaterials: [{region: a, youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: last}]\nrigid: [{region: b}, {box: [[0, 0, 0], [1, 1, 1]]}]\n"
      "actuators: [{name: string, kind: cable, points: [[0, 0, 0], {region: last}], control: tension, range: [0, 1]}]\n"
      "forces: [{name: push, region: last, force: [1, 0, 0]}]\nmarkers: [{name: tip, region: last}]\n"
      "contact: {friction: 0.4, pairs: [{a: a, b: b, friction: 1}]}\n");
  EXPECT_EQ(spec.formulation, Formulation::physical);
  EXPECT_EQ(spec.loads.gravity, Vec3(0, 0, -5));
  EXPECT_EQ(std::get<VertexList>(spec.regions.at(2).selector).vertices, std::vector<Index>{9});
  EXPECT_EQ(spec.fixed.at(0).name, "last");
  EXPECT_EQ(spec.rigid.at(1).name, "rigid_2");
  EXPECT_EQ(spec.actuators.at(0).control, Control::load);
  EXPECT_EQ(spec.loads.forces.at(0).name, "push");
  EXPECT_EQ(spec.markers.at(0).name, "tip");
  EXPECT_EQ(spec.contact->friction, 0.4);
}

TEST(SceneRobots, TheFormulationIsTheirs) {
  EXPECT_EQ(scene_of_robots("robots: [{name: a, scene: physical.yaml}]\n").formulation, Formulation::physical);
  EXPECT_EQ(scene_of_robots("robots: [{name: a, scene: physical.yaml}]\nformulation: target-shape\n").formulation,
            Formulation::target_shape);
  EXPECT_EQ(scene_of_robots("robots: [{name: a, scene: heavy.yaml}]\n").loads.gravity, Vec3(0, 0, -9.81));
}

TEST(SceneRobots, Refusals) {
  const std::string place = "robots/pair.yaml:", one = "robots: [{name: a, scene: plain.yaml}]\n";
  const std::pair<std::string, std::string> cases[] = {
      {"robots: []\n", "2: 'robots' is empty"},
      {"robots: 1\n", "2: 'robots' must be a list, not '1'"},
      {one + "mesh: {file: a.msh}\n", "3: the scene has both 'robots' and 'mesh'; give only one of them"},
      {one + "meshes: []\n", "3: the scene has both 'robots' and 'meshes'; give only one of them"},
      {"robots: [{scene: plain.yaml}]\n", "2: entry 1 of 'robots' needs key 'name'"},
      {"robots: [{name: a}]\n", "2: entry 1 of 'robots' needs key 'scene'"},
      {"robots: [{name: a.b, scene: plain.yaml}]\n",
       "2: the name 'a.b' must not hold a '.', which parts a robot's name from those of its parts"},
      {"robots: [{name: 'a,b', scene: plain.yaml}]\n",
       "2: the name 'a,b' must not hold , = \" # or begin or end with a blank"},
      {"robots: [{name: all, scene: plain.yaml}]\n", "2: the name 'all' is reserved: it stands for all of the robots"},
      {"robots: [{name: robot, scene: plain.yaml}]\n",
       "2: the name 'robot' is reserved: it stands for all of the robots"},
      {"robots:\n  - {name: a, scene: plain.yaml}\n  - {name: a, scene: plain.yaml}\n",
       "4: the name 'a' is taken; it is given in line 3"},
      {"robots: [{name: a, scene: plain.yaml, place: {move: [0, 0, 1]}}]\n",
       "2: unknown key 'move' in 'place'; known: rotate, quaternion, translate"},
      {"robots: [{name: a, scene: plain.yaml, place: {quaternion: [1, 0, 0]}}]\n",
       "2: 'quaternion' must be a list of 4, not of 3"},
      {"robots: [{name: a, scene: plain.yaml, place: {quaternion: [90, 0, 0, 1]}}]\n",
       "2: 'quaternion' must be a unit quaternion [w, x, y, z], but its norm is 90.01: divide its numbers by that, or "
       "give 'axis' and 'degrees'"},
      {"robots: [{name: a, scene: plain.yaml, place: {quaternion: [0, 0, 0, 0]}}]\n",
       "2: 'quaternion' must be a unit quaternion [w, x, y, z], but its norm is 0: divide its numbers by that, or give "
       "'axis' and 'degrees'"},
      {"robots: [{name: a, scene: plain.yaml, place: {quaternion: [1, 0, 0, 0], rotate: {axis: [0, 0, 1], degrees: "
       "9}}}]\n",
       "2: 'place' has both 'quaternion' and 'rotate'; give only one of them"},
      {"robots: [{name: a, scene: plain.yaml, place: {rotate: []}}]\n",
       "2: 'rotate' is an empty list: give at least one rotation, or leave it out"},
      {"robots: [{name: a, scene: plain.yaml, place: {rotate: [{axis: [0, 0, 1], degrees: 9, quaternion: [1, 0, 0, "
       "0]}]}}]\n",
       "2: 'axis' and 'quaternion' exclude each other: give one of the two"},
      {"robots: [{name: a, scene: plain.yaml, place: {rotate: {axis: [0, 0, 0], degrees: 9}}}]\n",
       "2: 'axis' has no direction"},
      {"robots: [{name: a, scene: plain.yaml, place: {rotate: {axis: [0, 0, 1]}}}]\n",
       "2: 'rotate' needs key 'degrees'"},
      {"robots: [{name: a, scene: plain.yaml, place: {translate: [0, 0, 1e308]}}]\nunits: {length: m}\n",
       "2: entry 3 of 'translate' is too large: 1e308"},
      {"robots: [{name: a, scene: absent.yaml}]\n", "2: robot 'a': robots/absent.yaml: no such file"},
      {"robots: [{name: a, scene: wrong.yaml}]\n",
       "2: robot 'a': robots/wrong.yaml:3: unknown key 'materails' in the scene; did you mean 'materials'?"},
      {"robots: [{name: a, scene: several.yaml}]\n",
       "2: robot 'a': robots/several.yaml:2: a robot among several cannot be several robots itself: name the scenes "
       "of these"},
      {"robots: [{name: a, scene: none.yaml}]\n",
       "2: robot 'a': robots/none.yaml:4: region 'far' holds no vertex and no element"},
      {"robots: [{name: a, scene: touching.yaml}]\n",
       "2: robot 'a': robots/touching.yaml:4: a robot among several has no 'contact', 'obstacles' or 'bodies' of its "
       "own: "
       "give them in robots/pair.yaml, which joins the robots"},
      {"robots: [{name: a, scene: half.yaml, place: {rotate: {axis: [0, 0, 1], degrees: 30}}}]\n",
       "2: robot 'a': robots/half.yaml:3: region 'base' is fixed along some axes, which the turn of the robot takes to "
       "none of the scene's: fix it along x, y and z, or turn the robot by quarter turns about its axes"},
      {"robots:\n  - {name: a, scene: plain.yaml}\n  - {name: b, scene: second.yaml}\n",
       "4: robot 'b' (robots/second.yaml) is of order 2, robot 'a' (robots/plain.yaml) of order 1: give both one "
       "order, "
       "such as 'order: 2' of 'mesh'"},
      {"robots:\n  - {name: a, scene: plain.yaml}\n  - {name: b, scene: physical.yaml}\n",
       "4: robot 'b' (robots/physical.yaml) is of the formulation 'physical', robot 'a' (robots/plain.yaml) of "
       "'target-shape': give 'formulation' in this scene"},
      {"robots:\n  - {name: a, scene: plain.yaml}\n  - {name: b, scene: heavy.yaml}\n",
       "4: robot 'b': as it stands, its gravity is (0, 0, -9.81) m/s^2 (robots/heavy.yaml:3), but that of robot 'a' is "
       "(0, 0, 0) m/s^2: leave 'gravity' out of the robots' scenes and give it in this one"},
      {"robots: [{name: b, scene: heavy.yaml}]\ngravity: [0, 0, -1]\n",
       "2: robot 'b': as it stands, its gravity is (0, 0, -9.81) m/s^2 (robots/heavy.yaml:3), but that of the whole is "
       "(0, 0, -1) m/s^2 (robots/pair.yaml:3): leave 'gravity' out of the robots' scenes and give it in this one"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(robots_refusal(text), place + message) << text;
}

/// Of the last vertex, (10, 0, 0) mm turned and moved, by the formulas of rotations about an axis.
TEST(SceneRobots, RotationsOneAfterTheOtherAndQuaternions) {
  const auto placed = [](const std::string& place) -> Points {
    return scene_of_robots("robots: [{name: a, scene: plain.yaml, place: " + place + "}]\n").mesh.vertices;
  };
  const Points rest = placed("{}");
  const double half = std::sqrt(0.5);
  const auto turned = [&rest](const auto& formula) {
    Points expected(rest.rows(), 3);
    for (Index v = 0; v < rest.rows(); ++v) expected.row(v) = formula(Vec3(rest.row(v).transpose())).transpose();
    return expected;
  };
  const auto about_z_then_x = [](const Vec3& p) { return Vec3(-p.y(), -p.z(), p.x()); };  // a quarter turn each
  const auto expect_same = [](const Points& found, const Points& expected) {
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-12) << found;
  };
  expect_same(placed("{rotate: [{axis: [0, 0, 1], degrees: 90}, {axis: [1, 0, 0], degrees: 90}]}"),
              turned(about_z_then_x));
  expect_same(placed("{rotate: [{axis: [1, 0, 0], degrees: 90}, {axis: [0, 0, 1], degrees: 90}]}"),
              turned([](const Vec3& p) { return Vec3(p.z(), p.x(), p.y()); }));
  expect_same(placed("{quaternion: [0.7071, 0, 0, 0.7071]}"),
              turned([](const Vec3& p) { return Vec3(-p.y(), p.x(), p.z()); }));
  expect_same(placed("{rotate: {quaternion: [0.5, 0.5, 0.5, 0.5]}}"),
              turned([](const Vec3& p) { return Vec3(p.z(), p.x(), p.y()); }));
  expect_same(placed("{rotate: [{quaternion: [0.70710678, 0, 0, 0.70710678]}, {axis: [1, 0, 0], degrees: 90}], "
                     "translate: [1, 2, 3]}"),
              turned([&](const Vec3& p) { return Vec3(about_z_then_x(p) + Vec3(1, 2, 3)); }));
  expect_same(placed("{rotate: {axis: [0, 0, 1], degrees: 45}}"),
              turned([half](const Vec3& p) { return Vec3(half * (p.x() - p.y()), half * (p.x() + p.y()), p.z()); }));
  expect_same(placed("{rotate: {axis: [0, 0, 1], degrees: 180, about: [5, 0, 0]}}"),
              turned([](const Vec3& p) { return Vec3(10 - p.x(), -p.y(), p.z()); }));
}

/// A command's outputs must not replace any of them.
TEST(SceneRobots, TheirScenesAndFilesAreInputs) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / "softkin_scene_robots";
  fs::create_directories(folder / "fingers");
  std::ofstream(folder / "fingers/a.tet") << "4 vertices\n1 tets\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 0 1 2 3\n";
  std::ofstream(folder / "fingers/finger.yaml") << "softkin: 1\nmesh: {file: a.tet}\n";
  std::ofstream(folder / "pair.yaml") << "softkin: 1\nrobots: [{name: a, scene: fingers/finger.yaml}]\n";
  std::vector<fs::path> inputs;
  const RobotSpec spec = read_requested_scene({(folder / "pair.yaml").string(), "", {}}, inputs);
  EXPECT_EQ(spec.mesh.tetrahedra.size(), 1u);
  EXPECT_EQ(inputs, (std::vector<fs::path>{folder / "fingers/finger.yaml", folder / "fingers/a.tet"}));
  EXPECT_EQ(read_scene(folder / "pair.yaml").mesh.vertices.rows(), 4);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace softkin
