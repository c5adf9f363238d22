#pragma once

#include <softkin/io/scene/scene.hpp>
#include <string>

/// Loaders in the place of files. Meshes: five vertices and two tetrahedra; "square.msh": five and five; "huge.msh":
/// coordinates near the largest double; "quadratic.msh": of order 2; "parts.msh" has regions. Sidecars: "tets.txt",
/// "vertices.txt", "odd.txt" (three rows). Others are absent.
inline softkin::SceneFiles fake_files() {
  using namespace softkin;
  namespace fs = std::filesystem;
  SceneFiles files;
  files.mesh = [](const fs::path& path) {
    if (path.extension() != ".msh") throw InvalidInput({path.string()}, "no such file");
    Mesh mesh;
    mesh.vertices.resize(5, 3);
    mesh.vertices << 0, 0, 0, 0.12, 0, 0, 0, 0.025, 0, 0, 0, 0.025, 1, 1, 1;
    if (path.filename() == "huge.msh") mesh.vertices *= 1e307;
    mesh.tetrahedra.assign(path.filename() == "square.msh" ? 5 : 2, {0, 1, 2, 3});
    if (path.filename() == "quadratic.msh") mesh.edge_nodes.assign(2, {4, 4, 4, 4, 4, 4});
    if (path.filename() == "parts.msh") {
      mesh.triangles = {{0, 1, 2}};
      mesh.regions = {
          {"body", 3, {0, 1}, {}, {}, {}, {}}, {"base", 2, {}, {}, {0}, {}, {}}, {"tip", 0, {}, {}, {}, {}, {4}}};
    }
    return mesh;
  };
  files.surface = [](const fs::path& path) {
    if (path.extension() != ".stl") throw InvalidInput({path.string(), 7}, "no facet");
    TriangleSurface surface;
    if (path.filename() == "closed.stl") {  // the corner of a cube
      surface.vertices.resize(4, 3);
      surface.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
      surface.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
      return surface;
    }
    surface.vertices.resize(3, 3);
    surface.vertices << 0, 0, 0, 1, 0, 0, 0, 0.5, 0;
    surface.triangles = {{0, 1, 2}};
    return surface;
  };
  files.sidecar = [](const fs::path& path) {
    if (path.filename() == "tets.txt") return Sidecar{2, {{0}, {1}}};
    if (path.filename() == "vertices.txt") return Sidecar{5, {{0, 4}, {}, {2}}};
    if (path.filename() == "odd.txt") return Sidecar{3, {{0}}};
    throw InvalidInput({path.string()}, "no such file");
  };
  files.scene = [](const fs::path& path) -> std::string { throw InvalidInput({path.string()}, "no such file"); };
  return files;
}

/// A finger in metres, for the target-shape formulation, with every key that a scene of it may have.
inline const char* const whole_scene = R"(softkin: 1
units: {length: m}
mesh: {file: finger.msh}
formulation: target-shape
regions:
  - {name: stiff, box: [[0, 0, 0], [0.01, 0.025, 0.025]]}
  - {name: ball, sphere: {center: [0.1, 0.2, 0.3], radius: 0.004}}
  - {name: rod, cylinder: {start: [0, 0, 0], end: [0.12, 0, 0], radius: 0.002}}
  - {name: upper, halfspace: {point: [0, 0, 0.0125], normal: [0, 0, 5]}}
  - {name: corner, vertices: [4, 0, 4]}
  - {name: last, elements: [1]}
  - {name: chamber2, sidecar: {file: tets.txt, column: 2}}
  - {name: feet, sidecar: {file: vertices.txt}}
materials:
  - {shape_ratio: 0.5}
  - {region: rib, shape_ratio: 1.0, weight: 2, linear_range: 0.2}
void: [chamber2]
fixed:
  - {region: base}
  - {box: [[-0.001, -0.001, -0.001], [0.0001, 0.026, 0.026]]}
  - {region: feet, axes: zx}
rigid:
  - tip_plate
  - region: handle
  - sphere: {center: [0.12, 0, 0], radius: 0.001}
actuators:
  - {name: air, kind: pneumatic, region: chamber, control: volume, range: [1.0, 3.0], distribution: uniform}
  - name: tendon
    kind: cable
    points: [[0, 0.012, 0.022], [0.06, 0.012, 0.022], {region: eyelet}]
    apexes: [[0.03, 0.012, 0.01]]
    control: length
    range: [0.5, 1.0]
    weight: 7
    spacing: 0.004
  - {name: skin, kind: dea, region: membrane, control: area, range: [0.7, 1.4], prestretch: 1.2}
  - {name: bag, kind: pneumatic, surface: cavity.stl, range: [1, 2]}
markers:
  - {name: tip, point: [0.120, 0.0125, 0]}
  - {name: cap, region: tip}
)";

/// A robot in metres for the physical formulation, with every key that this one has beside those of whole_scene.
inline const char* const physical_scene = R"(softkin: 1
units: {length: m}
mesh: {file: finger.msh, order: 2}
gravity: [0, 0.5, -9.81]
materials:
  - {youngs_modulus: 12, poisson_ratio: 0.4, density: 1130, shape_ratio: 0.5}
  - {region: rib, law: corotational, youngs_modulus: 30, poisson_ratio: -0.2}
  - {region: skin, law: mooney-rivlin, c10: 0.3, c01: -0.1, bulk_modulus: 100}
  - {region: foam, law: yeoh, c10: 0.11, c20: -0.02, poisson_ratio: 0.49}
  - {region: plate, shape_ratio: 1}
actuators:
  - {name: air, kind: pneumatic, region: chamber, control: pressure, range: [-20, 80], weight: 3, distribution: uniform}
  - name: tendon
    kind: cable
    points: [[0, 0.012, 0.022], [0.06, 0.012, 0.022]]
    apexes: [[0.03, 0.012, 0.01]]
    control: tension
    range: [0, 25]
  - {name: bag, kind: pneumatic, surface: cavity.stl, range: [1, 2], control: volume}
forces:
  - {name: load, region: tip, force: [0, 0, -0.5]}
  - {name: push, point: [0.12, 0, 0.01], force: [1, 0, 0]}
)";
