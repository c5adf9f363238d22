#pragma once

#include <functional>
#include <softkin/model/measurements.hpp>
#include <softkin/model/mesh/mesh.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin::calibration {

class TestLog;

/// A bar of two materials along x, from 0 to length; its axis is y = z = 0.
struct BarShape {
  double length_mm = 100, interface_mm = 50, width_mm = 20,
         height_mm = 10;  // length along x; where B begins; sides of the cross-section
  int cells = 3;          // across the height, >= 1; the other edges are as near to this cell's as whole numbers allow
};

/// Linear tetrahedra, five to a cell, mirrored from cell to cell. Regions: volumes A (x < interface) and B, surfaces
/// base (x = 0), interface and free_end (x = length).
///
/// throws  InvalidInput on sizes that are not > 0, an interface that is not inside, fewer than one cell, or more than
///         a million tetrahedra
[[nodiscard]] Mesh bar_mesh(const BarShape& shape);

/// How both ends are held: not at all across the bar (sliding), or as in the jaws of a testing machine (clamped).
enum class Grip { clamped, sliding };

/// What the simulated specimens have in common.
struct SpecimenOptions {
  double width_mm = 20, height_mm = 10;  // of the cross-section, > 0
  int cells = 0;                         // of the mesh across the height, >= 1; 0: 3 physical, 4 target-shape
  Grip grip = Grip::clamped;             // of stretched specimens; twisted ones are clamped
  Law law = Law::neo_hookean;            // physical: one that takes E and nu
  double poisson_ratio = 0.45;           // physical, of both materials [-], -1 < nu < 0.5
  double stiffer_shape_ratio = 1;        // target-shape: R_omega of the stiffer material, 0 < R <= 1
  StaticsOptions statics;                // of each equilibrium
  std::function<bool()> go_on;           // false: a simulation ends at once, status interrupted
  TestLog* log = nullptr;                // where tests that are done are kept
};

/// Cells across the height, as they are or as 0 stands for.
[[nodiscard]] int cells_across(const SpecimenOptions& options, Formulation formulation);

/// R_omega of A and B.
struct ShapeRatios {
  double a = 1, b = 1;  // of either material [-]
};
/// Those whose ratio has this logarithm; the stiffer material has the shape ratio `stiffer`.
[[nodiscard]] ShapeRatios shape_ratios(double log_ratio, double stiffer);

/// What a simulated test measures.
struct SpecimenResponse {
  Status status = Status::not_converged;  // of its solve
  std::string remark;                     // of the solver, where status is not converged
  double moved_mm = 0;                    // mean of the interface, along the bar
  double turned_deg = 0;                  // of the interface about the bar's axis
  double force_n = 0;                     // physical: along the bar at the free end, for E_B = 1 MPa
};

/// A tensile or a twist test of a two-material bar, simulated. Physical: tetrahedra of order 2; target-shape: of order
/// 1, the only one it has.
class SpecimenTest {
 public:
  /// throws  InvalidInput on a bar that cannot be meshed
  SpecimenTest(const SpecimenOptions& options, Formulation formulation, const StretchedSpecimen& specimen);
  SpecimenTest(const SpecimenOptions& options, Formulation formulation, const TwistedSpecimen& specimen);

  /// log_ratio  physical: ln(E_A / E_B); target-shape: ln(R_omega A / R_omega B)
  [[nodiscard]] SpecimenResponse at(double log_ratio);

 private:
  SpecimenTest(const SpecimenOptions& options, Formulation formulation, double length_mm, double interface_mm);
  void hold(const std::vector<Index>& vertices, std::array<bool, 3> axes);
  void slide();
  void set_materials(double log_ratio);
  [[nodiscard]] std::vector<Index> vertices_at(double x) const;
  [[nodiscard]] double turn_of_interface(const Points& positions) const;
  [[nodiscard]] double force_at_end(const Model& model, const Points& positions) const;

  SpecimenOptions options_;
  double length_mm_, interface_mm_;
  RobotSpec robot_;
  Points last_;  // the last equilibrium; no rows: none yet
};

}  // namespace softkin::calibration
