#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <softkin/model/mesh/refine_surface.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

using namespace softkin;
using namespace softkin::testing;

namespace {

ActuatorSpec bag_of(const std::optional<TriangleSurface>& surface, const std::string& name = "air") {
  ActuatorSpec bag = chamber("");
  bag.name = name;
  bag.as<PneumaticSpec>()->region.reset();
  bag.as<PneumaticSpec>()->surface = surface;
  return bag;
}

/// A cube of 30 mm around the empty cube (10, 10, 10) to (20, 20, 20).
RobotSpec hollow_robot(const std::optional<TriangleSurface>& surface, bool quadratic = false) {
  RobotSpec spec = physical_robot(hollow_mesh());
  spec.mesh_options.quadratic = quadratic;
  spec.voids = {named("chamber")};
  spec.actuators = {bag_of(surface)};
  return spec;
}

TriangleSurface cut(const TriangleSurface& surface, double edge) {
  return refined(
      surface, [=](const Vec3&) { return edge; }, 100000);
}

TriangleSurface both(const TriangleSurface& a, const TriangleSurface& b) {
  TriangleSurface all{Points(a.vertices.rows() + b.vertices.rows(), 3), a.triangles};
  all.vertices << a.vertices, b.vertices;
  const Index first = a.vertices.rows();
  for (const auto& [i, j, k] : b.triangles) all.triangles.push_back({first + i, first + j, first + k});
  return all;
}

using Face = std::array<Index, 6>;

/// The faces, each from its smallest corner on.
std::set<Face> faces_of(const Actuator& actuator) {
  std::set<Face> faces;
  for (const auto& [corners, edges] : actuator.as<ChamberDrive>()->cavity) {
    const auto first = std::min_element(corners.begin(), corners.end()) - corners.begin();
    Face face;
    for (std::size_t i = 0; i < 3; ++i) {
      face[i] = corners[(first + i) % 3];
      face[3 + i] = edges[(first + i) % 3];
    }
    faces.insert(face);
  }
  return faces;
}

/// The region's chamber and the space that a surface selects have the same faces with the same orientation, whatever
/// the surface's facets.
TEST(Cavity, ASurfaceSelectsTheFacesOfItsSpace) {
  for (const bool quadratic : {false, true}) {
    RobotSpec region = hollow_robot({}, quadratic);
    region.voids.clear();
    region.actuators = {chamber("chamber")};
    const Model expected = compile(region);
    const TriangleSurface box = box_surface({10, 10, 10}, {10, 10, 10}),
                          loose = box_surface({9.8, 10.1, 10}, {10, 10.2, 10});
    for (const TriangleSurface& surface : {box, cut(box, 6), cut(box, 1.5), loose}) {
      const Model model = compile(hollow_robot(surface, quadratic));
      const Actuator& air = model.actuators[0];
      EXPECT_EQ(faces_of(air), faces_of(expected.actuators[0]));
      EXPECT_NEAR(air.rest_measure, 1000, 1e-9);
      EXPECT_TRUE(air.as<ChamberDrive>()->points.empty() && air.as<ChamberDrive>()->surface.empty());
      EXPECT_TRUE(has_note(model,
                           "The surface of actuator 'air' bounds the empty space of 1000 mm^3 (12 faces) around "
                           "(15, 15, 15) mm, whose own faces take the pressure; it lies up to "));
    }
    EXPECT_TRUE(has_note(compile(hollow_robot(loose, quadratic)), "it lies up to 0.361 mm from them"));
  }
}

/// The point may lie anywhere in the space, of one body or of one among several robots.
TEST(Cavity, APointSelectsTheSpaceInWhichItLies) {
  RobotSpec two = physical_robot(block_mesh({5, 3, 3}, {50, 30, 30}));
  two.voids = {shaped(Box{{10, 10, 10}, {20, 20, 20}}), shaped(Box{{30, 10, 10}, {40, 20, 20}})};
  for (const double x : {10.5, 15.0, 30.5, 39.5}) {
    two.actuators = {bag_of({})};
    two.actuators[0].as<PneumaticSpec>()->void_at = Vec3(x, 12, 19);
    RobotSpec surface = two;
    surface.actuators = {bag_of(box_surface({x < 25 ? 10.0 : 30.0, 10, 10}, {10, 10, 10}))};
    const Model model = compile(two);
    EXPECT_EQ(faces_of(model.actuators[0]), faces_of(compile(surface).actuators[0])) << x;
    EXPECT_NEAR(model.actuators[0].rest_measure, 1000, 1e-9);
    EXPECT_TRUE(has_note(model, "Actuator 'air' is the empty space of 1000 mm^3 (12 faces) around "));
  }
  for (const Vec3& outside : {Vec3(25, 15, 15), Vec3(-100, 0, 0), Vec3(5, 5, 5)}) {
    two.actuators[0].as<PneumaticSpec>()->void_at = outside;
    EXPECT_NE(refusal(two).find("lies in no empty space of the body: of 2 empty spaces the nearest, 1000 mm^3"),
              std::string::npos)
        << refusal(two);
  }
  two.voids.clear();
  EXPECT_NE(refusal(two).find("the body encloses no empty space"), std::string::npos);
}

/// A surface of like volume that lies 2 mm off is cut by the elements, and the reason is reported with both distances.
TEST(Cavity, ASurfaceFarFromItsSpaceIsCutAndTheReasonIsReported) {
  const TriangleSurface off = cut(box_surface({9, 9, 9}, {10.4, 10.4, 10.4}), 2);
  const Model model = compile(hollow_robot(off));
  EXPECT_FALSE(model.actuators[0].as<ChamberDrive>()->surface.empty());
  EXPECT_TRUE(has_note(model,
                       "The surface of actuator 'air' lies up to 1.73 mm from the faces of the empty space of "
                       "1000 mm^3 (12 faces) around (15, 15, 15) mm, more than the 1.5 mm"));
  EXPECT_TRUE(has_note(model, "take 'void_at' with a point of that space"));
}

TEST(Cavity, TheOnlySpaceIsFound) {
  const Model model = compile(hollow_robot({}));
  EXPECT_EQ(model.actuators[0].as<ChamberDrive>()->cavity.size(), 12u);
  EXPECT_TRUE(has_note(model, "Actuator 'air' is the only empty space in the body, 1000 mm^3 (12 faces) around (15, "));
  const std::string needs = "robot.yaml:9: actuator 'air' needs a region or a surface, since the body encloses ";
  RobotSpec none = hollow_robot({});
  none.voids.clear();
  EXPECT_NE(refusal(none).find(needs + "no empty space"), std::string::npos) << refusal(none);
  RobotSpec two = physical_robot(block_mesh({5, 3, 3}, {50, 30, 30}));
  two.voids = {shaped(Box{{10, 10, 10}, {20, 20, 20}}), shaped(Box{{30, 10, 10}, {40, 20, 20}})};
  two.actuators = {bag_of({})};
  EXPECT_NE(refusal(two).find(needs + "2 empty spaces, 1000 mm^3 (12 faces) around (15, 15, 15) mm, 1000 mm^3 (12 "
                                      "faces) around (35, 15, 15) mm: name"),
            std::string::npos)
      << refusal(two);
  // a surface may have both, and then neither is left
  two.actuators = {bag_of(both(box_surface({10, 10, 10}, {10, 10, 10}), box_surface({30, 10, 10}, {10, 10, 10})))};
  EXPECT_EQ(compile(two).actuators[0].as<ChamberDrive>()->cavity.size(), 24u);
  two.actuators.push_back(bag_of(box_surface({30, 10, 10}, {10, 10, 10}), "bag"));
  EXPECT_NE(refusal(two).find("actuator 'bag' and actuator 'air' both take the empty space of 1000 mm^3"),
            std::string::npos)
      << refusal(two);
}

/// The wall of the hollow cube as a group of faces, turned at random.
RobotSpec walled(bool quadratic) {
  RobotSpec spec = hollow_robot({}, quadratic);
  std::vector<Tetrahedron> elements;
  for (const Index i : spec.mesh.regions.back().tetrahedra) elements.push_back(spec.mesh.tetrahedra[i]);
  Region wall;
  wall.name = "wall";
  wall.dimension = 2;
  for (Triangle t : boundary_of(elements, {}).triangles) {
    if (wall.triangles.size() % 3 == 0) std::swap(t[0], t[1]);
    wall.triangles.push_back(spec.mesh.triangles.size());
    spec.mesh.triangles.push_back(t);
  }
  spec.mesh.regions.push_back(wall);
  spec.actuators[0].as<PneumaticSpec>()->wall = "wall";
  return spec;
}

TEST(Cavity, AGroupOfFacesIsItsWall) {
  for (const bool quadratic : {false, true})
    EXPECT_EQ(faces_of(compile(walled(quadratic)).actuators[0]),
              faces_of(compile(hollow_robot({}, quadratic)).actuators[0]));
  RobotSpec target = walled(false);
  target.formulation = Formulation::target_shape;
  target.materials[0].shape_ratio = 1;
  target.voids.clear();
  EXPECT_EQ(compile(target).actuators[0].as<ChamberDrive>()->tetrahedra.size(), 6u);
  expect_refused(walled(false),
                 {{"open", [](RobotSpec& s) { s.mesh.regions.back().triangles.pop_back(); },
                   "actuator 'air' has a wall, region 'wall', that bounds no chamber: the surface is not "
                   "closed: its rim of 3 edges has its middle at ("},
                  {"volume", [](RobotSpec& s) { s.actuators[0].as<PneumaticSpec>()->wall = "chamber"; },
                   "that is no group of faces; a volume is named with `region: chamber`"},
                  {"solid", [](RobotSpec& s) { s.voids.clear(); }, "of which 100 % are elements of the body"},
                  {"as a volume",
                   [](RobotSpec& s) {
                     s.actuators[0].as<PneumaticSpec>()->wall.reset();
                     s.actuators[0].as<PneumaticSpec>()->region = "wall";
                   },
                   "the wall of a cavity is `surface: {region: wall}`"}});
}

/// A space that is not closed has the surface itself, cut so finely that it follows the elements.
TEST(Cavity, ASurfaceThatSelectsNothingIsEmbedded) {
  RobotSpec spec = hollow_robot(box_surface({10, 10, 10}, {10, 10, 10}));
  spec.voids.push_back(shaped(Box{{20, 10, 10}, {30, 20, 20}}));  // a duct to the outside
  for (Triangle& t : spec.actuators[0].as<PneumaticSpec>()->surface->triangles) std::swap(t[0], t[1]);
  const Model model = compile(spec);
  const auto& air = *model.actuators[0].as<ChamberDrive>();
  EXPECT_TRUE(air.cavity.empty());
  EXPECT_NEAR(model.actuators[0].rest_measure, 1000, 1e-9);
  EXPECT_EQ(air.surface.size(), 12u * 128);
  for (const auto& [a, b, c] : air.surface)
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      EXPECT_LT((air.points[p].at(model.rest) - air.points[q].at(model.rest)).norm(), 0.101 * std::sqrt(300.0));
}

TEST(Cavity, MisleadingSurfacesAreRefused) {
  const TriangleSurface box = box_surface({10, 10, 10}, {10, 10, 10}), skin = box_surface({0, 0, 0}, {30, 30, 30});
  const auto take = [](const TriangleSurface& surface) {
    return [=](RobotSpec& spec) { spec.actuators[0].as<PneumaticSpec>()->surface = surface; };
  };
  TriangleSurface small = box, large = box;
  small.vertices *= 1e-3;
  large.vertices *= 25.4;
  expect_refused(
      hollow_robot(box),
      {{"skin and cavity", take(both(skin, box)),
        "robot.yaml:9: actuator 'air' has a surface of 2 shells, of which one of 1000 mm^3 around (15, 15, 15) mm lies "
        "inside one of 27000 mm^3 around (15, 15, 15) mm: leave out all but the wall"},
       {"skin", take(skin), "has a surface around 27000 mm^3, of which 96.3 % are elements of the body"},
       {"solid", [](RobotSpec& s) { s.voids.clear(); }, "of which 100 % are elements of the body"},
       {"twice", take(both(box, box)), "has two shells around the same empty space, 1000 mm^3 (12 faces) around"},
       {"small", take(small),
        "has a surface of 0.0173205 mm from corner to corner, 0.000333 times the body's 51.9615 mm: it is of another "
        "unit; name that of its file, `surface: {file: F, unit: mm}`"},
       {"large", take(large), "times the body's 51.9615 mm: it is of another unit"},
       {"within", take(box_surface({11, 11, 11}, {8, 8, 8})),
        "has a surface of 512 mm^3 around (15, 15, 15) mm inside an empty space of the body of 1000 mm^3"},
       {"beside", take(box_surface({31, 10, 10}, {30, 10, 10})), "mm from the body, farther than the 5.19615 mm to"}});
}

TEST(Points, FartherOutThanTheirElementCanCarryThemAreRefused) {
  RobotSpec spec = physical_robot(block_mesh({15, 5, 5}, {45, 15, 15}));
  spec.actuators = {cable({at(0, 7, 14), at(30, 7, 17), at(45, 7, 14)})};
  spec.markers = {{"tip", at(45, 7, 7)}};
  EXPECT_TRUE(has_note(compile(spec), "points[1] of actuator 'tendon' is 2 mm outside the body"));
  expect_refused(spec,
                 {{"cable", [](RobotSpec& s) { s.actuators[0].as<CableSpec>()->points[1] = at(30, 7, 18); },
                   "robot.yaml:5: points[1] of actuator 'tendon' is 3 mm from the mesh, farther than the 2.59808 "
                   "mm to which its nearest element can carry it: move it to the body"},
                  {"marker", [](RobotSpec& s) { s.markers[0].at = at(45, 7, 18); }, "marker 'tip' is 3 mm from"}});
}

}  // namespace
