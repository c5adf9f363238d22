#pragma once

#include <softkin/model/model.hpp>
#include <string>

#include "child_process.hpp"

namespace softkin::bench {

/// CalculiX as a peer: the same mesh, material and pressure, geometrically nonlinear.
struct CalculixTask {
  double pressure_kpa = 0;   // on the walls of chamber 0, in the current shape
  double residual = 5e-3;    // *CONTROLS, FIELD: R_n and R_p, of the average force
  double correction = 1e-2;  // C_n, of the increment
  double first_step = 0.05;  // of the load
};

/// Writes NAME.inp: body elements (C3D4 or C3D10), held vertices, St. Venant-Kirchhoff material (*ELASTIC with NLGEOM),
/// pressure on the faces of actuator 0's cavity (*DLOAD, which follows them), and the displacements of the vertices of
/// marker 0 at the end.
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
