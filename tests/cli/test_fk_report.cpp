#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <softkin/io/mesh/mesh_io.hpp>
#include <stdexcept>

#include "fk_samples.hpp"

namespace {

using namespace softkin;
using namespace softkin::testing;
using nlohmann::json;

/// What one run wrote, and the mesh that it began with.
struct Solved {
  json report;
  Mesh rest, shape;
};

Solved solve_block(const BlockFolder& folder, const std::string& ratio) {
  const ProgramResult result = run_program({"fk", folder.scene, "--set", "air=" + ratio, "-o", folder / "shape.vtu",
                                            "--report", folder / "report.json", "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return {json::parse(read_text(folder / "report.json")), read_mesh(folder / "block.msh"),
          read_mesh(folder / "shape.vtu")};
}

const std::vector<Index>& tetrahedra_of(const Mesh& mesh, const std::string& region) {
  for (const Region& each : mesh.regions)
    if (each.name == region) return each.tetrahedra;
  throw std::runtime_error("no region " + region);
}

Mat3 edges(const Points& p, const Tetrahedron& t) {
  Mat3 m;
  for (int i = 0; i < 3; ++i) m.col(i) = (p.row(t[i + 1]) - p.row(t[0])).transpose();
  return m;
}

double volume(const Points& p, const Tetrahedron& t) {
  return std::abs(edges(p, t).determinant()) / 6;
}

/// Of each element of the body: principal strain of largest magnitude, and volume at rest; least and greatest of all.
std::vector<std::pair<double, double>> body_strains(const Solved& solved, double& lowest, double& highest) {
  std::vector<std::pair<double, double>> strains;
  lowest = 1, highest = -1;
  for (const Index e : tetrahedra_of(solved.shape, "body")) {
    const Tetrahedron& t = solved.shape.tetrahedra[e];
    const Mat3 f = edges(solved.shape.vertices, t) * edges(solved.rest.vertices, t).inverse();
    const Eigen::SelfAdjointEigenSolver<Mat3> cauchy_green(f.transpose() * f);
    const double least = std::sqrt(cauchy_green.eigenvalues()[0]) - 1;
    const double most = std::sqrt(cauchy_green.eigenvalues()[2]) - 1;
    lowest = std::min(lowest, least);
    highest = std::max(highest, most);
    strains.emplace_back(std::abs(most) >= std::abs(least) ? most : least, volume(solved.rest.vertices, t));
  }
  return strains;
}

void expect_keys(const json& object, const std::vector<std::string>& keys) {
  ASSERT_TRUE(object.is_object());
  std::vector<std::string> found;
  for (const auto& [key, value] : object.items()) found.push_back(key);
  std::vector<std::string> sorted = keys;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(found, sorted);  // json sorts its keys
}

void expect_step_form(const json& step, const std::vector<std::string>& more) {
  std::vector<std::string> keys{"actuation",
                                "status",
                                "iterations",
                                "residual",
                                "step_mm",
                                "seconds",
                                "energy",
                                "tolerance_mm",
                                "estimated_error_mm",
                                "inverted_elements",
                                "largest_displacement_mm",
                                "self_overlap",
                                "markers",
                                "strain",
                                "actuators",
                                "history",
                                "reached",
                                "remark",
                                "shape_actuation",
                                "factorisations",
                                "factorisations_in_double",
                                "projections",
                                "shifts",
                                "continuation_steps",
                                "marker_turns_deg"};
  keys.insert(keys.end(), more.begin(), more.end());
  expect_keys(step, keys);
  for (const char* key : {"residual", "step_mm", "tolerance_mm", "estimated_error_mm", "seconds", "energy"})
    EXPECT_TRUE(step[key].is_number_float()) << key;
  for (const char* key : {"iterations", "factorisations", "projections", "shifts", "continuation_steps"})
    EXPECT_TRUE(step[key].is_number_unsigned()) << key;
  EXPECT_TRUE(step["inverted_elements"].is_number_integer());
  expect_keys(step["actuation"], {"air"});
  expect_keys(step["actuators"], {"air"});
  expect_keys(step["actuators"]["air"], {"requested", "achieved"});
  expect_keys(step["markers"], {"tip", "corner"});
  for (const json& marker : step["markers"]) EXPECT_EQ(marker.size(), 3u);
  expect_keys(step["marker_turns_deg"], {"tip"});
  expect_keys(step["strain"],
              {"least", "greatest", "magnitude_percentile_95", "bin_edges", "volume_shares", "beyond_linear_range"});
  expect_keys(step["history"], {"iteration", "energy", "step_mm", "residual"});
  for (const json& curve : step["history"]) EXPECT_EQ(curve.size(), step["history"]["iteration"].size());
}

TEST(FkReport, HasTheFormOfTheDesign) {
  const BlockFolder folder;
  const json report = solve_block(folder, "1.5").report;
  expect_keys(report, {"softkin", "instruction_set", "scene", "robot_fingerprint", "formulation", "materials",
                       "actuators", "solver", "units", "mesh", "notes", "warnings", "steps", "seconds"});
  EXPECT_EQ(report["scene"], folder.scene);
  EXPECT_EQ(report["mesh"], json({{"order", 1}, {"vertices", 96}, {"tetrahedra", 270}, {"prisms", 0}}));
  EXPECT_EQ(report["solver"], json({{"name", "newton"}, {"tolerance_mm", 0.0}, {"max_iterations", 500}}));
  EXPECT_EQ(report["formulation"], "target-shape");
  EXPECT_EQ(report["materials"], json::parse(R"([{"region": "body", "shape_ratio": 1.0, "weight": 1.0}])"));
  EXPECT_EQ(report["units"]["energy"], "mm^5");
  EXPECT_EQ(report["units"]["residual"], "mm^4");
  EXPECT_EQ(run_program({"--version"}).output, "softkin " + report["softkin"].get<std::string>() +
                                                   ", instruction set " + report["instruction_set"].get<std::string>() +
                                                   "\n");
  ASSERT_EQ(report["steps"].size(), 1u);
  const json& step = report["steps"][0];
  expect_step_form(step, {});
  EXPECT_EQ(step["status"], "converged");
  EXPECT_EQ(step["reached"], 1.0);
  EXPECT_EQ(step["remark"], "");
  EXPECT_EQ(step["shape_actuation"], step["actuation"]);
  EXPECT_LT(step["step_mm"], step["tolerance_mm"]);
  EXPECT_NEAR(step["tolerance_mm"], 8e-8 * std::hypot(20, 12, 12), 1e-15);
  EXPECT_EQ(report["seconds"], step["seconds"]);
  EXPECT_EQ(step["history"]["iteration"].size(), step["iterations"]) << "short enough to be kept whole";
}

TEST(FkReport, OfAPathHasTimesShapesAndTheSumOfSeconds) {
  const BlockFolder folder;
  const std::string path = folder.write("path.csv", "t_s,air\n0.5,1\n2,1.2\n2.5,1.1\n");
  const ProgramResult result =
      run_program({"fk", folder.scene, "--path", path, "-o", folder / "a.pvd", "--json", "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const json report = json::parse(result.output);
  const double times[] = {0.5, 2, 2.5}, ratios[] = {1, 1.2, 1.1};
  double seconds = 0;
  ASSERT_EQ(report["steps"].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const json& step = report["steps"][i];
    expect_step_form(step, {"time_s", "shape", "shape_fingerprint"});
    EXPECT_EQ(step["time_s"], times[i]);
    EXPECT_EQ(step["actuation"]["air"], ratios[i]);
    EXPECT_EQ(step["shape"], "a_000" + std::to_string(i) + ".vtu");
    EXPECT_TRUE(std::ifstream(folder / step["shape"].get<std::string>()).good());
    seconds += step["seconds"].get<double>();
  }
  EXPECT_NEAR(report["seconds"], seconds, 1e-12);
  for (const char* entry : {"timestep=\"0.5\" group=\"\" part=\"0\" file=\"a_0000.vtu\"",
                            "timestep=\"2.5\" group=\"\" part=\"0\" file=\"a_0002.vtu\""})
    EXPECT_NE(read_text(folder / "a.pvd").find(entry), std::string::npos) << entry;
}

TEST(FkReport, MarkersAreWhereTheShapeIs) {
  const BlockFolder folder;
  const Solved solved = solve_block(folder, "1.6");
  const json& markers = solved.report["steps"][0]["markers"];
  const Points& p = solved.shape.vertices;
  Vec3 sum = Vec3::Zero();  // weights of a region's mean are areas at rest, which are all equal here
  for (const auto& [a, b, c] : folder.block.tip) sum += (p.row(a) + p.row(b) + p.row(c)).transpose() / 3;
  sum /= static_cast<double>(folder.block.tip.size());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(markers["corner"][axis], p(folder.block.corner, axis), 1e-9);
    EXPECT_NEAR(markers["tip"][axis], sum[axis], 1e-9);
  }
  EXPECT_GT(sum.x(), 20.2) << "air lengthens it";
}

TEST(FkReport, AchievedRatioIsTheVolumeOfTheShape) {
  const BlockFolder folder;
  const Solved solved = solve_block(folder, "1.6");
  double before = 0, after = 0;
  for (const Index e : tetrahedra_of(solved.shape, "chamber")) {
    const Tetrahedron& t = solved.shape.tetrahedra[e];
    before += volume(solved.rest.vertices, t);
    after += volume(solved.shape.vertices, t);
  }
  EXPECT_NEAR(before, 3 * 64, 1e-9);
  const json& air = solved.report["steps"][0]["actuators"]["air"];
  EXPECT_NEAR(air["achieved"], after / before, 1e-12);
  EXPECT_GT(air["achieved"], 1.3);
  EXPECT_EQ(air["requested"], 1.6);
}

TEST(FkReport, StrainHistogramIsThatOfTheShape) {
  const BlockFolder folder;
  const Solved solved = solve_block(folder, "1.6");
  double least = 0, greatest = 0;
  const auto strains = body_strains(solved, least, greatest);
  ASSERT_EQ(strains.size(), 252u);
  const json& strain = solved.report["steps"][0]["strain"];
  const std::vector<double> edges_of_bins = strain["bin_edges"], fractions = strain["volume_shares"];
  ASSERT_EQ(edges_of_bins.size(), fractions.size() + 1);
  EXPECT_GE(fractions.size(), 8u);
  EXPECT_NEAR(std::accumulate(fractions.begin(), fractions.end(), 0.0), 1, 1e-12);

  std::vector<double> expected(fractions.size(), 0);
  double total = 0, beyond = 0;
  for (const auto& [value, fraction] : strains) total += fraction;
  for (const auto& [value, fraction] : strains) {
    const auto above = std::upper_bound(edges_of_bins.begin(), edges_of_bins.end(), value);
    ASSERT_TRUE(above != edges_of_bins.begin() && above != edges_of_bins.end()) << value;
    expected[static_cast<std::size_t>(above - edges_of_bins.begin()) - 1] += fraction / total;
    if (std::abs(value) > 0.05) beyond += fraction / total;
  }
  for (std::size_t i = 0; i < fractions.size(); ++i) EXPECT_NEAR(fractions[i], expected[i], 1e-9) << i;
  EXPECT_NEAR(strain["least"], least, 1e-9);
  EXPECT_NEAR(strain["greatest"], greatest, 1e-9);

  ASSERT_EQ(strain["beyond_linear_range"].size(), 1u);
  const json& range = strain["beyond_linear_range"][0];
  EXPECT_EQ(range["region"], "body");
  EXPECT_EQ(range["linear_range"], 0.05);
  EXPECT_NEAR(range["volume_share"], beyond, 1e-9);
  EXPECT_GT(beyond, 0.1);
  EXPECT_LT(beyond, 0.9);
}

TEST(FkReport, PercentileBoundsTheLargestStrains) {
  const BlockFolder folder;
  const Solved solved = solve_block(folder, "1.6");
  const double bound = solved.report["steps"][0]["strain"]["magnitude_percentile_95"];
  double total = 0, above = 0, from = 0, least = 0, greatest = 0;
  for (const auto& [value, fraction] : body_strains(solved, least, greatest)) {
    total += fraction;
    if (std::abs(value) > bound + 1e-9) above += fraction;
    if (std::abs(value) > bound - 1e-9) from += fraction;
  }
  EXPECT_LE(above, 0.05 * total * (1 + 1e-12));
  EXPECT_GE(from, 0.05 * total * (1 - 1e-12));
}

TEST(FkReport, LengthsAreInMillimetresWhateverTheSceneHas) {
  const BlockFolder folder, metres;
  metres.write("block.msh", Block(5, 0.004).mesh.text());
  std::string scene = block_scene("units: {length: m}\n");
  scene.replace(scene.find("[20, 12, 12]"), 12, "[0.02, 0.012, 0.012]");
  metres.write("block.yaml", scene);
  const json a = solve_block(folder, "1.4").report["steps"][0], b = solve_block(metres, "1.4").report["steps"][0];
  for (const char* marker : {"tip", "corner"})
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(a["markers"][marker][axis], b["markers"][marker][axis], 1e-4);
}

TEST(FkReport, StatesRegionsBeyondTheirOwnRange) {
  const BlockFolder folder;
  std::string scene = block_scene("regions: [{name: half, box: [[-1, -1, -1], [10, 13, 13]]}]\n");
  scene.replace(scene.find("materials: ["), 12,
                "materials: [{region: body, shape_ratio: 0.5, linear_range: 1.5}, {region: half, shape_ratio: 1}, "
                "{region: nose, shape_ratio: 1, linear_range: 1.0e-9}, ");
  scene.replace(scene.find("regions: ["), 10, "regions: [{name: nose, box: [[16, -1, -1], [21, 13, 13]]}, ");
  scene.erase(scene.find("{region: body, shape_ratio: 1.0, linear_range: 0.05}"), 52);
  scene.replace(scene.find("1.0e-9}, ]"), 10, "1.0e-9}]");
  folder.write("block.yaml", scene);
  const json strain = solve_block(folder, "1.5").report["steps"][0]["strain"];
  const json& beyond = strain["beyond_linear_range"];
  ASSERT_EQ(beyond.size(), 2u) << beyond;
  EXPECT_EQ(beyond[0], json({{"region", "body"}, {"linear_range", 1.5}, {"volume_share", 0.0}}));
  EXPECT_EQ(beyond[1]["region"], "nose");
  EXPECT_EQ(beyond[1]["volume_share"], 1.0);
}

}  // namespace
