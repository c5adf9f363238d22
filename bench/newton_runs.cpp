#include "newton_runs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <softkin/io/mesh/mesh_io.hpp>
#include <softkin/model/mesh/boundary.hpp>
#include <softkin/statics/statics.hpp>
#include <softkin/statics/target_shape/local_global.hpp>
#include <sstream>

#include "machine.hpp"

namespace softkin::bench {

namespace {

/// Beyond its own limit a process has this long to come to an end.
constexpr double grace = 120;  // [s]

Vec3 vector_of(const double (&values)[3]) {
  return {values[0], values[1], values[2]};
}

void store(const Vec3& vector, double (&values)[3]) {
  std::copy(vector.begin(), vector.end(), values);
}

Answers answer(const FingerSource& source, FingerKind kind, const std::vector<double>& angles, int threads) {
  const double begin = now();
  const RobotSpec spec = source.robot(kind);
  const Model model = compile(spec);
  const Statics statics(model);
  StaticsOptions options;
  options.threads = threads;
  options.keep_history = false;
  Answers answers;
  const Index chamber = kind == FingerKind::target_shape
                            ? static_cast<Index>(model.actuators[0].as<ChamberDrive>()->tetrahedra.size())
                            : 0;
  answers.body_tetrahedra = static_cast<int>(model.elements.tetrahedra.size()) - chamber;
  for (Index v = 0; v < model.rest.rows(); ++v) {
    if (!model.elements.used[v]) continue;
    ++answers.vertices;
    for (const bool fixed : model.held.fixed[v]) answers.unknowns += fixed ? 0 : 1;
  }
  for (const BentShape& shape : find_bends(model, statics, tip_face(spec.mesh, source.name()), angles, options)) {
    Target& target = answers.targets[answers.count++];
    target.degrees = shape.degrees;
    target.ratio = shape.ratio;
    target.pressure_kpa = shape.pressure;
    store(shape.tip, target.tip);
    answers.farthest_degrees = shape.degrees;
  }
  const EmbeddedPoint& marker = model.markers[0].point;
  answers.marker_vertices = std::min<int>(max_marker_vertices, static_cast<int>(marker.vertices.size()));
  for (int i = 0; i < answers.marker_vertices; ++i) {
    answers.marker_vertex[i] = marker.vertices[i];
    answers.marker_weight[i] = marker.weights[i];
  }
  store(marker.at(model.rest), answers.marker_rest);
  answers.seconds = now() - begin;
  return answers;
}

Run newton(const FingerSource& source, FingerKind kind, const Target& target, const RunOptions& options) {
  const RobotSpec spec = source.robot(kind);
  Run run;
  double begin = now();
  const double end = begin + options.limit;
  const Model model = compile(spec);
  const Statics statics(model);
  run.setup = now() - begin;
  StaticsOptions statics_options;
  statics_options.threads = options.threads;
  statics_options.keep_history = false;
  const ProgressCallback in_time = [&](const Progress&) { return now() < end; };
  for (double tolerance = options.tip_error_mm; !run.done && tolerance > 1e-9; tolerance /= 10) {
    statics_options.step_tolerance_mm = tolerance;
    begin = now();
    const Equilibrium found =
        statics.solve(Actuation::Constant(1, target.ratio), statics.rest(), statics_options, in_time);
    run.solve = now() - begin;
    run.iterations = found.report.iterations;
    run.factorisations = found.report.factorisations;
    run.tip_error = (model.markers[0].point.at(found.state.positions) - vector_of(target.tip)).norm();
    run.out_of_time = found.report.status == Status::interrupted;
    if (found.report.status != Status::converged) break;
    run.done = run.tip_error <= options.tip_error_mm;
  }
  return run;
}

Run local_global(const FingerSource& source, const Target& target, int anderson, const RunOptions& options) {
  const RobotSpec spec = source.robot(FingerKind::target_shape);
  const double begin = now();
  const Model model = compile(spec);
  const target_shape::System system(model);
  const supports::GlobalStep global(model, system.global_matrix());
  Team team(options.threads);
  Run run;
  run.setup = now() - begin;
  const double start = now(), rounding = 1e-13 * model.diagonal_mm;
  const Actuation actuation = Actuation::Constant(1, target.ratio);
  const Vec3 tip = vector_of(target.tip);
  Points positions = model.rest;
  target_shape::LocalGlobal iteration(system, global, anderson, actuation, positions);
  target_shape::System::Scratch scratch = system.make_scratch();
  for (int count = 1;; ++count) {
    IterationRecord record;
    if (!iteration.iterate(scratch, team, record)) break;
    const double time = now() - start;
    run.tip_error = (model.markers[0].point.at(iteration.positions()) - tip).norm();
    const bool inside = run.tip_error <= options.tip_error_mm;
    if (!inside || !run.done) {
      run.solve = time;
      run.iterations = count;
    }
    run.done = inside;
    if (run.tip_error <= options.tip_error_mm / 10 || record.step_mm < rounding) break;
    run.out_of_time = run.setup + time > options.limit;
    if (run.out_of_time) break;
    iteration.extrapolate();
  }
  return run;
}

/// How often CalculiX may try with tighter *CONTROLS.
constexpr int max_attempts = 8;

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
    const ElasticLaw& law = model_.elements.materials[0].elastic;
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
      if (model_.elements.used[v])
        put("%d, %.17g, %.17g, %.17g\n", v + 1, model_.rest(v, 0), model_.rest(v, 1), model_.rest(v, 2));
    const bool quadratic = !model_.elements.edge_nodes.empty();
    put("*ELEMENT, TYPE=%s, ELSET=BODY\n", quadratic ? "C3D10" : "C3D4");
    for (std::size_t e = 0; e < model_.elements.tetrahedra.size(); ++e) {
      put("%zu", e + 1);
      for (const Index v : model_.elements.tetrahedra[e]) put(", %d", v + 1);
      if (quadratic)
        for (const Index v : model_.elements.edge_nodes[e]) put(", %d", v + 1);
      put("\n");
    }
    put("*NSET, NSET=HELD\n");
    for (Index v = 0; v < model_.rest.rows(); ++v)
      if (model_.elements.used[v] && model_.held.fixed[v][0]) put("%d,\n", v + 1);
    put("*NSET, NSET=TIP\n");
    for (const Index v : model_.markers[0].point.vertices) put("%d,\n", v + 1);
  }

  void write_pressure(double pressure) {
    std::map<std::array<Index, 3>, bool> walls;
    for (const CavityFace& face : model_.actuators[0].as<ChamberDrive>()->cavity) walls[sorted(face.corners)] = false;
    put("*DLOAD\n");
    for (std::size_t e = 0; e < model_.elements.tetrahedra.size(); ++e)
      for (int f = 0; f < 4; ++f) {
        const Tetrahedron& t = model_.elements.tetrahedra[e];
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

Mesh FingerSource::mesh() const {
  return file.empty() ? bellows_finger(cell_mm) : read_mesh(file);
}

std::string FingerSource::name() const {
  return file.empty() ? "bellows finger" : std::filesystem::path(file).filename().string();
}

RobotSpec FingerSource::robot(FingerKind kind) const {
  RobotSpec spec = finger_robot(mesh(), kind, name());
  spec.actuators[0].weight = chamber_weight;
  return spec;
}

Measured<Answers> find_answers(const FingerSource& source, FingerKind kind, const std::vector<double>& angles,
                               int threads, double limit) {
  if (angles.size() > max_bends) throw InvalidInput("at most 8 angles of bend");
  return measure<Answers>([&] { return answer(source, kind, angles, threads); }, limit);
}

Measured<Run> run_newton(const FingerSource& source, FingerKind kind, const Target& target, const RunOptions& options) {
  return measure<Run>([&] { return newton(source, kind, target, options); }, options.limit + grace);
}

Measured<Run> run_local_global(const FingerSource& source, const Target& target, int anderson,
                               const RunOptions& options) {
  return measure<Run>([&] { return local_global(source, target, anderson, options); }, options.limit + grace);
}

CalculixRun run_calculix(const FingerSource& source, FingerKind kind, const Answers& answers, const Target& target,
                         const std::string& folder, int threads, const RunOptions& options) {
  const std::string stem = (std::filesystem::path(folder) / "finger").string();
  const std::vector<Index> vertices(answers.marker_vertex, answers.marker_vertex + answers.marker_vertices);
  const std::vector<double> weights(answers.marker_weight, answers.marker_weight + answers.marker_vertices);
  const std::string count = std::to_string(threads);
  CalculixRun result;
  CalculixTask task;
  task.pressure_kpa = target.pressure_kpa;
  for (int attempt = 0; attempt < max_attempts; ++attempt) {
    result.residual = task.residual;
    result.correction = task.correction;
    for (const char* ending : {".dat", ".cvg"}) std::filesystem::remove(stem + ending);
    // the deck is written by a process of its own: this one is to stay small
    const auto written = measure<int>(
        [&] {
          write_calculix_deck(stem + ".inp", compile(source.robot(kind)), task);
          return 1;
        },
        grace + options.limit);
    if (!written.result) {
      result.complaint = "its deck could not be written: " + written.end.complaint();
      return result;
    }
    const ProcessEnd end = run_program({"ccx", "-i", "finger"}, folder, "ccx.log",
                                       {"OMP_NUM_THREADS=" + count, "CCX_NPROC_EQUATION_SOLVER=" + count,
                                        "CCX_NPROC_RESULTS=" + count, "NUMBER_OF_PROCESSORS=" + count},
                                       options.limit);
    const CalculixResult found = read_calculix_result(stem, vertices, weights);
    result.peak_mib = end.peak_mib;
    result.run.solve = end.seconds;
    result.run.iterations = result.run.factorisations = found.iterations;
    result.run.out_of_time = end.timed_out;
    result.run.tip_error = (vector_of(answers.marker_rest) + found.tip - vector_of(target.tip)).norm();
    result.run.done = end.good() && found.finished && result.run.tip_error <= options.tip_error_mm;
    if (result.run.done) return result;
    if (!end.good() || !found.finished) {
      result.complaint = end.good() ? "it gave up before the whole pressure" : end.complaint();
      return result;
    }
    // no tighter than it takes: its iteration converges linearly, and the error with the tolerance
    const double tighter = std::clamp(0.7 * options.tip_error_mm / result.run.tip_error, 0.01, 0.5);
    task.residual *= tighter;
    task.correction *= tighter;
  }
  result.complaint =
      "its tip is too far away after " + std::to_string(max_attempts) + " runs with ever tighter controls";
  return result;
}

void write_calculix_deck(const std::string& path, const Model& model, const CalculixTask& task) {
  if (model.formulation != Formulation::physical || !model.elements.prisms.empty() ||
      model.elements.materials.size() != 1 || model.actuators.empty() || model.markers.empty() ||
      model.elements.materials[0].elastic.law != Law::st_venant_kirchhoff)
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
