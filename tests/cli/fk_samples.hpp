#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "mesh_samples.hpp"
#include "run_program.hpp"

namespace softkin::testing {

/// A block of nx x 3 x 3 cubic cells of 4 [length units], each in six tetrahedra: region chamber are the cells along
/// its middle but the first and the last, region body all others; base: x = 0, tip: x = 4 nx.
struct Block {
  GmshText mesh;
  std::vector<std::array<int, 3>> tip;  // triangles
  int corner = 0;                       // the vertex (4 nx, 12, 12)

  explicit Block(int nx, double edge = 4) {
    mesh.names = {"3 1 \"body\"", "3 2 \"chamber\"", "2 3 \"base\"", "2 4 \"tip\""};
    for (int k = 0; k <= 3; ++k)
      for (int j = 0; j <= 3; ++j)
        for (int i = 0; i <= nx; ++i) mesh.vertices.push_back({edge * i, edge * j, edge * k});
    const auto vertex = [nx](int i, int j, int k) { return i + (nx + 1) * (j + 4 * k); };
    corner = vertex(nx, 3, 3);
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < nx; ++i) {
          const bool inside = j == 1 && k == 1 && i > 0 && i + 1 < nx;
          const auto at = [&](int c) { return vertex(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)); };
          const int between[6][2] = {{1, 3}, {3, 2}, {2, 6}, {6, 4}, {4, 5}, {5, 1}};
          for (const auto& [a, b] : between) mesh.elements.push_back({4, inside ? 2 : 1, {at(0), at(a), at(b), at(7)}});
        }
        for (const int i : {0, nx}) {
          const std::array<int, 3> lower{vertex(i, j, k), vertex(i, j + 1, k), vertex(i, j + 1, k + 1)};
          const std::array<int, 3> upper{vertex(i, j, k), vertex(i, j + 1, k + 1), vertex(i, j, k + 1)};
          for (const auto& t : {lower, upper}) {
            mesh.elements.push_back({2, i == 0 ? 3 : 4, {t[0], t[1], t[2]}});
            if (i > 0) tip.push_back(t);
          }
        }
      }
  }
};

/// Scene of the block in block.msh: actuator air with range 1 to 2, markers tip (region) and corner (a vertex).
inline std::string block_scene(const std::string& more = "") {
  return "softkin: 1\n"
         "mesh: {file: block.msh}\n"
         "materials: [{region: body, shape_ratio: 1.0, linear_range: 0.05}]\n"
         "fixed: [{region: base}]\n"
         "actuators: [{name: air, kind: pneumatic, region: chamber, range: [1.0, 2.0]}]\n"
         "markers: [{name: tip, region: tip}, {name: corner, point: [20, 12, 12]}]\n" +
         more;
}

/// The block of rubber in the physical formulation: actuators air (a ratio, 0.5 to 3) and tendon (a length, 0.5 to 1.2)
/// along its upper side; force payload at the tip, 0 N.
inline std::string physical_scene(const std::string& more = "") {
  return "softkin: 1\n"
         "mesh: {file: block.msh}\n"
         "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, linear_range: 0.05}]\n"
         "fixed: [{region: base}]\n"
         "actuators:\n"
         "  - {name: air, kind: pneumatic, region: chamber, control: volume, range: [0.5, 3]}\n"
         "  - {name: tendon, kind: cable, points: [[0, 6, 12], [20, 6, 12]], control: length, range: [0.5, 1.2]}\n"
         "forces: [{name: payload, region: tip, force: [0, 0, 0]}]\n"
         "markers: [{name: tip, region: tip}, {name: corner, point: [20, 12, 12]}]\n" +
         more;
}

/// text with a part replaced that must be there.
inline std::string replaced(std::string text, const std::string& part, const std::string& by) {
  return text.replace(text.find(part), part.size(), by);
}

/// The same, air controlled by its pressure (-100 to 3000 kPa) and tendon by its tension (0 to 100 N).
inline std::string loaded_scene() {
  return replaced(replaced(physical_scene(), "volume, range: [0.5, 3]", "pressure, range: [-100, 3000]"),
                  "length, range: [0.5, 1.2]", "tension, range: [0, 100]");
}

/// A folder with block.msh and block.yaml.
struct BlockFolder : TemporaryFolder {
  Block block{5};
  std::string scene;

  explicit BlockFolder(const std::string& text = block_scene()) {
    write("block.msh", block.mesh.text());
    scene = write("block.yaml", text);
  }
};

inline ProgramResult run_fk(const std::string& scene, const std::vector<std::string>& options) {
  std::vector<std::string> arguments{"fk", scene, "--threads", "1"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  return run_program(arguments);
}

/// One line on standard error that names what is wrong, exit code 2, nothing printed and nothing written.
inline void expect_refused(const BlockFolder& folder, const std::vector<std::string>& options,
                           const std::string& message) {
  const std::size_t before = folder.files();
  const ProgramResult result = run_fk(folder.scene, options);
  EXPECT_EQ(result.exit_code, 2) << message;
  EXPECT_EQ(result.output, "") << message;
  EXPECT_EQ(result.errors.rfind("softkin: ", 0), 0u) << result.errors;
  EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
  EXPECT_NE(result.errors.find(message), std::string::npos) << "no '" << message << "' in " << result.errors;
  EXPECT_EQ(folder.files(), before) << message;
}

}  // namespace softkin::testing
