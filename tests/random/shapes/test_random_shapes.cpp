#include <gtest/gtest.h>

#include <map>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/runs/shape_files.hpp>
#include <softkin/statics/deformation.hpp>
#include <sstream>

#include "cli/run_program.hpp"
#include "io/shape_hashes.hpp"
#include "random/generator.hpp"
#include "support/skips.hpp"

/// Shapes of random robots as meshio and PyVista read them.

namespace softkin::random_robots {
namespace {

class RandomShapes : public ::testing::TestWithParam<const char*> {};

/// The robot of a seed; none where its scene is refused.
std::optional<Model> model_of(std::uint64_t seed) {
  try {
    return compile(make_case(seed).spec);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

/// A shape near that at rest.
State random_state(const Model& model, std::mt19937& generator) {
  const double size = (model.rest.colwise().maxCoeff() - model.rest.colwise().minCoeff()).norm();
  std::normal_distribution<double> noise(0, 1e-3 * size);
  State state{model.rest};
  for (Index i = 0; i < state.positions.size(); ++i) state.positions.data()[i] += noise(generator);
  return state;
}

/// What read_shapes.py prints first of a file and of its displacements, by softkin's own reader.
std::string expected_lines(const std::string& name, const std::string& path) {
  VtuContent content;
  const Mesh mesh = read_vtu(path);
  content.points = mesh.vertices;
  content.tetrahedra = mesh.tetrahedra;
  content.edge_nodes = mesh.edge_nodes;
  const Points moved = read_vtu_point_vectors(path, "displacement_mm");
  content.point_fields.push_back({"displacement_mm", 3, {moved.data(), moved.data() + moved.size()}});
  return testing::hash_lines(name, content);
}

TEST_P(RandomShapes, AreReadByOtherPrograms) {
  SKIP_WITHOUT_PYTHON(GetParam());
  using softkin::testing::shell_quoted;
  const softkin::testing::TemporaryFolder folder;
  std::mt19937 generator(5);
  std::string expected, found;
  std::size_t robots = 0;
  for (std::uint64_t seed = 0; robots < 1000 && seed < 5000; ++seed) {
    const std::optional<Model> model = model_of(seed);
    if (!model) continue;
    const std::string name = std::to_string(10000 + seed) + ".vtu", path = folder / name;
    const State state = random_state(*model, generator);
    runs::write_shape(path, *model, state, deformation_of(*model, state.positions), true);
    expected += expected_lines(name, path);
    ++robots;
  }
  EXPECT_EQ(robots, 1000u);
  const auto printed = softkin::testing::run_shell(shell_quoted(softkin::testing::test_python()) + " " +
                                                   shell_quoted(SOFTKIN_SOURCE_DIR "/tests/io/read_shapes.py") + " " +
                                                   GetParam() + " " + shell_quoted(folder / ""));
  EXPECT_EQ(printed.exit_code, 0);
  std::istringstream lines(printed.output);
  for (std::string line, file, name; std::getline(lines, line);) {
    std::istringstream(line) >> file >> name;
    if (name == "mesh" || name == "displacement_mm") found += line + "\n";
  }
  EXPECT_EQ(found, expected);
}

INSTANTIATE_TEST_SUITE_P(Vtu, RandomShapes, ::testing::Values("meshio", "pyvista"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace softkin::random_robots
