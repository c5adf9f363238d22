#include <gtest/gtest.h>

#include <cmath>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/model/magnetic_field.hpp>

#include "io/text_mesh_files.hpp"
#include "scene_fixtures.hpp"

/// Remanence and magnetic fields in scenes, and the files that they name.

namespace softkin {

namespace {

RobotSpec magnetic_scene(const std::string& text) {
  return parse_scene("softkin: 1\nunits: {length: cm}\nmesh: {file: a.msh}\nformulation: physical\n" + text, "s.yaml",
                     fake_files());
}

RobotSpec with_field(const std::string& keys) {
  return magnetic_scene("actuators:\n  - {name: field, kind: magnetic, " + keys + "}\n");
}

std::string refused(const std::string& text) {
  try {
    (void)magnetic_scene(text);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

std::string refused_file(const std::string& content, bool grid) {
  const text_mesh_tests::MeshFolder folder;
  try {
    const FieldSamples samples = read_field_samples(folder.write("field.csv", content));
    if (grid) (void)grid_of(samples);
  } catch (const InvalidInput& error) {
    const std::string message = error.what();
    return message.substr(message.find("field.csv"));
  }
  return "";
}

/// The points of a grid, the last one first.
std::string grid_text(int x, int y, int z) {
  std::string text = "x_mm,y_mm,z_mm,bx_mT,by_mT,bz_mT\n";
  for (int k = z - 1; k >= 0; --k)
    for (int i = 0; i < x; ++i)
      for (int j = 0; j < y; ++j)
        text += std::to_string(10 * i) + "," + std::to_string(5 * j) + "," + std::to_string(k - 1) + "," +
                std::to_string(i) + "," + std::to_string(j) + "," + std::to_string(k) + "\n";
  return text;
}

}  // namespace

TEST(SceneMagnetism, UniformFields) {
  const RobotSpec along = with_field("direction: [0, 3, 4], range: [-50, 20]");
  ASSERT_EQ(along.actuators.size(), 1u);
  const ActuatorSpec& one = along.actuators[0];
  EXPECT_EQ(one.name, "field");
  EXPECT_TRUE(one.is<FieldSpec>());
  EXPECT_EQ(one.control, Control::load);
  EXPECT_EQ(one.low, -50);
  EXPECT_EQ(one.high, 20);
  EXPECT_EQ(one.rest, 0);
  EXPECT_EQ(one.origin.line, 6u);
  EXPECT_EQ(one.as<FieldSpec>()->command, FieldCommand::flux_density);
  EXPECT_EQ(std::get<UniformField>(one.as<FieldSpec>()->source->field).direction, Vec3(0, 3, 4));

  const RobotSpec all = with_field("range: [-5, 5]"), some = with_field("range: [-5, 5], axes: [z, x]");
  ASSERT_EQ(all.actuators.size(), 3u);
  EXPECT_EQ(all.actuators[1].name, "field_y");
  EXPECT_EQ(all.actuators[1].as<FieldSpec>()->command, FieldCommand::flux_density_y);
  EXPECT_EQ(all.actuators[1].as<FieldSpec>()->source, all.actuators[2].as<FieldSpec>()->source);
  ASSERT_EQ(some.actuators.size(), 2u);
  EXPECT_EQ(some.actuators[0].name, "field_x");
  EXPECT_EQ(some.actuators[1].name, "field_z");
}

TEST(SceneMagnetism, CoilsAndDipolesInTheScenesUnit) {
  const RobotSpec coil = with_field(
      "coils: [{center: [1, 2, 3], axis: [0, 0, 2], radius: 4, turns: -50}, {center: [0, 0, 0], axis: [1, 0, 0], "
      "radius: "
      "1}], range: [0, 5]");
  ASSERT_EQ(coil.actuators.size(), 1u);
  EXPECT_EQ(coil.actuators[0].as<FieldSpec>()->command, FieldCommand::current);
  const CoilField& loops = std::get<CoilField>(coil.actuators[0].as<FieldSpec>()->source->field);
  ASSERT_EQ(loops.loops.size(), 2u);
  EXPECT_EQ(loops.loops[0].center, Vec3(10, 20, 30));
  EXPECT_EQ(loops.loops[0].radius_mm, 40);
  EXPECT_EQ(loops.loops[0].turns, -50);
  EXPECT_EQ(loops.loops[1].turns, 1);

  const RobotSpec dipole = with_field("dipole: {position: [[1, 3], -2, 5], moment: [0.5, [-1, 2], [0, 1]]}");
  ASSERT_EQ(dipole.actuators.size(), 3u);
  EXPECT_EQ(dipole.actuators[0].name, "field_x");
  EXPECT_EQ(dipole.actuators[0].low, 10);
  EXPECT_EQ(dipole.actuators[0].high, 30);
  EXPECT_EQ(dipole.actuators[0].rest, 20);
  EXPECT_EQ(dipole.actuators[1].name, "field_my");
  EXPECT_EQ(dipole.actuators[1].low, -1);
  EXPECT_EQ(dipole.actuators[1].rest, 0);
  EXPECT_EQ(dipole.actuators[2].as<FieldSpec>()->command, FieldCommand::moment_z);
  const DipoleField& magnet = std::get<DipoleField>(dipole.actuators[0].as<FieldSpec>()->source->field);
  EXPECT_EQ(magnet.position, Vec3(20, -20, 50));
  EXPECT_EQ(magnet.moment, Vec3(0.5, 0, 0));
}

TEST(SceneMagnetism, Remanence) {
  const RobotSpec spec = magnetic_scene(
      "materials:\n  - {region: arm, youngs_modulus: 1, poisson_ratio: 0.4, remanence: [143, 0, -5]}\n  - {region: b, "
      "youngs_modulus: 1, poisson_ratio: 0.4}\n");
  EXPECT_EQ(spec.materials[0].remanence->uniform, Vec3(143, 0, -5));
  EXPECT_EQ(spec.materials[0].remanence->places.rows(), 0);
  EXPECT_EQ(spec.materials[1].remanence, nullptr);
}

TEST(SceneMagnetism, MagnetisationTurnsOrStretches) {
  const std::string head = "materials:\n  - {youngs_modulus: 1, poisson_ratio: 0.4";
  const auto read = [&](const std::string& keys) {
    return magnetic_scene(head + keys + "}\n").materials[0].remanence->magnetisation;
  };
  EXPECT_EQ(read(", remanence: [1, 0, 0]"), Magnetisation::turns);
  EXPECT_EQ(read(", remanence: [1, 0, 0], magnetisation: turns"), Magnetisation::turns);
  EXPECT_EQ(read(", remanence: [1, 0, 0], magnetisation: stretches"), Magnetisation::stretches);
  EXPECT_EQ(read(", magnetisation: stretches, remanence: {places: [[0, 0, 0]], samples: [[1, 0, 0]]}"),
            Magnetisation::stretches);
  for (const auto& [keys, fragment] :
       {std::pair(", remanence: [1, 0, 0], magnetisation: bends", "'turns', 'stretches'"),
        std::pair(", magnetisation: turns", "there is none")}) {
    const std::string message = refused(head + keys + "}\n");
    EXPECT_NE(message.find(fragment), std::string::npos) << message;
    EXPECT_EQ(message.substr(0, 9), "s.yaml:6:") << message;
  }
}

TEST(SceneMagnetism, RemanenceOfSamplesInTheScene) {
  const std::string head =
      "materials:\n  - {youngs_modulus: 1, poisson_ratio: 0.4, remanence: {places: [[0, 0, 0], [1, 2, 3]], ";
  const RobotSpec spec = magnetic_scene(head + "samples: [[1, 0, 0], [0, 1, 0]]}}\n");
  EXPECT_EQ(spec.materials[0].remanence->places.row(1), Eigen::RowVector3d(10, 20, 30));
  EXPECT_EQ(spec.materials[0].remanence->samples.row(1), Eigen::RowVector3d(0, 1, 0));
  EXPECT_NE(refused(head + "samples: [[1, 0, 0]]}}\n").find("must hold as many as 'places', 2, not 1"),
            std::string::npos);
  EXPECT_NE(refused(head + "file: a.csv}}\n").find("'places' and 'file' exclude each other"), std::string::npos);
}

TEST(SceneMagnetism, RefusesWhatIsNoField) {
  const std::string head = "actuators:\n  - {name: field, kind: magnetic, ";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"range: [5, -5]}", "'range' must be [low, high], but 5 is above -5"},
      {"direction: [0, 0, 1]}", "needs key 'range'"},
      {"direction: [0, 0, 1], coils: [], range: [0, 1]}", "key 'coils' excludes 'direction'"},
      {"direction: [0, 0, 1], axes: [x], range: [0, 1]}", "'axes' and 'direction' exclude each other"},
      {"axes: [], range: [0, 1]}", "'axes' must name an axis"},
      {"axes: [x, x], range: [0, 1]}", "axis x is given twice"},
      {"range: [0, 1], control: volume}", "key 'control' does not belong to kind 'magnetic'"},
      {"range: [0, 1], region: arm}", "key 'region' does not belong to kind 'magnetic'"},
      {"coils: [{center: [0, 0, 0], axis: [0, 0, 1], radius: 0}], range: [0, 1]}", "must be greater than 0"},
      {"coils: [{center: [0, 0, 0], axis: [0, 0, 1]}], range: [0, 1]}", "needs key 'radius'"},
      {"dipole: {position: [0, 0, 1], moment: [1, 0, 0]}}", "must have something to command"},
      {"dipole: {position: [[0, 1], 0, 1], moment: [1, 0, 0]}, range: [0, 1]}", "'range' does not belong to a dipole"},
      {"dipole: {position: [[2, 1], 0, 1], moment: [1, 0, 0]}}", "2 is above 1"},
      {"grid: nowhere.csv, range: [0, 1]}", "nowhere.csv"},
  };
  for (const auto& [text, fragment] : cases) {
    const std::string message = refused(head + text + "\n");
    EXPECT_NE(message.find(fragment), std::string::npos) << text << "\n" << message;
    EXPECT_EQ(message.substr(0, 9), "s.yaml:6:") << message;
  }
  EXPECT_NE(refused("actuators:\n  - {name: air, kind: pneumatic, range: [1, 2], coils: []}\n")
                .find("key 'coils' does not belong to kind 'pneumatic'"),
            std::string::npos);
}

TEST(SceneMagnetism, AGridFromAFile) {
  const text_mesh_tests::MeshFolder folder;
  const GridField grid = grid_of(read_field_samples(folder.write("field.csv", grid_text(4, 5, 6))));
  EXPECT_EQ(grid.counts, (std::array<Index, 3>{4, 5, 6}));
  EXPECT_EQ(grid.low, Vec3(0, 0, -1));
  EXPECT_LT((grid.high() - Vec3(30, 20, 4)).norm(), 1e-12);
  EXPECT_EQ(grid.per_ampere[2 + 4 * (3 + 5 * 1)], Vec3(2, 3, 1));
}

TEST(SceneMagnetism, RefusesFilesThatAreNoGrid) {
  const std::string good = grid_text(4, 4, 4), head = "x_mm,y_mm,z_mm,bx_mT,by_mT,bz_mT\n";
  const auto cut = good.rfind('\n', good.size() - 2) + 1;
  EXPECT_EQ(refused_file(good, true), "");
  EXPECT_NE(refused_file(good.substr(0, cut), true).find("needs 64 rows, not 63"), std::string::npos);
  EXPECT_NE(refused_file(good + good.substr(cut), true).find("field.csv:66: this place of the grid of 4 x 4 x 4"),
            std::string::npos);
  EXPECT_NE(refused_file(grid_text(4, 3, 4), true).find("at least 4 places along y, not 3"), std::string::npos);
  EXPECT_NE(refused_file(good + "47,0,0,0,0,0\n", true).find("the grid is not regular: along x"), std::string::npos);
  EXPECT_NE(refused_file("x_mm,y_mm,z_mm,bx_mT,by_mT\n0,0,0,0,0\n", false).find("the column 'bz_mT' is missing"),
            std::string::npos);
  EXPECT_NE(refused_file("x_m,y_mm,z_mm,bx_mT,by_mT,bz_mT\n0,0,0,0,0,0\n", false).find("unknown column 'x_m'"),
            std::string::npos);
  EXPECT_NE(refused_file(head + "0,0,0,0,0\n", false).find("field.csv:2"), std::string::npos);
  EXPECT_THROW((void)read_field_samples("field.txt"), InvalidInput);
}

TEST(SceneMagnetism, SamplesFromTheCellsOfAVtu) {
  const text_mesh_tests::MeshFolder folder;
  VtuContent content;
  content.points.resize(4, 3);
  content.points << 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 4;
  content.tetrahedra = {{0, 1, 2, 3}};
  content.cell_fields = {{"flux_density_mT", 3, {10, 20, 30}}, {"other", 1, {1}}};
  write_vtu(folder / "field.vtu", content);
  const FieldSamples samples = read_field_samples(folder / "field.vtu");
  EXPECT_FALSE(samples.in_mm);
  EXPECT_LT((samples.places.row(0) - Eigen::RowVector3d(1, 1, 1)).norm(), 1e-12);
  EXPECT_EQ(samples.values.row(0), Eigen::RowVector3d(10, 20, 30));
  content.cell_fields = {{"flux_density_mT", 1, {1}}};
  write_vtu(folder / "scalar.vtu", content);
  EXPECT_THROW((void)read_field_samples(folder / "scalar.vtu"), InvalidInput);
  content.cell_fields.clear();
  write_vtu(folder / "none.vtu", content);
  EXPECT_THROW((void)read_field_samples(folder / "none.vtu"), InvalidInput);
}

}  // namespace softkin
