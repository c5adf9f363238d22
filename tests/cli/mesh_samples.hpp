#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "run_program.hpp"

namespace softkin::testing {

/// Writes Gmsh 2.2 ASCII by hand.
struct GmshText {
  struct Element {
    // type: 15 point, 2 triangle, 3 quad, 4 tetrahedron, 6 prism; of order 2: 9 triangle, 11 tetrahedron. group: 0 none
    int type, group;
    std::vector<int> vertices;  // from 0
  };
  std::vector<std::string> names;  // lines: dimension, group, name in double quotes
  std::vector<std::array<double, 3>> vertices;
  std::vector<Element> elements;

  [[nodiscard]] std::string text() const {
    std::ostringstream out;
    out.precision(17);
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    if (!names.empty()) {
      out << "$PhysicalNames\n" << names.size() << "\n";
      for (const std::string& name : names) out << name << "\n";
      out << "$EndPhysicalNames\n";
    }
    out << "$Nodes\n" << vertices.size() << "\n";
    for (std::size_t i = 0; i < vertices.size(); ++i)
      out << i + 1 << " " << vertices[i][0] << " " << vertices[i][1] << " " << vertices[i][2] << "\n";
    out << "$EndNodes\n$Elements\n" << elements.size() << "\n";
    for (std::size_t i = 0; i < elements.size(); ++i) {
      out << i + 1 << " " << elements[i].type << " 2 " << elements[i].group << " 1";
      for (const int v : elements[i].vertices) out << " " << v + 1;
      out << "\n";
    }
    out << "$EndElements\n";
    return out.str();
  }
};

/// Tetrahedra without regions.
inline GmshText tetrahedra(const std::vector<std::array<double, 3>>& vertices,
                           const std::vector<std::vector<int>>& elements) {
  GmshText mesh;
  mesh.vertices = vertices;
  for (const auto& element : elements) mesh.elements.push_back({4, 0, element});
  return mesh;
}

/// The cube [0, 2]^3 in six equal tetrahedra around the diagonal, positive: vertex number = x + 2 y + 4 z over the
/// edge. Regions: body (tetrahedra 0 to 3), chamber (4, 5), base (z = 0, two triangles), corner (the origin).
inline GmshText cube() {
  GmshText mesh;
  mesh.names = {"3 1 \"body\"", "3 2 \"chamber\"", "2 3 \"base\"", "0 4 \"corner\""};
  for (int i = 0; i < 8; ++i) mesh.vertices.push_back({2.0 * (i & 1), 2.0 * (i >> 1 & 1), 2.0 * (i >> 2)});
  const int paths[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (int i = 0; i < 6; ++i)
    mesh.elements.push_back({4, i < 4 ? 1 : 2, {paths[i][0], paths[i][1], paths[i][2], paths[i][3]}});
  mesh.elements.push_back({2, 3, {0, 1, 3}});
  mesh.elements.push_back({2, 3, {0, 3, 2}});
  mesh.elements.push_back({15, 4, {0}});
  return mesh;
}

/// The mesh with its tetrahedra and triangles of order 2, nodes in the middle of the edges.
inline GmshText quadratic(GmshText mesh) {
  std::map<std::pair<int, int>, int> nodes;
  const auto node_between = [&](int a, int b) {
    const auto [place, fresh] =
        nodes.try_emplace(std::pair(std::min(a, b), std::max(a, b)), static_cast<int>(mesh.vertices.size()));
    if (!fresh) return place->second;
    const std::array<double, 3> p = mesh.vertices[a], q = mesh.vertices[b];
    mesh.vertices.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
    return place->second;
  };
  const std::vector<std::array<int, 2>> of_triangle{{0, 1}, {1, 2}, {2, 0}},
      of_tetrahedron{{0, 1}, {1, 2}, {2, 0}, {3, 0}, {2, 3}, {1, 3}};
  for (GmshText::Element& element : mesh.elements) {
    if (element.type != 2 && element.type != 4) continue;
    const std::vector<int> corners = element.vertices;
    for (const auto& [a, b] : element.type == 2 ? of_triangle : of_tetrahedron)
      element.vertices.push_back(node_between(corners[a], corners[b]));
    element.type = element.type == 2 ? 9 : 11;
  }
  return mesh;
}

/// A prism of height 5 over a right triangle with legs 3 and 4: region skin; its side of 3 x 5: region wall.
inline GmshText prism() {
  GmshText mesh;
  mesh.names = {"3 1 \"skin\"", "2 2 \"wall\""};
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, 5}, {3, 0, 5}, {0, 4, 5}};
  mesh.elements = {{6, 1, {0, 1, 2, 3, 4, 5}}, {3, 2, {0, 1, 4, 3}}};
  return mesh;
}

}  // namespace softkin::testing
