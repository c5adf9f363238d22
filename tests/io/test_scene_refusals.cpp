#include <gtest/gtest.h>

#include "scene_fixtures.hpp"

namespace softkin {
namespace {

struct Refusal {
  const char* text;
  const char* fragment;
  std::size_t line;  // in text
};

void expect_refused(const std::string& text, const std::string& fragment, std::size_t line) {
  SCOPED_TRACE(text);
  try {
    (void)parse_scene(text, "s.yaml", fake_files());
    ADD_FAILURE() << "not refused";
  } catch (const InvalidInput& error) {
    const std::string message = error.what(), place = "s.yaml:" + std::to_string(line) + ": ";
    EXPECT_EQ(message.substr(0, place.size()), place) << message;
    EXPECT_NE(message.find(fragment), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

/// Each text follows a good head of two lines.
void expect_all_refused(const std::vector<Refusal>& refusals) {
  for (const Refusal& each : refusals)
    expect_refused(std::string("softkin: 1\nmesh: {file: a.msh}\n") + each.text, each.fragment, each.line + 2);
}

TEST(SceneRefusals, WholeTexts) {
  const std::vector<Refusal> refusals{
      {"", "the scene is empty", 1},
      {"# nothing\n\n", "the scene is empty", 1},
      {"---\n...\n", "the scene is empty", 1},
      {"- softkin: 1\n", "a scene must be a map", 1},
      {"hello", "a scene must be a map", 1},
      {"mesh: {file: a.msh}\n", "needs key 'softkin'", 1},
      {"softkin: 2\nmehs: 1\n", "version 1, not 2", 1},
      {"softkin: '1'\n", "'softkin' must be an integer, not the quoted text '1'", 1},
      {"softkin: 1.0\n", "'softkin' must be an integer, not '1.0'", 1},
      {"softkin: 1\n", "the scene needs key 'mesh'", 1},
      {"softkin: 1\nmesh: a.msh\n", "'mesh' must be a map with keys 'file', not 'a.msh'", 2},
      {"softkin: 1\nmesh: {file: ''}\n", "'file' is empty", 2},
      {"softkin: 1\nmesh: {}\n", "'mesh' needs key 'file'", 2},
      {"softkin: 1\nmesh:\n  file: a.txt\n", "a.txt: no such file", 3},
      {"softkin: 1\nunits: {length: m}\nmesh: {file: huge.msh}\n", "coordinates are too large", 3},
      {"softkin: 1\nsoftkin: 1\n", "key 'softkin' appears twice in the scene; first in line 1", 2},
      {"softkin: 1\n---\nsoftkin: 1\n", "a second YAML document", 2},
      {"softkin: 1\n}\n", "not valid YAML", 2},
      {"softkin: 1\nmesh: {file: [a\n", "not valid YAML", 3},
      {"softkin: 1\nmesh:\n\tfile: a.msh\n", "not valid YAML", 3},
      {"softkin: 1\nmesh: *nobody\n", "not valid YAML", 2},
      {"softkin: 1\nmesh: &a {file: *a}\n", "an alias stands within its own anchor", 2},
      {"softkin: 1\n[1, 2]: 3\n", "a key of the scene must be a word", 2},
      {"softkin: !!int 1\n", "YAML tag", 1},
      {"softkin: 1\n# \xFF\n", "not UTF-8", 2},
      {"softkin: 1\n\n# \x04\n", "control character", 3},
      {"softkin: 1\nmesh: {file: \"a\\0.msh\"}\n", "control character", 2},
  };
  for (const Refusal& each : refusals) expect_refused(each.text, each.fragment, each.line);
  expect_refused(std::string("softkin: 1\n\0", 12), "control character", 2);
}

TEST(SceneRefusals, KeysAndUnits) {
  expect_all_refused({
      {"\nmarkerz: []\n", "unknown key 'markerz' in the scene; did you mean 'markers'?", 2},
      {"gravity: 9.81\n", "unknown key 'gravity' in the scene; known: softkin, units, mesh", 1},
      {"<<: {void: []}\n", "unknown key '<<'", 1},
      {"units: {length: km}\n", "'length' must be one of 'mm', 'cm', 'm', 'um', 'in', not 'km'", 1},
      {"units: {lenght: m}\n", "did you mean 'length'?", 1},
      {"units: mm\n", "'units' must be a map", 1},
      {"formulation: physical\n", "formulation 'physical' is not in this version of softkin; use 'target-shape'", 1},
      {"formulation: fem\n", "'formulation' must be 'target-shape', not 'fem'", 1},
      {"markers:\n", "'markers' must be a list, not empty", 1},
      {"materials: {shape_ratio: 1}\n", "'materials' must be a list, not a map", 1},
  });
}

TEST(SceneRefusals, Regions) {
  expect_all_refused({
      {"regions:\n  - {name: a, box: [[0, 0, 0], [1, 1, 1]]}\n  - {name: a, vertices: [1]}\n",
       "the name 'a' is taken; it is given in line 4", 3},
      {"regions: [{name: a}]\n", "entry 1 of 'regions' needs one of 'box', 'sphere'", 1},
      {"regions: [{box: [[0, 0, 0], [1, 1, 1]]}]\n", "entry 1 of 'regions' needs key 'name'", 1},
      {"regions: [{name: all, vertices: [1]}]\n", "'all' is reserved", 1},
      {"regions:\n  - name: a\n    vertices: [1]\n    elements: [1]\n", "has both 'vertices' and 'elements'", 4},
      {"regions: [{name: a, box: [[0, 0, 2], [1, 1, 1]]}]\n", "low corner above its high corner in z", 1},
      {"regions: [{name: a, box: [[0, 0, 0]]}]\n", "'box' must be a list of 2, not of 1", 1},
      {"regions: [{name: a, box: [[0, 0], [1, 1, 1]]}]\n", "entry 1 of 'box' must be a list of 3, not of 2", 1},
      {"regions: [{name: a, box: [[0, 0, zero], [1, 1, 1]]}]\n",
       "entry 3 of entry 1 of 'box' must be a finite number, not 'zero'", 1},
      {"regions: [{name: a, sphere: {center: [0, 0, 0], radius: 0}}]\n", "'radius' must be greater than 0", 1},
      {"regions: [{name: a, sphere: {center: [0, 0, 0]}}]\n", "'sphere' needs key 'radius'", 1},
      {"regions: [{name: a, sphere: {centre: [0, 0, 0], radius: 1}}]\n", "did you mean 'center'?", 1},
      {"regions: [{name: a, cylinder: {start: [0, 0, 0], end: [1, 0, 0], radius: -1}}]\n",
       "'radius' must be greater than 0, not -1", 1},
      {"regions: [{name: a, cylinder: {start: [1, 0, 0], end: [1, 0, 0], radius: 1}}]\n", "start at its end", 1},
      {"regions: [{name: a, halfspace: {point: [0, 0, 0], normal: [0, 0, 0]}}]\n", "'normal' must not be zero", 1},
      {"regions: [{name: a, vertices: [1, -1]}]\n", "entry 2 of 'vertices' must not be negative: -1", 1},
      {"regions: [{name: a, vertices: [5]}]\n", "the mesh has 5 vertices, numbered from 0", 1},
      {"regions: [{name: a, elements: [2]}]\n", "the mesh has 2 tetrahedra, numbered from 0", 1},
      {"regions: [{name: a, vertices: [1.5]}]\n", "must be an integer, not '1.5'", 1},
      {"regions: [{name: a, vertices: []}]\n", "'vertices' is an empty list", 1},
      {"regions: [{name: a, vertices: [99999999999999999999]}]\n", "must be an integer", 1},
      {"regions: [{name: a, sidecar: {file: odd.txt}}]\n",
       "the sidecar has 3 rows, but the mesh has 5 vertices and 2 tetrahedra", 1},
      {"regions: [{name: a, sidecar: {file: tets.txt, column: 3}}]\n",
       "column 3 is asked for, but the sidecar has 2, numbered from 1", 1},
      {"regions: [{name: a, sidecar: {file: tets.txt, column: 0}}]\n", "column 0 is asked for", 1},
      {"regions: [{name: a, sidecar: {file: tets.txt, of: vertices}}]\n", "the sidecar has 2 rows", 1},
      {"regions: [{name: a, sidecar: {file: none.txt}}]\n", "none.txt: no such file", 1},
  });
  expect_refused("softkin: 1\nmesh: {file: square.msh}\nregions: [{name: a, sidecar: {file: vertices.txt}}]\n",
                 "say 'of: vertices' or 'of: elements' in 'sidecar'", 3);
}

TEST(SceneRefusals, MaterialsAndSupports) {
  expect_all_refused({
      {"materials: [{region: body}]\n", "entry 1 of 'materials' needs key 'shape_ratio'", 1},
      {"materials: [{shape_ratio: 1.5}]\n", "'shape_ratio' must be from 0 to 1, not 1.5", 1},
      {"materials: [{shape_ratio: -0.1}]\n", "'shape_ratio' must be from 0 to 1", 1},
      {"materials: [{shape_ratio: '0.5'}]\n", "must be a finite number, not the quoted text '0.5'", 1},
      {"materials: [{shape_ratio: nan}]\n", "must be a finite number, not 'nan'", 1},
      {"materials: [{shape_ratio: .NaN}]\n", "must be a finite number", 1},
      {"materials: [{shape_ratio: 1, weight: inf}]\n", "'weight' must be a finite number, not 'inf'", 1},
      {"materials: [{shape_ratio: 1, weight: .inf}]\n", "'weight' must be a finite number", 1},
      {"materials: [{shape_ratio: 1, weight: 1e999}]\n", "'weight' must be a finite number", 1},
      {"materials: [{shape_ratio: 1, weight: 0}]\n", "'weight' must be greater than 0, not 0", 1},
      {"materials: [{shape_ratio: 1, linear_range: -0.2}]\n", "'linear_range' must be greater than 0", 1},
      {"materials: [{shape_ratio: ~}]\n", "'shape_ratio' must be a finite number, not empty", 1},
      {"materials:\n  - region: body\n    youngs_modulus: 12\n",
       "key 'youngs_modulus' belongs to the physical formulation", 3},
      {"materials: [{poisson_ratio: 0.4}]\n", "key 'poisson_ratio' belongs to the physical formulation", 1},
      {"materials: [{law: neo-hookean}]\n", "key 'law' belongs to the physical formulation", 1},
      {"void: chamber\n", "'void' must be a list, not 'chamber'", 1},
      {"void:\n  - a\n  -\n", "entry 2 of 'void' must be a word, not empty", 2},
      {"fixed: [base]\n", "entry 1 of 'fixed' must be a map with keys 'region', 'box'", 1},
      {"fixed: [{axes: z}]\n", "entry 1 of 'fixed' needs one of 'region', 'box'", 1},
      {"fixed: [{region: a, axes: xx}]\n", "letters x, y, z, each at most once, not 'xx'", 1},
      {"fixed: [{region: a, axes: [x, y]}]\n", "'axes' must be a word, not a list", 1},
      {"fixed: [{region: a, elements: [1]}]\n", "unknown key 'elements'", 1},
      {"rigid: [{region: a, box: [[0, 0, 0], [1, 1, 1]]}]\n", "has both 'region' and 'box'", 1},
      {"rigid: [[a]]\n", "entry 1 of 'rigid' must be a map", 1},
  });
}

TEST(SceneRefusals, ActuatorsAndMarkers) {
  expect_all_refused({
      {"actuators: [{name: a, kind: hydraulic, range: [1, 2]}]\n", "'kind' must be one of 'pneumatic', 'cable', 'dea'",
       1},
      {"actuators: [{name: a, range: [1, 2]}]\n", "entry 1 of 'actuators' needs key 'kind'", 1},
      {"actuators: [{name: a, kind: dea, region: r}]\n", "entry 1 of 'actuators' needs key 'range'", 1},
      {"actuators: [{name: a, kind: dea, region: r, range: [1]}]\n", "'range' must be a list of 2, not of 1", 1},
      {"actuators: [{name: a, kind: dea, region: r, range: [2, 1]}]\n", "2 is above 1", 1},
      {"actuators: [{name: a, kind: dea, region: r, range: [0, 1]}]\n", "must be greater than 0, not 0", 1},
      {"actuators: [{name: a, kind: dea, range: [1, 2]}]\n", "needs key 'region'", 1},
      {"actuators: [{name: a, kind: dea, regoin: r, range: [1, 2]}]\n", "did you mean 'region'?", 1},
      {"actuators: [{name: a, kind: dea, region: r, range: [1, 2], prestretch: 0}]\n", "'prestretch' must be greater",
       1},
      {"actuators: [{name: a, kind: dea, region: r, range: [1, 2], weight: heavy}]\n", "not 'heavy'", 1},
      {"actuators: [{name: a, kind: dea, region: r, range: [1, 2], distribution: even}]\n",
       "must be one of 'least-norm', 'uniform', not 'even'", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], prestretch: 1}]\n",
       "key 'prestretch' does not belong to kind 'pneumatic'", 1},
      {"actuators: [{name: a, kind: cable, region: r, range: [1, 2]}]\n",
       "key 'region' does not belong to kind 'cable'", 1},
      {"actuators: [{name: a, kind: pneumatic, range: [1, 2]}]\n", "needs one of 'region', 'surface'", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, surface: s.stl, range: [1, 2]}]\n", "has both 'region'", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: s.ply, range: [1, 2]}]\n", "s.ply:7: no facet", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], control: pressure}]\n",
       "control 'pressure' belongs to the physical formulation", 1},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], [1, 0, 0]], range: [0.5, 1], control: tension}]\n",
       "control 'tension' belongs to the physical formulation", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], control: length}]\n",
       "control of kind 'pneumatic' must be 'volume', not 'length'", 1},
      {"actuators: [{name: a, kind: cable, range: [0.5, 1]}]\n", "needs key 'points'", 1},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0]], range: [0.5, 1]}]\n", "at least 2 points", 1},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], [1, 0, 0]], apexes: [], range: [0.5, 1]}]\n",
       "'apexes' must hold 1 to 1 points", 1},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], {box: 1}], range: [0.5, 1]}]\n", "unknown key 'box'", 1},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], eyelet], range: [0.5, 1]}]\n",
       "entry 2 of 'points' must be a list, not 'eyelet'", 1},
      {"actuators:\n  - {name: a, kind: dea, region: r, range: [1, 2]}\n  - {name: a, kind: dea, region: s, range: [1, "
       "2]}\n",
       "the name 'a' is taken; it is given in line 4", 3},
      {"actuators: [{name: 'a=b', kind: dea, region: r, range: [1, 2]}]\n", "must not hold", 1},
      {"markers:\n  - {name: m, point: [0, 0, 0]}\n  - {name: m, region: r}\n", "the name 'm' is taken", 3},
      {"markers: [{name: m}]\n", "needs one of 'point', 'region'", 1},
      {"markers: [{name: m, point: [0, 0, 0], region: r}]\n", "has both 'point' and 'region'", 1},
      {"markers: [{name: m, point: {x: 1}}]\n", "'point' must be a list, not a map", 1},
      {"markers: [{name: '', point: [0, 0, 0]}]\n", "'name' is empty", 1},
      {"markers:\n  - name: m\n    name: n\n    point: [0, 0, 0]\n", "key 'name' appears twice", 3},
      {"units: {length: m}\nmarkers: [{name: m, point: [1e308, 0, 0]}]\n", "is too large: 1e308", 2},
  });
}

}  // namespace
}  // namespace softkin
