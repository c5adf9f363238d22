#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "fk_samples.hpp"
#include "model/block_mesh.hpp"
#include "run_program.hpp"

namespace softkin {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

const fs::path published = fs::path(SOFTKIN_SOURCE_DIR) / "examples/paper/published_robot";

/// A block of the paper's size along y with three chambers along it, in the three files of the published robot.
void write_small_robot(const TemporaryFolder& folder) {
  Mesh mesh = testing::block_mesh({6, 17, 6}, {48, 136, 48}, testing::Split::six);
  mesh.vertices.col(0).array() -= 24;
  mesh.vertices.col(2).array() -= 24;
  std::ostringstream tet, chambers, handle;
  tet << mesh.vertices.rows() << " vertices\n" << mesh.tetrahedra.size() << " tets\n" << mesh.vertices << "\n";
  const std::array<std::array<double, 2>, 3> middles{{{0, -12}, {-12, 12}, {12, 12}}};
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    Eigen::RowVector3d center = Eigen::RowVector3d::Zero();
    tet << 4;
    for (const Index v : mesh.tetrahedra[t]) {
      tet << " " << v;
      center += mesh.vertices.row(v) / 4;
    }
    tet << "\n";
    chambers << t << ":";
    for (const auto& [x, z] : middles) {
      const bool inside = std::abs(center[0] - x) < 4 && std::abs(center[2] - z) < 4 && std::abs(center[1] - 68) < 48;
      chambers << inside << ":";
    }
    chambers << "0:\n";
  }
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    handle << v << ":" << (mesh.vertices(v, 1) == 0) << ":" << (mesh.vertices(v, 1) == 136) << ":\n";
  folder.write("soro_body.tet", tet.str());
  folder.write("soro_chamber.txt", chambers.str());
  folder.write("soro_rigid_handle.txt", handle.str());
}

TEST(PublishedRobot, SceneBendsAMeshOfThatForm) {
  const TemporaryFolder folder;
  write_small_robot(folder);
  const std::string scene = folder / "published_robot.yaml";
  fs::copy_file(published / "published_robot.yaml", scene);
  const auto tip = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"fk", scene, "--json", "--threads", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const testing::ProgramResult found = testing::run_program(arguments);
    EXPECT_EQ(found.exit_code, 0) << found.errors;
    const auto report = nlohmann::json::parse(found.output);
    EXPECT_EQ(report["warnings"].size(), 0u) << report["warnings"];
    const auto& at = report["steps"][0]["markers"]["tip"];
    return Vec3(at[0], at[1], at[2]);
  };
  const Vec3 bent = tip({"--set", "air1=1.5"}), mirrored = tip({"--set", "air2=1.5"});
  EXPECT_GT(bent[2], 3) << bent.transpose();  // away from the chamber at z = -12
  EXPECT_GT(mirrored[0], 2) << mirrored.transpose();
  EXPECT_LT(mirrored[2], -2) << mirrored.transpose();
}

TEST(PublishedRobot, FlowerHasThePublishedSize) {
  std::istringstream lines(testing::read_text((published / "flower.csv").string()));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(line, "t_s,x_mm,z_mm");
  std::vector<std::array<double, 3>> rows;
  for (double t = 0, x = 0, z = 0; std::getline(lines, line); rows.push_back({t, x, z}))
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &t, &x, &z), 3) << line;
  ASSERT_EQ(rows.size(), 121u);
  EXPECT_NEAR(rows.front()[1], rows.back()[1], 1e-9);
  EXPECT_NEAR(rows.front()[2], rows.back()[2], 1e-9);
  const auto across = [&](std::size_t column) {
    const auto [low, high] = std::minmax_element(rows.begin(), rows.end(),
                                                 [&](const auto& a, const auto& b) { return a[column] < b[column]; });
    return (*high)[column] - (*low)[column];
  };
  EXPECT_NEAR(across(1), 63, 1e-3);
  EXPECT_NEAR(across(2), 70, 1e-3);
  // r = 1 + 0.25 cos 5 t, in steps of 3 degrees, stretched along each axis
  const auto radius = [](double t) { return 1 + 0.25 * std::cos(5 * t); };
  const double along_z = rows[0][2] / radius(0), quarter = std::numbers::pi / 2,
               along_x = rows[30][1] / radius(quarter);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double t = std::numbers::pi * static_cast<double>(i) / 60;
    EXPECT_NEAR(rows[i][1], along_x * radius(t) * std::sin(t), 2e-4) << i;
    EXPECT_NEAR(rows[i][2], along_z * radius(t) * std::cos(t), 2e-4) << i;
  }
}

TEST(PublishedRobot, FkStopsAsTheProgramDoes) {
  const testing::BlockFolder folder;
  const std::string report = folder / "r.json";
  const testing::ProgramResult reported = testing::run_fk(
      folder.scene, {"--set", "air=1.5", "--solver", "local-global", "--as-published", "--report", report});
  EXPECT_EQ(reported.exit_code, 0) << reported.errors;
  EXPECT_NE(
      reported.output.find("\nstopped as published: no marker moved by 0.032 mm in the last iteration; this is no "
                           "equilibrium\n"),
      std::string::npos)
      << reported.output;
  const nlohmann::json stopped = nlohmann::json::parse(testing::read_text(report)), step = stopped["steps"][0];
  EXPECT_EQ(stopped["solver"]["as_published"], true);
  EXPECT_EQ(stopped["solver"]["anderson"], 0);
  EXPECT_GE(step["iterations"], 10);
  EXPECT_EQ(step["tolerance_mm"], 0.032);
  const nlohmann::json newton =
      nlohmann::json::parse(testing::run_fk(folder.scene, {"--set", "air=1.5", "--json"}).output);
  EXPECT_FALSE(newton["solver"].contains("as_published"));
  double off = 0;
  for (int axis = 0; axis < 3; ++axis)
    off = std::max(off, std::abs(step["markers"]["tip"][axis].get<double>() -
                                 newton["steps"][0]["markers"]["tip"][axis].get<double>()));
  EXPECT_GT(off, 0.032);  // the step is no error
}

/// The paper's authors publish chambers and handle in files beside the mesh; without them the scene has nothing to
/// name.
TEST(PublishedRobot, FkNamesTheSidecarsThatATetMeshLacks) {
  const TemporaryFolder folder;
  folder.write("soro_body.tet", "5 vertices\n2 tets\n0 0 0\n10 0 0\n0 10 0\n0 0 10\n10 10 10\n4 0 1 2 3\n4 1 2 3 4\n");
  const std::string head =
                        "softkin: 1\nmesh: {file: soro_body.tet}\nmaterials: [{shape_ratio: 1}]\nmarkers: [{name: "
                        "tip, point: [6, 6, 6]}]\nfixed: [{",
                    air = "actuators: [{name: air, kind: pneumatic, region: chamber1, range: [1, 2]}]\n",
                    vertices = "box: [[-1, -1, -1], [11, 11, 0.1]]}]\n";
  const std::string looked = "there is no soro_body_chamber.txt and no soro_chamber.txt beside it";
  const testing::ProgramResult refused = testing::run_program({"fk", folder.write("a.yaml", head + vertices + air)});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.errors.find("there is no region 'chamber1'"), std::string::npos) << refused.errors;
  EXPECT_NE(refused.errors.find(looked), std::string::npos) << refused.errors;
  const testing::ProgramResult warned = testing::run_program({"fk", folder.write("b.yaml", head + vertices)});
  EXPECT_EQ(warned.exit_code, 0) << warned.errors;
  EXPECT_NE(warned.output.find("\nwarning: no chambers of soro_body.tet are known: " + looked), std::string::npos)
      << warned.output;
  folder.write("soro_chamber.txt", "0:1:\n1:0:\n");
  folder.write("soro_rigid_handle.txt", "0:1:0:\n1:1:0:\n2:1:0:\n3:0:0:\n4:0:0:\n");
  const testing::ProgramResult blown =
      testing::run_program({"fk", folder.write("c.yaml", head + "region: handle}]\n" + air), "--set", "air=1.2"});
  EXPECT_EQ(blown.exit_code, 0) << blown.errors;
  EXPECT_EQ(blown.output.find("warning: no chambers"), std::string::npos) << blown.output;
}

}  // namespace
}  // namespace softkin
