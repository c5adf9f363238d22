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

TEST(SceneRefusals, Tractions) {
  expect_all_refused({
      {"tractions: [{name: a, region: r}]\n", "'traction', 'pressure'", 1},
      {"tractions: [{name: a, region: r, traction: [1, 2, 3], pressure: 4}]\n", "'pressure'", 1},
      {"tractions: [{name: a, region: r, pressure: 4, follows: true}]\n", "a pressure always follows", 1},
      {"tractions: [{name: a, region: r, traction: 3}]\n", "'traction'", 1},
      {"tractions: [{name: a, region: r, traction: [1, 2, 3], follows: yes}]\n", "'false', 'true'", 1},
      {"tractions: [{region: r, pressure: 4}]\n", "'name'", 1},
      {"tractions:\n  - {name: a, region: r, pressure: 4}\n  - {name: a, region: q, pressure: 4}\n", "'a'", 3},
      {"tractions: [{name: a, pressure: 4}]\n", "'region'", 1},
  });
}

TEST(SceneRefusals, Layers) {
  expect_all_refused({
      {"layers: [{region: r, thickness: 1, youngs_modulus: 1, poisson_ratio: 0.3}]\n", "'name'", 1},
      {"layers: [{name: a, thickness: 1, youngs_modulus: 1, poisson_ratio: 0.3}]\n", "'region', 'surface'", 1},
      {"layers: [{name: a, region: r, youngs_modulus: 1, poisson_ratio: 0.3}]\n", "'thickness'", 1},
      {"layers: [{name: a, region: r, thickness: 1, poisson_ratio: 0.3}]\n", "'youngs_modulus', 'orthotropic'", 1},
      {"layers: [{name: a, region: r, thickness: 1, youngs_modulus: 1}]\n", "'poisson_ratio'", 1},
      {"layers: [{name: a, region: r, thickness: 1, youngs_modulus: 1, poisson_ratio: 0.6}]\n", "at most 0.5, not 0.6",
       1},
      {"layers: [{name: a, region: r, thickness: 1, orthotropic: {e1: 1, e2: 1, g12: 1, nu12: 0}}]\n",
       "needs its 'direction'", 1},
      {"layers: [{name: a, region: r, thickness: 1, direction: [1, 0, 0], orthotropic: {e1: 1, e2: 0, g12: 1, nu12: "
       "0}}]\n",
       "greater than 0", 1},
      {"layers: [{name: a, region: r, thickness: 1, poisson_ratio: 0.3, orthotropic: {e1: 1, e2: 1, g12: 1, nu12: "
       "0}}]\n",
       "has 'nu12'", 1},
      {"layers: [{name: a, region: r, thickness: 1, direction: [0, 0, 0], youngs_modulus: 1, poisson_ratio: 0.3}]\n",
       "must not be zero", 1},
      {"layers: [{name: a, region: r, thickness: 1, law: gent, shear_modulus: 1}]\n", "'neo-hookean'", 1},
      {"layers: [{name: a, region: r, thickness: 1, law: yeoh, c20: 1}]\n", "'c10'", 1},
      {"layers: [{name: a, region: r, thickness: 1, law: yeoh, c10: 1, c01: 1}]\n",
       "'c01' does not belong to law 'yeoh'", 1},
      {"layers: [{name: a, region: r, thickness: 1, law: mooney-rivlin, c10: 1, c01: -0.1}]\n",
       "'c01' must be 0 or more", 1},
      {"layers: [{name: a, region: r, thickness: 1, law: neo-hookean, shear_modulus: 1, poisson_ratio: 0.4}]\n",
       "keeps its volume", 1},
      {"layers: [{name: a, region: r, thickness: 1, law: neo-hookean, shear_modulus: 1, bending: true}]\n",
       "does not bend", 1},
      {"layers: [{name: a, region: r, thickness: 1, c10: 1}]\n", "'c10' is of a 'law'", 1},
      {"layers: [{name: a, region: r, thickness: 1, bending: yes, youngs_modulus: 1, poisson_ratio: 0.3}]\n",
       "'false', 'true'", 1},
      {"layers: [{name: a, region: r, thickness: 1, stiffness: 1}]\n", "'stiffness'", 1},
      {"layers:\n  - {name: a, region: r, thickness: 1, youngs_modulus: 1, poisson_ratio: 0.3}\n"
       "  - {name: a, region: q, thickness: 1, youngs_modulus: 1, poisson_ratio: 0.3}\n",
       "'a'", 3},
  });
}

TEST(SceneRefusals, Fibres) {
  expect_all_refused({
      {"fibres: [{points: [[0, 0, 0], [1, 0, 0]], stiffness: 1}]\n", "'name'", 1},
      {"fibres: [{name: a, stiffness: 1}]\n", "'points', 'helix', 'file'", 1},
      {"fibres: [{name: a, points: [[0, 0, 0], [1, 0, 0]]}]\n", "'stiffness', 'inextensible'", 1},
      {"fibres: [{name: a, points: [[0, 0, 0], [1, 0, 0]], stiffness: 0}]\n", "greater than 0", 1},
      {"fibres: [{name: a, points: [[0, 0, 0], [1, 0, 0]], inextensible: false}]\n", "give the 'stiffness'", 1},
      {"fibres: [{name: a, points: [[0, 0, 0], [1, 0, 0]], stiffness: 1, tension_only: yes}]\n", "'false', 'true'", 1},
      {"fibres: [{name: a, points: [[0, 0], [1, 0, 0]], stiffness: 1}]\n", "entry 1 of 'points'", 1},
      {"fibres: [{name: a, file: no.csv, stiffness: 1}]\n", "no.csv", 1},
      {"fibres:\n  - {name: a, helix: {start: [0, 0, 0], axis: [0, 0, 0], radius: 1, pitch: 1, turns: 1}, stiffness: "
       "1}\n",
       "must not be zero", 2},
      {"fibres:\n  - {name: a, helix: {start: [0, 0, 0], axis: [0, 0, 1], radius: 1, pitch: -1, turns: 1}, stiffness: "
       "1}\n",
       "'pitch' must be 0 or more", 2},
      {"fibres:\n  - {name: a, helix: {start: [0, 0, 0], axis: [0, 0, 1], radius: 1, pitch: 1, turns: 1, handed: "
       "both},\n"
       "     stiffness: 1}\n",
       "'right', 'left'", 2},
      {"fibres:\n  - {name: a, points: [[0, 0, 0], [1, 0, 0]], stiffness: 1}\n"
       "  - {name: a, points: [[0, 0, 0], [1, 0, 0]], stiffness: 1}\n",
       "'a'", 3},
  });
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
      {"softkin: 1\nmesh: a.msh\n",
       "'mesh' must be a map with keys 'file', 'order', 'curve', 'accept_errors', not 'a.msh'", 2},
      {"softkin: 1\nmesh: {file: ''}\n", "'file' is empty", 2},
      {"softkin: 1\nmesh: {}\n", "'mesh' needs key 'file'", 2},
      {"softkin: 1\nmesh:\n  file: a.txt\n", "a.txt: no such file", 3},
      {"softkin: 1\nunits: {length: m}\nmesh: {file: huge.msh}\n", "coordinates are too large", 3},
      {"softkin: 1\nmesh: {file: a.msh, order: 3}\n", "'order' must be 1 or 2, not 3", 2},
      {"softkin: 1\nmesh: {file: a.msh, order: 2.0}\n", "'order' must be an integer", 2},
      {"softkin: 1\nmesh:\n  file: a.msh\n  curve: true\n", "add 'order: 2'", 4},
      {"softkin: 1\nmesh: {file: a.msh, order: 2, curve: yes}\n", "'curve' must be one of 'false', 'true'", 2},
      {"softkin: 1\nmesh: {file: a.msh, order: 2, curve: []}\n", "'curve' is empty", 2},
      {"softkin: 1\nmesh: {file: a.msh, order: 2, curve: {crease: 0}}\n", "'crease' must be above 0 and at most 120",
       2},
      {"softkin: 1\nmesh: {file: a.msh, order: 2, curve: {box: 1}}\n", "'box'", 2},
      {"softkin: 1\nmesh: {file: a.msh, order: 2, curve: {crease: 30, unit: m}}\n", "'unit' is that of a 'file'", 2},
      {"softkin: 1\nmesh: {file: a.msh, order: 2, curve: {sphere: {center: [0, 0, 0], radius: -1}}}\n",
       "'radius' must be greater than 0", 2},
      {"softkin: 1\nmesh: {file: a.msh, accept_errors: yes}\n", "'accept_errors' must be one of 'false', 'true'", 2},
      {"softkin: 1\nmesh:\n  file: quadratic.msh\n  order: 1\n", "the tetrahedra of the mesh are of order 2", 4},
      {"softkin: 1\nsoftkin: 1\n", "key 'softkin' appears twice in the scene; first in line 1", 2},
      {"softkin: 1\n---\nsoftkin: 1\n", "a second YAML document", 2},
      {"softkin: 1\n}\n", "not valid YAML: the '}' here closes nothing", 2},
      {"softkin: 1\nmesh: {file: [a\n", "not valid YAML: the '[' here is never closed: a ']' is missing", 2},
      {"softkin: 1\nmesh:\n\tfile: a.msh\n", "not valid YAML: this line is indented with a tab; YAML takes spaces", 3},
      {"softkin: 1\nmesh: {file: a.msh\nvoid: [a, '[', b]\n\nfixed: []\n",
       "not valid YAML: the '{' here is never closed: a '}' is missing", 2},
      {"softkin: 1\nmesh: {file: a.msh]\n", "not valid YAML: the '{' here is closed by ']' in line 2", 2},
      {"softkin: 1\nmesh: {file: \"a.msh}\n# it's\nfixed: []\n",
       "not valid YAML: the quote \" that begins here is never closed", 2},
      {"softkin: 1\nmesh: {file: a.msh}\nmeshes: [{file: a.msh}]\n", "both 'mesh' and 'meshes'", 3},
      {"softkin: 1\nmeshes: []\n", "'meshes' is empty", 2},
      {"softkin: 1\nmeshes: [{name: a}]\n", "needs key 'file'", 2},
      {"softkin: 1\nmeshes: [{file: a.msh, scale: 0}]\n", "'scale' must be", 2},
      {"softkin: 1\nmeshes: [{file: a.msh, rotate: {axis: [0, 0, 0], degrees: 1}}]\n", "'axis' has no direction", 2},
      {"softkin: 1\nmeshes: [{file: a.msh, rotate: {axis: [0, 0, 1]}}]\n", "needs key 'degrees'", 2},
      {"softkin: 1\nmeshes:\n  - {name: a, file: a.msh}\n  - {name: a, file: a.msh}\n", "'a' is taken", 4},
      {"softkin: 1\nmeshes:\n  - {file: a.msh}\n  - {file: quadratic.msh}\n", "elements are of order 2, those", 4},
      {"softkin: 1\nmeshes:\n  - {file: a.msh, order: 2}\n  - {file: a.msh, order: 2, curve: true}\n",
       "must be the same in every entry", 4},
      {"softkin: 1\nmeshes:\n  - {file: a.msh}\n  - {file: a.msh, order: 2}\n", "must be the same in every entry", 4},
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
  expect_refused("softkin: 1\nmesh: " + std::string(3000, '[') + std::string(3000, ']'),
                 "lists and maps are nested too deeply", 2);
}

TEST(SceneRefusals, KeysAndUnits) {
  expect_all_refused({
      {"\nmarkerz: []\n", "unknown key 'markerz' in the scene; did you mean 'markers'?", 2},
      {"weather: 9.81\n", "unknown key 'weather' in the scene; known: softkin, units, mesh", 1},
      {"gravity: 9.81\n", "'gravity' must be a list, not '9.81'", 1},
      {"gravity: [0, 0, '-9,81']\n",
       "must be a finite number, not the quoted text '-9,81'; write a decimal point: -9.81", 1},
      {"materials:\n  - {youngs_modulus: 0,6, poisson_ratio: 0.4}\n",
       "unknown key '6' in entry 1 of 'materials'; a number is written with a decimal point, not a comma", 2},
      {"materials:\n  - youngs_modulus: 0,6\n    poisson_ratio: 0.4\n",
       "'youngs_modulus' must be a finite number, not '0,6'; write a decimal point: 0.6", 2},
      {"gravity: [0, -9.81]\n", "'gravity' must be a list of 3, not of 2", 1},
      {"gravity: [0, 0, down]\n", "entry 3 of 'gravity' must be a finite number, not 'down'", 1},
      {"gravity: [0, 0, .inf]\n", "entry 3 of 'gravity' must be a finite number", 1},
      {"<<: {void: []}\n", "unknown key '<<'", 1},
      {"units: {length: km}\n", "'length' must be one of 'mm', 'cm', 'm', 'um', 'in', not 'km'", 1},
      {"units: {lenght: m}\n", "did you mean 'length'?", 1},
      {"units: mm\n", "'units' must be a map", 1},
      {"formulation: fem\n", "'formulation' must be one of 'target-shape', 'physical', not 'fem'", 1},
      {"weights: even\n", "'weights' must be one of 'printed', 'mesh-independent', not 'even'", 1},
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
       "column 3 is requested, but the sidecar has 2, numbered from 1", 1},
      {"regions: [{name: a, sidecar: {file: tets.txt, column: 0}}]\n", "column 0 is requested", 1},
      {"regions: [{name: a, sidecar: {file: tets.txt, of: vertices}}]\n", "the sidecar has 2 rows", 1},
      {"regions: [{name: a, sidecar: {file: none.txt}}]\n", "none.txt: no such file", 1},
  });
  expect_refused("softkin: 1\nmesh: {file: square.msh}\nregions: [{name: a, sidecar: {file: vertices.txt}}]\n",
                 "say 'of: vertices' or 'of: elements' in 'sidecar'", 3);
}

TEST(SceneRefusals, MaterialsAndSupports) {
  expect_all_refused({
      {"materials: [{region: body}]\n",
       "entry 1 of 'materials' needs 'shape_ratio' (target-shape) or elastic constants (physical)", 1},
      {"materials: [{region: body, density: 1000, weight: 1}]\n", "needs 'shape_ratio' (target-shape) or elastic", 1},
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
      {"void: chamber\n", "'void' must be a list, not 'chamber'", 1},
      {"void:\n  - a\n  -\n", "entry 2 of 'void' must be a word, not empty", 2},
      {"fixed: [base]\n", "entry 1 of 'fixed' must be a map with keys 'region', 'box'", 1},
      {"fixed: [{axes: z}]\n", "entry 1 of 'fixed' needs one of 'region', 'box'", 1},
      {"fixed: [{region: a, axes: xx}]\n", "letters x, y, z, each at most once, not 'xx'", 1},
      {"fixed: [{region: a, axes: [x, y]}]\n", "'axes' must be a word, not a list", 1},
      {"fixed: [{region: a, elements: [1]}]\n", "unknown key 'elements'", 1},
      {"fixed: [{region: a, rotation: 90}]\n", "'rotation' must be a map with keys 'axis', 'degrees', 'about'", 1},
      {"fixed: [{region: a, rotation: {degrees: 90}}]\n", "'rotation' needs key 'axis'", 1},
      {"fixed:\n  - region: a\n    rotation:\n      axis: [0, 0, 0]\n", "'axis' has no direction", 4},
      {"fixed: [{region: a, rotation: {axis: [0, 0, 1], degrees: far}}]\n",
       "'degrees' must be a finite number, not 'far'", 1},
      {"fixed: [{region: a, rotation: {axis: [0, 0, 1], angle: 3}}]\n", "unknown key 'angle'", 1},
      {"rigid: [{region: a, box: [[0, 0, 0], [1, 1, 1]]}]\n", "has both 'region' and 'box'", 1},
      {"rigid: [[a]]\n", "entry 1 of 'rigid' must be a map", 1},
  });
}

TEST(SceneRefusals, ElasticConstants) {
  const std::vector<Refusal> refusals{
      {"law: neo", "'law' must be one of 'st-venant-kirchhoff', 'corotational', 'neo-hookean'", 0},
      {"law: neo-hookean", "law 'neo-hookean' needs key 'youngs_modulus'", 0},
      {"shape_ratio: 1, law: neo-hookean", "law 'neo-hookean' needs key 'youngs_modulus'", 0},
      {"youngs_modulus: 12", "law 'neo-hookean' (the default) needs key 'poisson_ratio'", 0},
      {"poisson_ratio: 0.4", "law 'neo-hookean' (the default) needs key 'youngs_modulus'", 0},
      {"law: corotational, youngs_modulus: 12", "law 'corotational' needs key 'poisson_ratio'", 0},
      {"youngs_modulus: 0, poisson_ratio: 0.4", "'youngs_modulus' must be greater than 0, not 0", 0},
      {"youngs_modulus: -3, poisson_ratio: 0.4", "'youngs_modulus' must be greater than 0, not -3", 0},
      {"youngs_modulus: nan, poisson_ratio: 0.4", "'youngs_modulus' must be a finite number", 0},
      {"youngs_modulus: 12 MPa, poisson_ratio: 0.4", "'youngs_modulus' must be a finite number, not '12 MPa'", 0},
      {"law: corotational, youngs_modulus: 1, poisson_ratio: 0.5",
       "is 0.5, which keeps the volume: take 'law: neo-hook", 0},
      {"youngs_modulus: 1, poisson_ratio: 0.5, elements: hybrid", "'elements' must be one of 'plain', 'mixed'", 0},
      {"youngs_modulus: 1, poisson_ratio: 0.51", "greater than -1 and at most 0.5, not 0.51", 0},
      {"youngs_modulus: 1, poisson_ratio: -1", "greater than -1 and at most 0.5, not -1", 0},
      {"youngs_modulus: 1, poisson_ratio: .nan", "'poisson_ratio' must be a finite number", 0},
      {"youngs_modulus: 1, poisson_ratio: 0.3, c10: 1",
       "key 'c10' does not belong to law 'neo-hookean' (the default), which takes 'youngs_modulus', 'poisson_ratio'",
       0},
      {"c10: 1", "key 'c10' does not belong to law 'neo-hookean' (the default)", 0},
      {"law: corotational, youngs_modulus: 1, poisson_ratio: 0.3, bulk_modulus: 1",
       "key 'bulk_modulus' does not belong to law 'corotational'", 0},
      {"law: st-venant-kirchhoff, youngs_modulus: 1, poisson_ratio: 0.3, c30: 1",
       "key 'c30' does not belong to law 'st-venant-kirchhoff'", 0},
      {"law: mooney-rivlin, c10: 1, c20: 1, bulk_modulus: 1",
       "key 'c20' does not belong to law 'mooney-rivlin', which takes 'c10', 'c01', 'bulk_modulus', 'poisson_ratio'",
       0},
      {"law: mooney-rivlin, youngs_modulus: 1", "key 'youngs_modulus' does not belong to law 'mooney-rivlin'", 0},
      {"law: mooney-rivlin, c01: 1, bulk_modulus: 1", "law 'mooney-rivlin' needs key 'c10'", 0},
      {"law: mooney-rivlin, c10: 1", "needs one of 'bulk_modulus', 'poisson_ratio'", 0},
      {"law: mooney-rivlin, c10: 1, bulk_modulus: 1, poisson_ratio: 0.4", "has both 'bulk_modulus' and 'poisson_ratio'",
       0},
      {"law: mooney-rivlin, c10: 1, bulk_modulus: 0", "'bulk_modulus' must be greater than 0", 0},
      {"law: mooney-rivlin, c10: 0.1, c01: -0.1, bulk_modulus: 1", "'c10' + 'c01' must be greater than 0", 0},
      {"law: st-venant-kirchhoff, youngs_modulus: 1, poisson_ratio: 0.5", "keeps the volume", 0},
      {"law: yeoh, c10: 1, c01: 1, bulk_modulus: 1", "key 'c01' does not belong to law 'yeoh'", 0},
      {"law: yeoh, c10: -1, bulk_modulus: 1", "'c10' must be greater than 0", 0},
      {"law: yeoh, c10: 1, c20: soft, bulk_modulus: 1", "'c20' must be a finite number, not 'soft'", 0},
      {"law: yeoh, c20: 1, bulk_modulus: 1", "law 'yeoh' needs key 'c10'", 0},
      {"law: yeoh, c10: 1", "needs one of 'bulk_modulus', 'poisson_ratio'", 0},
      {"law: gent, shear_modulus: 1, poisson_ratio: 0.4", "law 'gent' needs key 'jm'", 0},
      {"law: ogdne, mu1: 1, alpha1: 2, poisson_ratio: 0.4", "'yeoh', 'gent', 'ogden', not 'ogdne'", 0},
      {"law: marlow, curve: 1", "'law' must be one of", 0},  // not of its keys, which go with a law that is not there
      {"law: ogden, mu1: 1, poisson_ratio: 0.4", "law 'ogden' needs key 'alpha1'", 0},
      {"law: ogden, mu1: 1, alpha1: 2, mu2: 1, poisson_ratio: 0.4", "needs 'mu2' and 'alpha2' together", 0},
      {"law: ogden, mu1: 1, alpha1: 0, poisson_ratio: 0.4", "'alpha1' must not be 0", 0},
      {"law: ogden, mu1: 1, alpha1: -2, poisson_ratio: 0.4", "must be greater than 0, not -1 MPa", 0},
      {"law: ogden, mu1: 1, alpha1: 2", "needs one of 'bulk_modulus', 'poisson_ratio'", 0},
      {"law: ogden, mu1: 1, alpha1: 2, c10: 3, bulk_modulus: 3", "key 'c10' does not belong to law 'ogden'", 0},
      {"set: yeoh, youngs_modulus: 1, poisson_ratio: 0.4", "goes with 'material'", 0},
      {"law: gent, jm: 20, poisson_ratio: 0.4", "law 'gent' needs key 'shear_modulus'", 0},
      {"law: gent, shear_modulus: 1, jm: 0, poisson_ratio: 0.4", "'jm' must be greater than 0, not 0", 0},
      {"law: gent, shear_modulus: -1, jm: 9, poisson_ratio: 0.4", "'shear_modulus' must be greater than 0, not -1", 0},
      {"law: gent, shear_modulus: 1, jm: 9", "needs one of 'bulk_modulus', 'poisson_ratio'", 0},
      {"law: gent, c10: 1, shear_modulus: 1, jm: 9, bulk_modulus: 3", "key 'c10' does not belong to law 'gent'", 0},
      {"law: yeoh, c10: 1, jm: 9, bulk_modulus: 3", "key 'jm' does not belong to law 'yeoh'", 0},
      {"shape_ratio: 1, permittivity: 0.5", "'permittivity' is over that of the vacuum and must be 1 or more, not 0.5",
       0},
      {"shape_ratio: 1, permittivity: nan", "'permittivity' must be a finite number", 0},
      {"shape_ratio: 1, density: -1", "'density' must not be negative: -1", 0},
      {"shape_ratio: 1, density: inf", "'density' must be a finite number", 0},
      {"shape_ratio: 1, young_modulus: 1", "did you mean 'youngs_modulus'?", 0},
  };
  for (const Refusal& each : refusals)
    expect_refused("softkin: 1\nmesh: {file: a.msh}\nmaterials:\n  - {region: a, shape_ratio: 1}\n  - {" +
                       std::string(each.text) + "}\n",
                   each.fragment, 5);
}

TEST(SceneRefusals, LoadsAndForces) {
  const std::vector<Refusal> refusals{
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [2, -2], control: pressure}]", "2 is above -2", 4},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [-1, inf], control: pressure}]", "finite number", 4},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [0, 1], control: volume}]",
       "entry 1 of 'range' must be greater than 0, not 0", 4},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], [1, 0, 0]], range: [-1, 9], control: tension}]",
       "entry 1 of 'range' must not be negative, since a cable only pulls: -1", 4},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], control: tension}]",
       "control of kind 'pneumatic' must be one of 'volume', 'pressure', 'gas', 'liquid', not 'tension'", 4},
      {"actuators: [{name: a, kind: dea, region: r, range: [1, 2], control: pressure}]",
       "control of kind 'dea' must be one of 'area', 'voltage', not 'pressure'", 4},
      {"actuators: [{name: a, kind: dea, region: r, range: [-1, 2], control: voltage}]",
       "entry 1 of 'range' must not be negative, since either sign of a voltage does the same: -1", 4},
      {"actuators: [{name: a, kind: dea, region: r, range: [0, 2], control: voltage, prestretch: 0}]",
       "'prestretch' must be greater than 0, not 0", 4},
      {"actuators: [{name: a, kind: dea, region: r, range: [0, 2], control: voltage, curve: skin.yaml}]",
       "'curve' turns a voltage into an area, but the voltage itself is controlled here", 4},
      {"actuators: [{name: a, kind: dea, region: r, range: [1, 2], voltage_share: share.csv}]",
       "'voltage_share' belongs to 'control: voltage'", 4},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], [1, 0, 0]], range: [0, 2], voltage_share: share.csv}]",
       "key 'voltage_share' does not belong to kind 'cable'", 4},
      {"forces: [{name: f, region: tip}]", "entry 1 of 'forces' needs key 'force'", 4},
      {"forces: [{name: f, region: tip, range: [0, 1]}]", "must be a list of 3", 4},
      {"forces: [{name: f, region: tip, range: [[0, 1], [0, 1], [0, 1, 2]]}]", "must be a list of 2", 4},
      {"sensors: [{name: s, kind: length}]", "entry 1 of 'sensors' needs key 'points'", 4},
      {"sensors: [{name: s, kind: strain}]", "'kind' must be one of 'length', 'angle', 'direction'", 4},
      {"sensors: [{name: s, kind: direction, axis: [1, 0, 0]}]", "needs key 'region'", 4},
      {"sensors: [{name: s, kind: direction, regions: [a, b], axis: [1, 0, 0]}]",
       "'regions' is not of a sensor of kind 'direction'", 4},
      {"tractions: [{name: a, region: b, traction: [1, 0, 0], range: [0, 1]}]",
       "a pressure can have a range, a traction cannot", 4},
      {"tractions: [{name: a, region: b}]", "'traction', 'pressure'", 4},
      {"sensors: [{name: s, kind: angle, regions: [a, b]}]", "needs key 'axis'", 4},
      {"sensors: [{name: s, kind: angle, regions: [a, b], axis: [0, 0, 0]}]", "'axis' has no direction", 4},
      {"sensors: [{name: s, kind: length, points: [[0, 0, 0], [1, 0, 0]], axis: [0, 0, 1]}]",
       "'axis' is not of a sensor of kind 'length'", 4},
      {"forces: [{name: f, force: [0, 0, 1]}]", "needs one of 'point', 'region'", 4},
      {"forces: [{region: tip, force: [0, 0, 1]}]", "needs key 'name'", 4},
      {"forces: [{name: f, region: a, point: [0, 0, 0], force: [0, 0, 1]}]", "has both 'region' and 'point'", 4},
      {"forces: [{name: f, region: tip, force: 3}]", "'force' must be a list, not '3'", 4},
      {"forces: [{name: f, region: tip, force: [0, 0, nan]}]", "must be a finite number, not 'nan'", 4},
      {"forces:\n  - {name: f, region: a, force: [0, 0, 1]}\n  - {name: f, region: b, force: [0, 0, 1]}",
       "the name 'f' is taken; it is given in line 5", 6},
  };
  for (const Refusal& each : refusals)
    expect_refused("softkin: 1\nmesh: {file: a.msh}\nformulation: physical\n" + std::string(each.text) + "\n",
                   each.fragment, each.line);
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
       "must be one of 'least-norm', 'uniform', 'proportional', not 'even'", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], prestretch: 1}]\n",
       "key 'prestretch' does not belong to kind 'pneumatic'", 1},
      {"actuators: [{name: a, kind: cable, region: r, range: [1, 2]}]\n",
       "key 'region' does not belong to kind 'cable'", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: {unit: mm}, range: [1, 2]}]\n", "needs one of 'file', 'region'",
       1},
      {"actuators: [{name: a, kind: pneumatic, surface: {file: s.stl, unit: yd}, range: [1, 2]}]\n",
       "'unit' must be one of 'mm'", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: {region: w, unit: mm}, range: [1, 2]}]\n",
       "a region has the mesh's", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, surface: s.stl, range: [1, 2]}]\n", "has both 'region'", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: {region: w, move: [1, 0, 0]}, range: [1, 2]}]\n",
       "'move' is that of a file", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: {file: s.stl, moved: [1, 0, 0]}, range: [1, 2]}]\n",
       "did you mean 'move'", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: {file: s.stl, rotate: {axis: [0, 0, 0], degrees: 1}}, "
       "range: [1, 2]}]\n",
       "'axis' has no direction", 1},
      {"actuators: [{name: a, kind: pneumatic, void_at: [1, 2, 3], surface: s.stl, range: [1, 2]}]\n", "has both", 1},
      {"actuators: [{name: a, kind: pneumatic, void_at: [1, 2], range: [1, 2]}]\n", "must be a list of 3", 1},
      {"actuators: [{name: a, kind: cable, void_at: [1, 2, 3], range: [1, 2]}]\n",
       "key 'void_at' does not belong to kind 'cable'", 1},
      {"regions: [{name: n, inside: s.stl}]\n", "needs a closed surface", 1},
      {"regions: [{name: n, insid: closed.stl}]\n", "did you mean 'inside'", 1},
      {"regions: [{name: n, inside: {file: closed.stl, region: a}}]\n", "unknown key 'region'", 1},
      {"actuators: [{name: a, kind: pneumatic, surface: s.ply, range: [1, 2]}]\n", "s.ply:7: no facet", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], control: pressure}]\n",
       "control 'pressure' belongs to the physical formulation", 1},
      {"formulation: target-shape\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\nactuators:\n  - name: a\n"
       "    kind: pneumatic\n    region: r\n    range: [1, 2]\n    control: pressure\n",
       "control 'pressure' belongs to the physical formulation", 8},
      {"actuators: [{name: a, kind: cable, points: [[0, 0, 0], [1, 0, 0]], range: [0.5, 1], control: tension}]\n",
       "control 'tension' belongs to the physical formulation", 1},
      {"actuators: [{name: a, kind: pneumatic, region: r, range: [1, 2], control: length}]\n",
       "control of kind 'pneumatic' must be one of 'volume', 'pressure', 'gas', 'liquid', not 'length'", 1},
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
      {"markers: [{name: m, point: [0, 0, 0], offset: [0, 0, 1]}]\n", "which the marker has not", 1},
      {"markers: [{name: m, region: r, point: [0, 0, 0], offset: [0, 0, 1]}]\n", "not both", 1},
      {"markers: [{name: m, point: {x: 1}}]\n", "'point' must be a list, not a map", 1},
      {"markers: [{name: '', point: [0, 0, 0]}]\n", "'name' is empty", 1},
      {"markers:\n  - name: m\n    name: n\n    point: [0, 0, 0]\n", "key 'name' appears twice", 3},
      {"units: {length: m}\nmarkers: [{name: m, point: [1e308, 0, 0]}]\n", "is too large: 1e308", 2},
      {"feet: [{marker: a, forward: 1, backward: 1}]\n", "'feet' must be a list of 2, not of 1", 1},
      {"feet:\n  - {marker: a, forward: 1, backward: 1}\n  - {marker: b, forward: -1, backward: 1}\n",
       "'forward' must be 0 N or more, not -1", 3},
      {"feet: [{marker: a, forward: 1}, {marker: b, forward: 1, backward: 1}]\n", "needs key 'backward'", 1},
      {"feet: [{marker: a, forwards: 1}, {marker: b}]\n", "did you mean 'forward'?", 1},
  });
}

}  // namespace
}  // namespace softkin
