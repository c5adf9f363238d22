#include "support/degenerate_scenes.hpp"

#include <functional>
#include <map>
#include <stdexcept>

#include "model/block_mesh.hpp"
#include "support/two_bodies.hpp"

namespace softkin::testing {

namespace {

using Cell = std::array<int, 3>;
using Keep = std::function<bool(int, int, int)>;   // of a cell
using Place = std::function<Vec3(int, int, int)>;  // of a vertex of the grid

/// Splits the cells of a grid into six tetrahedra each and places their vertices. Vertices at the same place become
/// one, and tetrahedra that thereby lose their volume are left out. The lowest layer of vertices is held.
PressedBody shaped(const Cell& cells, const Place& place, const Keep& keep = {}) {
  Mesh mesh;
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        if (keep && !keep(i, j, k)) continue;
        std::array<Index, 8> corners{};
        for (int c = 0; c < 8; ++c) corners[c] = grid_vertex(cells, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        split_cell(corners, Split::six, false, mesh);
      }
  PressedBody body;
  std::map<std::array<double, 3>, Index> vertex_at_place;
  const int across = cells[0] + 1, layer = across * (cells[1] + 1);
  std::vector<Vec3> places;
  for (Tetrahedron t : mesh.tetrahedra) {
    Tetrahedron distinct = t;
    for (Index& v : distinct) {
      const Vec3 p = place(v % across, v % layer / across, v / layer);
      const auto [found, added] = vertex_at_place.try_emplace({p.x(), p.y(), p.z()}, static_cast<Index>(places.size()));
      if (added) places.push_back(p);
      if (v < layer) body.held.push_back(found->second);
      v = found->second;
    }
    t = distinct;
    std::sort(distinct.begin(), distinct.end());
    if (std::adjacent_find(distinct.begin(), distinct.end()) == distinct.end()) body.tetrahedra.push_back(t);
  }
  body.vertices.resize(places.size(), 3);
  for (std::size_t v = 0; v < places.size(); ++v) body.vertices.row(v) = places[v];
  sort_unique(body.held);
  return body;
}

// All bodies are centred on the z axis; their highest points are at z = 0.

constexpr double half = 6, base = -10, shoulder = -6;  // [mm]

PressedBody spike() {
  return shaped({2, 2, 2}, [](int i, int j, int k) {
    return k == 2 ? Vec3(0, 0, 0) : Vec3(half * (i - 1), half * (j - 1), k == 0 ? base : shoulder);
  });
}

/// Its edge is along y.
PressedBody wedge() {
  return shaped({2, 2, 2}, [](int i, int j, int k) {
    return Vec3(k == 2 ? 0 : half * (i - 1), half * (j - 1), k == 2 ? 0 : k == 0 ? base : shoulder);
  });
}

/// A groove along y, 3 mm deep and 6 mm wide: as steep as spike and wedge.
PressedBody crack() {
  return shaped({4, 2, 2}, [](int i, int j, int k) {
    return Vec3(3 * (i - 2), half * (j - 1), k == 0 ? base : k == 1 ? shoulder : i == 2 ? -3 : 0);
  });
}

/// 4 mm wide, 5 mm deep.
PressedBody block_with_hole() {
  return shaped(
      {3, 3, 2}, [](int i, int j, int k) { return Vec3(4 * i - half, 4 * j - half, base + 5 * k); },
      [](int i, int j, int k) { return i != 1 || j != 1 || k != 1; });
}

/// The higher half is at x <= 0.
PressedBody step() {
  return shaped(
      {4, 2, 2}, [](int i, int j, int k) { return Vec3(3 * (i - 2), half * (j - 1), base + 5 * k); },
      [](int i, int, int k) { return i < 2 || k == 0; });
}

PressedBody flat() {
  return shaped({4, 4, 1}, [](int i, int j, int k) { return Vec3(3 * (i - 2), 3 * (j - 2), k == 0 ? base / 2 : 0); });
}

PressedBody block(double wide, double deep) {
  return shaped({2, 2, 1},
                [=](int i, int j, int k) { return Vec3(wide / 2 * (i - 1), deep / 2 * (j - 1), k == 0 ? -half : 0); });
}

/// Turned half around x, then moved.
PressedBody upside_down(PressedBody body, const Vec3& move) {
  for (Index v = 0; v < body.vertices.rows(); ++v) {
    const Vec3 p = vertex_at(body.vertices, v);
    body.vertices.row(v) = (Vec3(p.x(), -p.y(), -p.z()) + move).transpose();
  }
  return body;
}

/// By a quarter around z.
PressedBody turned(PressedBody body) {
  for (Index v = 0; v < body.vertices.rows(); ++v) {
    const Vec3 p = vertex_at(body.vertices, v);
    body.vertices.row(v) << -p.y(), p.x(), p.z();
  }
  return body;
}

struct Arrangement {
  const char* name;
  PressedBody lower, upper;
  Vec3 touching{0, 0, 0};  // where the upper body touches the lower one
  bool slides = false;
};

Arrangement arrangement(DegenerateCase kind) {
  switch (kind) {
    case DegenerateCase::spikes:
      return {"spikes", spike(), spike()};
    case DegenerateCase::spike_on_wedge:
      return {"spike_on_wedge", wedge(), spike()};
    case DegenerateCase::wedges:
      return {"wedges", wedge(), wedge()};
    case DegenerateCase::crossed_wedges:
      return {"crossed_wedges", wedge(), turned(wedge())};
    case DegenerateCase::spike_in_crack:
      return {"spike_in_crack", crack(), spike(), {0, 0, -3}};
    case DegenerateCase::wedge_in_crack:
      return {"wedge_in_crack", crack(), wedge(), {0, 0, -3}};
    case DegenerateCase::spike_in_hole:
      return {"spike_in_hole", block_with_hole(), spike(), {0, 0, -2}};
    case DegenerateCase::cliff_edges:
      return {"cliff_edges", step(), block(half, 2 * half), {-half / 2, 0, 0}};
    case DegenerateCase::internal_edges:
      return {"internal_edges", flat(), block(half, half), {0, 0, 0}, true};
    case DegenerateCase::sliding_spike:
      return {"sliding_spike", flat(), spike(), {-3, 0, 0}, true};
    case DegenerateCase::sliding_wedge:
      return {"sliding_wedge", flat(), wedge(), {-3, 0, 0}, true};
    case DegenerateCase::count:
      break;
  }
  throw std::invalid_argument("degenerate_scene: no such case");
}

}  // namespace

DegenerateScene degenerate_scene(DegenerateCase kind, double gap, double press) {
  if (!(gap > 0 && gap <= 4)) throw std::invalid_argument("degenerate_scene: gap outside its range");
  const Arrangement made = arrangement(kind);
  const PressedBody upper = upside_down(made.upper, made.touching + Vec3(0, 0, gap));
  return {two_bodies(made.name, made.lower, upper, {made.slides ? press : 0, 0, -press}),
          static_cast<Index>(made.lower.vertices.rows())};
}

}  // namespace softkin::testing
