#include "calculix.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <softkin/model/mesh/boundary.hpp>
#include <sstream>

namespace softkin::bench {

namespace {

/// Faces 1 to 4 of C3D4 and C3D10 by the corners of the element.
constexpr int calculix_faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

std::array<Index, 3> sorted(std::array<Index, 3> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// In mm, mN and kPa: ccx takes a residual below 1e-6 for none, which in N ends it too early.
class Deck {
 public:
  Deck(const std::string& path, const Model& model) : file_(std::fopen(path.c_str(), "w")), model_(model) {
    if (!file_) throw InvalidInput({.file = path}, "cannot be written");
  }

  void write(const CalculixTask& task) {
    write_mesh();
    const ElasticLaw& law = model_.materials[0].elastic;
    const double poisson = law.lambda / (2 * (law.lambda + law.mu));
    put("*MATERIAL, NAME=RUBBER\n*ELASTIC\n%.17g, %.17g\n*SOLID SECTION, ELSET=BODY, MATERIAL=RUBBER\n",
        1000 * 2 * law.mu * (1 + poisson), poisson);
    put("*BOUNDARY\nHELD, 1, 3\n*STEP, NLGEOM, INC=100000\n*STATIC\n%g, 1, 1e-8\n", task.first_step);
    // its iteration on follower loads converges linearly: it needs more iterations than the default allows
    put("*CONTROLS, PARAMETERS=TIME INCREMENTATION\n30, 60, 100, 200, 60, 30, , 20\n");
    put("*CONTROLS, PARAMETERS=FIELD\n%g, %g, , , %g, , %g\n", task.residual, task.correction, task.residual,
        task.correction / 10);
    write_pressure(task.pressure_kpa);
    put("*NODE PRINT, NSET=TIP, FREQUENCY=1\nU\n*END STEP\n");
    if (std::ferror(file_.get()) != 0) throw InvalidInput("the deck for CalculiX could not be written");
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  template <class... Values>
  void put(const char* format, Values... values) {
    if constexpr (sizeof...(values) == 0)
      std::fputs(format, file_.get());
    else
      std::fprintf(file_.get(), format, values...);
  }

  void write_mesh() {
    put("*NODE, NSET=ALL\n");
    for (Index v = 0; v < model_.rest.rows(); ++v)
      if (model_.used[v])
        put("%d, %.17g, %.17g, %.17g\n", v + 1, model_.rest(v, 0), model_.rest(v, 1), model_.rest(v, 2));
    const bool quadratic = !model_.edge_nodes.empty();
    put("*ELEMENT, TYPE=%s, ELSET=BODY\n", quadratic ? "C3D10" : "C3D4");
    for (std::size_t e = 0; e < model_.tetrahedra.size(); ++e) {
      put("%zu", e + 1);
      for (const Index v : model_.tetrahedra[e]) put(", %d", v + 1);
      if (quadratic)
        for (const Index v : model_.edge_nodes[e]) put(", %d", v + 1);
      put("\n");
    }
    put("*NSET, NSET=HELD\n");
    for (Index v = 0; v < model_.rest.rows(); ++v)
      if (model_.used[v] && model_.fixed[v][0]) put("%d,\n", v + 1);
    put("*NSET, NSET=TIP\n");
    for (const Index v : model_.markers[0].point.vertices) put("%d,\n", v + 1);
  }

  void write_pressure(double pressure) {
    std::map<std::array<Index, 3>, bool> walls;
    for (const CavityFace& face : model_.actuators[0].cavity) walls[sorted(face.corners)] = false;
    put("*DLOAD\n");
    for (std::size_t e = 0; e < model_.tetrahedra.size(); ++e)
      for (int f = 0; f < 4; ++f) {
        const Tetrahedron& t = model_.tetrahedra[e];
        const auto wall =
            walls.find(sorted({t[calculix_faces[f][0]], t[calculix_faces[f][1]], t[calculix_faces[f][2]]}));
        if (wall == walls.end()) continue;
        wall->second = true;
        put("%zu, P%d, %.17g\n", e + 1, f + 1, pressure);
      }
    for (const auto& [face, found] : walls)
      if (!found) throw InvalidInput("a wall of the chamber belongs to no element of the body");
  }

  std::unique_ptr<std::FILE, Close> file_;
  const Model& model_;
};

/// Rows of numbers below the last heading of a .dat file: vertex, then three displacements.
std::map<Index, Vec3> last_displacements(const std::string& path, double& time) {
  std::ifstream file(path);
  std::map<Index, Vec3> rows;
  for (std::string line; std::getline(file, line);) {
    const std::size_t at = line.find("and time");
    if (at != std::string::npos) {
      rows.clear();
      time = std::strtod(line.c_str() + at + 8, nullptr);
    }
    std::istringstream words(line);
    Index vertex = 0;
    Vec3 u;
    if (words >> vertex >> u[0] >> u[1] >> u[2]) rows[vertex - 1] = u;
  }
  return rows;
}

int count_iterations(const std::string& path) {
  std::ifstream file(path);
  int count = 0;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    int step = 0;
    if (words >> step) ++count;
  }
  return count;
}

}  // namespace

void write_calculix_deck(const std::string& path, const Model& model, const CalculixTask& task) {
  if (model.formulation != Formulation::physical || !model.prisms.empty() || model.materials.size() != 1 ||
      model.actuators.empty() || model.markers.empty() || model.materials[0].elastic.law != Law::st_venant_kirchhoff)
    throw InvalidInput({.file = path},
                       "a deck is for tetrahedra of one St. Venant-Kirchhoff material with a chamber and a marker");
  Deck(path, model).write(task);
}

CalculixResult read_calculix_result(const std::string& stem, const std::vector<Index>& vertices,
                                    const std::vector<double>& weights) {
  CalculixResult result;
  double time = 0;
  const std::map<Index, Vec3> rows = last_displacements(stem + ".dat", time);
  result.iterations = count_iterations(stem + ".cvg");
  result.finished = time > 1 - 1e-9;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto row = rows.find(vertices[i]);
    if (row == rows.end())
      result.finished = false;
    else
      result.tip += weights[i] * row->second;
  }
  return result;
}

}  // namespace softkin::bench
