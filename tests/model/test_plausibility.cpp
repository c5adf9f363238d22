#include <gtest/gtest.h>

#include <functional>
#include <softkin/model/model.hpp>

#include "model/physical_robots.hpp"

/// Numbers in another unit than softkin's are not refused, but doubted in words that name the unit.

namespace softkin {
namespace {

using namespace testing;

/// A bar of 60 x 10 x 10 mm of silicone.
RobotSpec silicone_bar() {
  RobotSpec spec = physical_robot(block_mesh({18, 3, 3}, {60, 10, 10}));
  spec.mesh_options.quadratic = true;
  spec.materials[0].density = 1080;
  spec.loads.gravity = {0, 0, -9.81};
  return spec;
}

/// The only warning of a robot, or how many there are.
std::string warning_of(const RobotSpec& spec) {
  const std::vector<std::string> warnings = compile(spec).warnings;
  return warnings.size() == 1 ? warnings[0] : std::to_string(warnings.size()) + " warnings";
}

struct Doubt {
  double given;
  std::string words;  // "": none
};

void expect_doubts(const std::vector<Doubt>& doubts, const std::function<void(RobotSpec&, double)>& set) {
  for (const Doubt& doubt : doubts) {
    SCOPED_TRACE(doubt.given);
    RobotSpec spec = silicone_bar();
    set(spec, doubt.given);
    const std::string warning = warning_of(spec);
    if (doubt.words.empty())
      EXPECT_EQ(warning, "0 warnings");
    else
      EXPECT_NE(warning.find(doubt.words), std::string::npos) << warning;
  }
}

TEST(Plausibility, OfSizes) {
  expect_doubts({{1, ""},
                 {0.02, ""},  // a millimetre
                 {100, ""},   // six metres
                 {1e-3,
                  "The robot is 0.0616441 mm across, where robots measure 1 mm to 10 m; a thousand times that (m "
                  "taken for mm) would be 61.64 mm: is it that? The scene's 'units: {length: U}'"},
                 {1e3,
                  "The robot is 61644.1 mm across, where robots measure 1 mm to 10 m; a thousandth of that (mm taken "
                  "for m, or um for mm) "
                  "would be 61.64 mm: is it that?"},
                 {1e-9, "where robots measure 1 mm to 10 m. The scene's"}},
                [](RobotSpec& spec, double factor) { spec.mesh.vertices *= factor; });
}

TEST(Plausibility, OfModuli) {
  expect_doubts({{0.01, ""},
                 {1, ""},
                 {3500, ""},
                 {600000,
                  "has a Young's modulus of 600000 MPa at small strain, where soft robots' have 0.01 to 10000 "
                  "MPa; taken as Pa it would be 0.6 MPa: is it that? Elastic constants are in MPa."},
                 {30000, "taken as Pa it would be 0.03 MPa"},
                 {0.0006, "taken as GPa it would be 0.6 MPa"},
                 {1e-9, "MPa. Elastic constants"}},
                [](RobotSpec& spec, double e) { spec.materials[0].elastic->youngs_modulus = e; });
}

/// E = 9 K G / (3 K + G) with G = 2 (c10 + c01).
TEST(Plausibility, OfTheCoefficientsOfRubber) {
  expect_doubts({{0.1, ""}, {1e5, "has a Young's modulus of 594059 MPa"}}, [](RobotSpec& spec, double c10) {
    ElasticSpec elastic;
    elastic.law = Law::mooney_rivlin;
    elastic.c10 = c10;
    elastic.c01 = 0;
    elastic.bulk_modulus = 200 * c10 / 3;
    spec.materials[0].elastic = elastic;
  });
}

/// A stiff insert of a soft robot is none to doubt; a robot of nothing else is.
TEST(Plausibility, OfStiffInserts) {
  RobotSpec spec = silicone_bar();
  add_volume_region(spec.mesh, "plate", [](const Vec3& p) { return p.x() > 50; });
  MaterialSpec steel = spec.materials[0];
  steel.region = "plate";
  steel.elastic->youngs_modulus = 210000;
  steel.density = 7850;
  spec.materials.push_back(steel);
  EXPECT_EQ(warning_of(spec), "0 warnings");
  spec.materials[0].elastic->youngs_modulus = 210000;
  EXPECT_EQ(warning_of(spec), "2 warnings");
}

TEST(Plausibility, OfGravity) {
  expect_doubts({{0, ""},
                 {1.62, ""},
                 {98.1, ""},
                 {9810,
                  "Gravity is 9810 m/s^2, where the Earth's is 9.81 m/s^2; taken as mm/s^2 it would be 9.81 "
                  "m/s^2: is it that? The scene's 'gravity' is in m/s^2."},
                 {0.00981, "taken as mm/ms^2 it would be 9.81 m/s^2"}},
                [](RobotSpec& spec, double g) {
                  spec.loads.gravity = {0, 0, -g};
                });
}

TEST(Plausibility, OfDensities) {
  expect_doubts({{30, ""},
                 {7850, ""},
                 {1.08,
                  "The density of region 'all' is 1.08 kg/m^3, where silicones and plastics have about 1000 "
                  "kg/m^3; taken as g/cm^3 it would be 1080 kg/m^3: is it that? 'density' is in kg/m^3."},
                 {1.08e-6, "taken as kg/mm^3 it would be 1080 kg/m^3"},
                 {1.08e-9, "taken as t/mm^3 it would be 1080 kg/m^3"},
                 {1.08e6, "taken as g/m^3 it would be 1080 kg/m^3"}},
                [](RobotSpec& spec, double density) { spec.materials[0].density = density; });
}

/// What nothing depends on is not doubted.
TEST(Plausibility, OfWhatCountsAlone) {
  RobotSpec spec = silicone_bar();
  spec.materials[0].density = 1.08;
  spec.loads.gravity = Vec3::Zero();
  EXPECT_EQ(warning_of(spec), "0 warnings");
  spec.loads.gravity = {0, 0, -9810};
  spec.formulation = Formulation::target_shape;
  spec.materials[0].shape_ratio = 1;
  EXPECT_EQ(warning_of(spec), "0 warnings");
}

}  // namespace
}  // namespace softkin
