#include <Eigen/Geometry>
#include <numbers>
#include <softkin/model/growth.hpp>
#include <softkin/model/joined.hpp>
#include <softkin/model/names.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

/// What grows, along which directions and by how much.

namespace softkin {

namespace {

using namespace testing;

ActuatorSpec growing(std::vector<GrowthPart> parts) {
  return actuator("growth", GrowthSpec{std::move(parts)}, 0.8, 1.5);
}

ActuatorSpec heated(std::vector<GrowthPart> parts) {
  for (GrowthPart& part : parts)
    if (!part.temperature) part.temperature = TemperatureSpec{20, 1e-3, {}};
  ActuatorSpec spec = growing(std::move(parts));
  spec.control = Control::load;
  spec.rest = 20;
  spec.low = 0;
  spec.high = 80;
  return spec;
}

RobotSpec growing_block(Split split = Split::six) {
  RobotSpec spec = physical_robot(block_mesh({4, 2, 2}, {20, 8, 6}, split));
  spec.regions = {{"left", Selector(Box{{-1, -1, -1}, {10, 9, 7}}), line(3)},
                  {"right", Selector(Box{{10, -1, -1}, {21, 9, 7}}), line(4)}};
  return spec;
}

GrowthPart along(const std::string& region, const DirectionSpec& direction) {
  return {region, direction};
}

/// With other parts.
auto replaced(std::vector<GrowthPart> parts) {
  return [parts](RobotSpec& spec) { spec.actuators[0].drive = GrowthSpec{parts}; };
}

}  // namespace

TEST(CompileGrowth, TakesTheElementsOfItsRegions) {
  for (const Split split : {Split::six, Split::prisms}) {
    RobotSpec spec = growing_block(split);
    spec.actuators = {growing({{"left"}, along("right", {.uniform = {0, 0, 5}})})};
    const Model model = compile(spec);
    ASSERT_EQ(model.growths.size(), 2u);
    EXPECT_EQ(model.actuators[0].as<GrowthDrive>()->growth, 0);
    for (const auto& growth : model.growths) {
      EXPECT_EQ(growth->actuator, 0);
      EXPECT_EQ(2 * growth->tetrahedra.size(), model.elements.tetrahedra.size());
      EXPECT_EQ(2 * growth->prisms.size(), model.elements.prisms.size());
    }
    EXPECT_TRUE(model.growths[0]->directions.empty());
    ASSERT_EQ(2 * model.growths[1]->directions.size(), model.elements.tetrahedra.size() + model.elements.prisms.size());
    for (const Vec3& direction : model.growths[1]->directions) EXPECT_EQ(direction, Vec3(0, 0, 1));
    EXPECT_EQ(command_unit(model.actuators[0]), "");
    EXPECT_EQ(std::string(control_name(model.actuators[0])), "stretch");
    EXPECT_TRUE(drives(model.actuators[0]));
  }
}

/// A chamber in its region is no part of the body and does not grow.
TEST(CompileGrowth, LeavesOutChambers) {
  RobotSpec spec = physical_robot(hollow_mesh());
  ActuatorSpec air = actuator("air", PneumaticSpec{.region = "chamber"}, 0.5, 2);
  spec.actuators = {air, growing({{"all"}})};
  const Model model = compile(spec);
  EXPECT_EQ(model.growths.at(0)->tetrahedra.size(), model.elements.tetrahedra.size());
  EXPECT_EQ(model.growths[0]->actuator, 1);
}

TEST(CompileGrowth, DirectionsAboutALine) {
  RobotSpec spec = growing_block();
  const Vec3 center(3, 30, -2), axis(1, 2, 2);
  DirectionSpec radial{DirectionSpec::Kind::radial, {}, center, axis}, around = radial;
  around.kind = DirectionSpec::Kind::circumferential;
  around.degrees = 30;
  spec.actuators = {growing({along("left", radial), along("right", around)})};
  const Model model = compile(spec);
  for (const auto& growth : model.growths)
    for (std::size_t i = 0; i < growth->tetrahedra.size(); ++i) {
      Vec3 at = -center;
      for (const Index v : model.elements.tetrahedra[growth->tetrahedra[i]]) at += 0.25 * vertex_at(model.rest, v);
      const Vec3 d = growth->directions[i], out = at - at.dot(axis) / 9 * axis;
      EXPECT_NEAR(d.norm(), 1, 1e-14);
      const bool turned = growth == model.growths[1];
      EXPECT_NEAR(std::abs(d.dot(axis) / 3), turned ? 0.5 : 0, 1e-12);
      EXPECT_NEAR(std::abs(d.dot(out.normalized())), turned ? 0 : 1, 1e-12);
    }
}

TEST(CompileGrowth, DirectionsOfTheNearestSample) {
  RobotSpec spec = growing_block();
  DirectionSpec samples;
  samples.kind = DirectionSpec::Kind::samples;
  samples.places = Points(2, 3);
  samples.places << 7.5, 4, 3, 12.5, 4, 3;
  samples.samples = Points(2, 3);
  samples.samples << 0, 3, 0, 0, 0, -2;
  samples.file = "fibres.csv";
  spec.regions = {{"middle", Selector(Box{{5, -1, -1}, {15, 9, 7}}), line(3)}};
  spec.actuators = {growing({along("middle", samples)})};
  const Model model = compile(spec);
  const Growth& growth = *model.growths.at(0);
  for (std::size_t i = 0; i < growth.tetrahedra.size(); ++i) {
    double x = 0;
    for (const Index v : model.elements.tetrahedra[growth.tetrahedra[i]]) x += 0.25 * model.rest(v, 0);
    EXPECT_EQ(growth.directions[i], x < 10 ? Vec3(0, 1, 0) : Vec3(0, 0, -1));
  }
  spec.actuators = {growing({along("all", samples)})};
  EXPECT_NE(refusal(spec).find("actuator 'growth': its direction of fibres.csv has no sample near"), std::string::npos)
      << refusal(spec);
}

/// Values at the points, no overshoot, slopes that are those of the values, linear beyond.
TEST(CompileGrowth, CurvesOfTemperatures) {
  const GrowthCurve linear({25, 2e-4, {}});
  EXPECT_DOUBLE_EQ(linear.stretch(75), 1.01);
  EXPECT_DOUBLE_EQ(linear.slope(75), 2e-4);
  const GrowthCurve table({20, {}, {{0, 5}, {20, 10}, {40, 8}, {60, 9}, {80, 15}}});
  EXPECT_DOUBLE_EQ(table.stretch(0), 0.5);
  EXPECT_DOUBLE_EQ(table.stretch(20), 1);
  EXPECT_DOUBLE_EQ(table.stretch(60), 0.9);
  EXPECT_EQ(table.slope(40), 0);  // it turns there
  for (double celsius = -5; celsius < 90; celsius += 0.37) {
    const double numeric = (table.stretch(celsius + 1e-5) - table.stretch(celsius - 1e-5)) / 2e-5;
    EXPECT_NEAR(table.slope(celsius), numeric, 1e-7) << celsius;
    if (celsius > 20 && celsius < 40) {
      EXPECT_LE(table.stretch(celsius), 1);
      EXPECT_GE(table.stretch(celsius), 0.8);
    }
  }
  EXPECT_NEAR(table.stretch(100), 1.5 + 20 * table.slope(80), 1e-12);
}

TEST(CompileGrowth, Refusals) {
  RobotSpec good = growing_block();
  good.actuators = {growing({{"left"}})};
  expect_refused(
      good,
      {{"target shapes", [](RobotSpec& s) { s = block_robot(s.mesh), s.actuators = {growing({{"all"}})}; },
        "needs the physical formulation"},
       {"no part", replaced({}), "needs to say what grows"},
       {"unknown", replaced({{"nowhere"}}), "nowhere"},
       {"faces", replaced({{"x_low"}}), "region 'x_low' holds no element of the body"},
       {"twice", replaced({{"left"}, {"all"}}), "grow twice"},
       {"no range", [](RobotSpec& s) { s.actuators[0].low = 0; }, "needs a range with 0 < low <= high, not [0, 1.5]"},
       {"rest", [](RobotSpec& s) { s.actuators[0].rest = 1.1; }, "cannot have a stretch at rest other than 1"},
       {"keeps", replaced({{"left", {}, true}}), "keeps its volume as it grows, and so needs a direction"},
       {"no direction", replaced({along("left", {.uniform = Vec3::Zero()})}), "needs a direction that is finite"},
       {"on the axis", replaced({along("left", {DirectionSpec::Kind::radial, {}, {5.0 / 8, 1, 1.125}, {0, 0, 0}})}),
        "needs an axis that is finite and not 0"},
       {"both", replaced({{"left"}, {"right", {}, false, TemperatureSpec{20, 1e-3, {}}}}), "one command does one"},
       {"curve", [](RobotSpec& s) { s.actuators[0].curve = straight_curve(); }, "is a growth: it takes no curve"},
       {"other",
        [](RobotSpec& s) {
          ActuatorSpec more = growing({{"all"}});
          more.name = "more";
          s.actuators.push_back(more);
        },
        "actuator 'more' and actuator 'growth' both let tetrahedron"}});
  RobotSpec warm = growing_block();
  warm.actuators = {heated({{"left"}})};
  const auto temperature = [](const TemperatureSpec& spec) { return replaced({{"left", {}, false, spec}}); };
  expect_refused(
      warm,
      {{"cold", [](RobotSpec& s) { s.actuators[0].low = -300; }, "needs a range with -273.15 <= low"},
       {"both ways", temperature({20, 1e-3, {{0, 1}, {50, 2}}}), "an expansion per K or a table, one of the two"},
       {"neither", temperature({20, {}, {}}), "an expansion per K or a table, one of the two"},
       {"descends", temperature({20, {}, {{0, 1}, {90, 2}, {30, 3}}}), "must ascend, but 30 degC follows 90 degC"},
       {"short", temperature({20, {}, {{0, 1}, {50, 2}}}), "but its table ends at 50 degC"},
       {"outside", temperature({20, {}, {{30, 1}, {50, 2}}}), "the reference of 20 degC is outside the table"},
       {"gone", temperature({20, -0.1, {}}), "would shrink to a stretch of -5 at 80 degC"},
       {"reference", temperature({30, 1e-3, {}}), "is at rest at 20 degC, and all that grows with it must be"}});
}

/// Of a robot that is placed among others directions turn with it.
TEST(CompileGrowth, TurnsWithARobot) {
  RobotSpec spec = growing_block();
  spec.actuators = {growing({along("left", {.uniform = {1, 0, 0}}),
                             along("right", {DirectionSpec::Kind::radial, {}, {5, 30, -2}, {0, 1, 0}})})};
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix();
  const Model alone = compile(spec), placed = compile(joined({{"a", spec, {turn, {100, 0, 3}}, {}}}, {}));
  ASSERT_EQ(placed.growths.size(), 2u);
  EXPECT_EQ(placed.actuators[0].name, "a.growth");
  for (std::size_t g = 0; g < 2; ++g)
    for (std::size_t i = 0; i < alone.growths[g]->directions.size(); ++i)
      EXPECT_LT((turn * alone.growths[g]->directions[i] - placed.growths[g]->directions[i]).norm(), 1e-12);
}

TEST(CompileGrowth, FingerprintsTell) {
  RobotSpec spec = growing_block();
  spec.actuators = {heated({{"left"}})};
  const std::string before = fingerprint_of(compile(spec));
  replaced({{"left", {}, false, TemperatureSpec{20, 1.1e-3, {}}}})(spec);
  EXPECT_NE(fingerprint_of(compile(spec)), before);
}

}  // namespace softkin
