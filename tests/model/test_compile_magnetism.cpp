#include <Eigen/Geometry>
#include <softkin/model/joined.hpp>
#include <softkin/model/magnetic_field.hpp>
#include <softkin/model/names.hpp>

#include "model/compile_testing.hpp"
#include "model/physical_robots.hpp"

/// What is magnetic in a compiled robot, and what is refused.

namespace softkin {

namespace {

using namespace testing;

ActuatorSpec field_command(const std::string& name, const FieldSource& source,
                           FieldCommand command = FieldCommand::flux_density) {
  ActuatorSpec spec = actuator(name, FieldSpec{std::make_shared<const FieldSource>(source), command}, -10, 10);
  spec.control = Control::load;
  spec.rest = 0;
  return spec;
}

void set_remanence(MaterialSpec& material, const RemanenceSpec& remanence) {
  material.remanence = std::make_shared<const RemanenceSpec>(remanence);
}

RobotSpec magnetic_block() {
  RobotSpec spec = physical_robot(block_mesh({4, 1, 1}, {40, 10, 10}));
  set_remanence(spec.materials[0], {{100, 0, 0}});
  spec.actuators = {field_command("field", {"field", UniformField{{0, 0, 5}}})};
  return spec;
}

CommonSpec named_whole() {
  CommonSpec common;
  common.name = "pair.yaml";
  return common;
}

/// A sample per 10 mm along x.
RemanenceSpec programmed() {
  RemanenceSpec spec;
  spec.file = "pattern.csv";
  spec.magnetisation = Magnetisation::stretches;
  spec.places.resize(4, 3);
  spec.samples.resize(4, 3);
  for (int i = 0; i < 4; ++i) {
    spec.places.row(i) << 10 * i + 5, 5, 5;
    spec.samples.row(i) << 0, i + 1, 0;
  }
  return spec;
}

}  // namespace

TEST(CompileMagnetism, RemanenceByMaterialAndBySamples) {
  RobotSpec spec = magnetic_block();
  add_volume_region(spec.mesh, "half", [](const Vec3& p) { return p.x() > 20; });
  spec.materials.push_back(spec.materials[0]);
  spec.materials[1].region = "half";
  set_remanence(spec.materials[1], programmed());
  const Model model = compile(spec);
  ASSERT_TRUE(model.magnetism);
  ASSERT_EQ(model.magnetism->remanence.size(), model.elements.tetrahedra.size());
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e) {
    double x = 0;
    for (const Index v : model.elements.tetrahedra[e]) x += 0.25 * model.rest(v, 0);
    const Vec3 expected = x < 20 ? Vec3(100, 0, 0) : Vec3(0, std::floor(x / 10) + 1, 0);
    EXPECT_EQ(model.magnetism->remanence[e], expected) << x;
    EXPECT_EQ(model.magnetism->magnetisation[e], x < 20 ? Magnetisation::turns : Magnetisation::stretches) << x;
  }
  const auto& field = std::get<UniformField>(model.magnetism->sources.at(0).field);
  EXPECT_EQ(field.direction, Vec3(0, 0, 1));
}

TEST(CompileMagnetism, CommandsOfOneSource) {
  RobotSpec spec = magnetic_block();
  ActuatorSpec x = field_command("x", {"magnet", DipoleField{{0, 0, 50}, {1, 0, 0}}}, FieldCommand::position_x);
  x.rest = 3;
  ActuatorSpec my = x;
  my.name = "my";
  my.rest = 0;
  my.drive = FieldSpec{x.as<FieldSpec>()->source, FieldCommand::moment_y};
  spec.actuators.push_back(x);
  spec.actuators.push_back(my);
  spec.actuators.push_back(field_command("coil", {"coil", CoilField{{CoilLoop{}}}}, FieldCommand::current));
  const Model model = compile(spec);
  EXPECT_EQ(model.magnetism->sources.size(), 3u);
  EXPECT_EQ(model.actuators[1].as<MagneticDrive>()->source, model.actuators[2].as<MagneticDrive>()->source);
  EXPECT_EQ(model.rest_actuation()[1], 3);
  const std::vector<std::array<std::string, 3>> names{{"flux density", "mT", "field_mT"},
                                                      {"position", "mm", "x_mm"},
                                                      {"moment", "A m^2", "my_Am2"},
                                                      {"current", "A", "coil_A"}};
  for (std::size_t a = 0; a < 4; ++a) {
    EXPECT_EQ(control_name(model.actuators[a]), names[a][0]);
    EXPECT_EQ(command_name(model.actuators[a]), names[a][0]);
    EXPECT_EQ(command_unit(model.actuators[a]), names[a][1]);
    EXPECT_EQ(command_column(model.actuators[a]), names[a][2]);
    EXPECT_EQ(multiplier_key(model.actuators[a]), "");
    EXPECT_TRUE(drives(model.actuators[a]));
    EXPECT_FALSE(has_measure(model.actuators[a]));
  }
}

TEST(CompileMagnetism, TheFingerprintKnowsThem) {
  const RobotSpec spec = magnetic_block();
  std::set<std::string> prints{fingerprint_of(compile(spec))};
  RobotSpec other = spec;
  set_remanence(other.materials[0], {{100, 0, 1}});
  EXPECT_TRUE(prints.insert(fingerprint_of(compile(other))).second);
  RemanenceSpec stretching = *spec.materials[0].remanence;
  stretching.magnetisation = Magnetisation::stretches;
  set_remanence(other.materials[0], stretching);
  EXPECT_TRUE(prints.insert(fingerprint_of(compile(other))).second);
  other = spec;
  other.actuators[0] = field_command("field", {"field", UniformField{{0, 1, 5}}});
  EXPECT_TRUE(prints.insert(fingerprint_of(compile(other))).second);
  other.actuators[0] = field_command("field", {"field", CoilField{{CoilLoop{}}}}, FieldCommand::current);
  EXPECT_TRUE(prints.insert(fingerprint_of(compile(other))).second);
}

TEST(CompileMagnetism, Refusals) {
  GridField grid{"grid.csv", {0, 0, 0}, {10, 10, 5}, {5, 4, 4}, std::vector<Vec3>(80, Vec3(1, 0, 0))};
  const auto with = [](const FieldSource& source, FieldCommand command = FieldCommand::current) {
    return [=](RobotSpec& spec) { spec.actuators[0] = field_command("field", source, command); };
  };
  RobotSpec in_grid = magnetic_block();
  with({"field", grid})(in_grid);
  EXPECT_EQ(refusal(in_grid), "");
  GridField small = grid;
  small.step[2] = 3;
  expect_refused(
      magnetic_block(),
      {{"no remanence", [](RobotSpec& s) { s.materials[0].remanence.reset(); }, "acts on nothing"},
       {"no field", [](RobotSpec& s) { s.actuators[0].drive = FieldSpec{}; }, "needs a source"},
       {"a ratio", [](RobotSpec& s) { s.actuators[0].control = Control::ratio; }, "is controlled by its load"},
       {"a curve", [](RobotSpec& s) { s.actuators[0].curve = straight_curve(); },
        "is a magnetic field: it takes no curve"},
       {"a range", [](RobotSpec& s) { s.actuators[0].low = 11; }, "needs a range with low <= high"},
       {"no direction", with({"field", UniformField{{0, 0, 0}}}, FieldCommand::flux_density), "needs a direction"},
       {"no radius", with({"field", CoilField{{CoilLoop{{0, 0, 0}, {0, 0, 1}, 0}}}}), "needs a radius above 0 mm"},
       {"no turns", with({"field", CoilField{{CoilLoop{{0, 0, 0}, {0, 0, 1}, 1, 0}}}}), "needs turns"},
       {"no loops", with({"field", CoilField{}}), "at least one loop"},
       {"a current through a magnet", with({"field", DipoleField{}}), "what a dipole does not have"},
       {"a grid that is too small", with({"field", small}), "does not reach the magnetic material"},
       {"commanded twice",
        [](RobotSpec& s) {
          s.actuators.push_back(s.actuators[0]);
          s.actuators[1].name = "b";
        },
        "commands the same as actuator 'field'"},
       {"not finite",
        [](RobotSpec& s) {
          set_remanence(s.materials[0], {{NAN, 0, 0}});
        },
        "remanence is not finite"},
       {"samples far away",
        [](RobotSpec& s) {
          RemanenceSpec far = programmed();
          far.places.array() += 100;
          set_remanence(s.materials[0], far);
        },
        "no sample near"},
       {"target shapes", [](RobotSpec& s) { s.formulation = Formulation::target_shape; },
        "that needs the physical formulation"}});
}

TEST(CompileMagnetism, NotesAndWarnings) {
  RobotSpec spec = magnetic_block();
  spec.actuators.clear();
  const Model idle = compile(spec);
  EXPECT_TRUE(has_note(idle, "no magnetic field"));
  EXPECT_FALSE(idle.magnetism);
  spec.formulation = Formulation::target_shape;
  spec.materials[0].shape_ratio = 1;
  EXPECT_TRUE(has_note(compile(spec), "Remanence is left out"));
  RobotSpec tesla = magnetic_block();
  set_remanence(tesla.materials[0], {{0.1, 0, 0}});
  const Model model = compile(tesla);
  EXPECT_TRUE(std::any_of(model.warnings.begin(), model.warnings.end(), [](const std::string& warning) {
    return warning.find("is it in mT?") != std::string::npos;
  }));
}

/// Remanence goes with a robot to its place; fields are of the whole.
TEST(CompileMagnetism, RobotsAmongSeveral) {
  RobotSpec one = physical_robot(block_mesh({4, 1, 1}, {40, 10, 10}));
  one.name = "one.yaml";
  set_remanence(one.materials[0], programmed());
  Placement place;
  place.rotation = Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()).toRotationMatrix();
  place.translation = {0, 100, 0};
  RobotSpec all = joined({{"left", one, place, line(3)}}, named_whole());
  RobotSpec common;
  common.actuators = {field_command("field", {"field", UniformField{}})};
  add_common(all, common);
  const Model model = compile(all);
  for (std::size_t e = 0; e < model.elements.tetrahedra.size(); ++e)
    EXPECT_LT(model.magnetism->remanence[e].x(), -0.9);  // along y at rest
  EXPECT_EQ(model.magnetism->magnetisation.back(), Magnetisation::stretches);
  one.actuators = {field_command("own", {"own", UniformField{}})};
  EXPECT_THROW((void)joined({{"left", one, place, line(3)}}, named_whole()), InvalidInput);
}

}  // namespace softkin
