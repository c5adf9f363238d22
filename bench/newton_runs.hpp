#pragma once

#include <array>
#include <softkin/model/model.hpp>
#include <string>
#include <vector>

#include "child_process.hpp"
#include "finger.hpp"

namespace softkin::bench {

/// Which finger: one of bellows_finger's sizes, or the mesh of a file.
struct FingerSource {
  double cell_mm = 0;
  std::string file;              // "": bellows_finger(cell_mm)
  double chamber_weight = 0.05;  // target-shape: w of the chamber's elements

  [[nodiscard]] Mesh mesh() const;
  [[nodiscard]] std::string name() const;
  [[nodiscard]] RobotSpec robot(FingerKind kind) const;
};

constexpr int max_bends = 8;
constexpr int max_marker_vertices = 10;

/// A bent shape as the solvers are to reach it.
struct Target {
  double degrees = 0, ratio = 0, pressure_kpa = 0;
  double tip[3] = {};  // [mm]
};

/// Results for a finger of Newton's method, run until it converges. Plain, to be sent between processes.
struct Answers {
  int body_tetrahedra = 0, vertices = 0, unknowns = 0;
  int count = 0;  // number of targets; fewer than requested where the finger does not bend that far
  Target targets[max_bends];
  double farthest_degrees = 0;  // bend of the last
  int marker_vertices = 0;
  Index marker_vertex[max_marker_vertices] = {};
  double marker_weight[max_marker_vertices] = {};
  double marker_rest[3] = {};  // [mm]
  double seconds = 0;
};

/// angles  ascending [degrees], at most max_bends
[[nodiscard]] Measured<Answers> find_answers(const FingerSource& source, FingerKind kind,
                                             const std::vector<double>& angles, int threads, double limit);

struct RunOptions {
  double tip_error_mm = 0.1;
  double limit = 600;  // [s]
  int threads = 0;     // 0: all
};

/// One run from rest to a target. Plain.
struct Run {
  bool done = false;  // the tip is within the requested error
  double setup = 0;   // from the mesh to a solver that is ready [s]
  double solve = 0;   // [s]
  int iterations = 0, factorisations = 0;
  double tip_error = 0;  // of the last shape [mm]
  bool out_of_time = false;

  [[nodiscard]] double seconds() const { return setup + solve; }
};

/// Runs Newton's method with the coarsest step tolerance that the requested error allows.
[[nodiscard]] Measured<Run> run_newton(const FingerSource& source, FingerKind kind, const Target& target,
                                       const RunOptions& options);

/// Runs Algorithm 1 with Anderson acceleration over `anderson` steps (0: as printed). Its time ends when the tip stays
/// within the error; the run continues until the error is a tenth of that.
[[nodiscard]] Measured<Run> run_local_global(const FingerSource& source, const Target& target, int anderson,
                                             const RunOptions& options);

/// CalculiX, from an empty folder, with ever tighter *CONTROLS until its tip is within the error; the time is that of
/// the last run alone.
struct CalculixRun {
  Run run;
  double peak_mib = 0;
  double residual = 0, correction = 0;  // *CONTROLS of the last run
  std::string complaint;                // why it is not done
};
[[nodiscard]] CalculixRun run_calculix(const FingerSource& source, FingerKind kind, const Answers& answers,
                                       const Target& target, const std::string& folder, int threads,
                                       const RunOptions& options);

/// CalculiX as a peer: the same mesh, material and pressure, geometrically nonlinear.
struct CalculixTask {
  double pressure_kpa = 0;   // on the walls of chamber 0, in the current shape
  double residual = 5e-3;    // *CONTROLS, FIELD: R_n and R_p, of the average force
  double correction = 1e-2;  // C_n, of the increment
  double first_step = 0.05;  // of the load
};

/// Writes NAME.inp: body elements (C3D4 or C3D10), held vertices, St. Venant-Kirchhoff material (*ELASTIC with NLGEOM),
/// pressure on the faces of actuator 0's cavity (*DLOAD, which follows them), and the displacements of the vertices of
/// marker 0 after every increment.
///
/// model   physical, of tetrahedra and one material without prisms; fixed in all axes where it is
/// throws  InvalidInput where the model is not such a one or the file cannot be written
void write_calculix_deck(const std::string& path, const Model& model, const CalculixTask& task);

struct CalculixResult {
  bool finished = false;  // the whole pressure was reached
  int iterations = 0;
  Vec3 tip{0, 0, 0};  // displacement of marker 0 [mm]
};

/// Reads what ccx left of a run of NAME.inp: NAME.dat and NAME.cvg.
[[nodiscard]] CalculixResult read_calculix_result(const std::string& stem, const std::vector<Index>& vertices,
                                                  const std::vector<double>& weights);

}  // namespace softkin::bench
