#pragma once

#include <functional>
#include <softkin/kinematics/map.hpp>
#include <softkin/kinematics/maps/piece_solver.hpp>

namespace softkin {

/// Accuracies of a map, and the maximum work for it. Ranges stand behind the values.
struct MapOptions {
  double accuracy_mm = 0.01;        // of markers, > 0
  double load_accuracy = 0;         // of pressures [kPa] and tensions [N], >= 0; 0: a thousandth of the largest
  double ratio_accuracy = 1e-4;     // of achieved ratios [-], > 0
  double shape_accuracy_mm = 0.05;  // of every vertex, >= 0; 0: without the shape
  Index max_equilibria = 2000;      // that it is made from, >= 1
  Index checks = 200;               // random actuations, >= 1
  std::uint64_t seed = 1;           // of these
  StaticsOptions statics{};         // of each equilibrium; threads and reuse_factor are set
  int threads = 1;                  // >= 1; the map is the same
};

/// Stores the equilibria while a map is made. An equilibrium has a number in its piece; checks have -1.
class MapDesk {
 public:
  virtual ~MapDesk() = default;
  /// Returns the sample that keep() received in an earlier, stopped run; nothing where there is none.
  [[nodiscard]] virtual std::optional<maps::Sample> known(Index piece, Index number,
                                                          const Eigen::VectorXd& commands) = 0;
  /// Called by one thread at a time.
  virtual void keep(Index piece, Index number, const maps::Sample& sample) = 0;
};

/// The progress of making a map.
struct MapProgress {
  Index equilibria = 0, checks = 0;  // solved so far
  double error = 0;                  // of the last predictions, over the requested accuracy; infinite at first
  std::string doing;                 // "all cables taut", "tendon2 slack"; "checking"
};
/// Returning false stops the making.
using MapCallback = std::function<bool(const MapProgress&)>;

/// A map that was made.
struct MapResult {
  MapData data;           // for KinematicMap, write_map
  bool accurate = false;  // as requested, at the checks
  std::string remark;     // why not
};

/// Makes a map: solves equilibria where the map is least certain until it predicts new ones with the requested
/// accuracy, then checks it at random actuations of the robot itself. Where a check fails, the map is refined and
/// checked at other actuations. The map is the same with any number of threads and any samples stored by the desk.
///
/// progress  called after every equilibrium, by one thread at a time
/// returns   nothing where progress stopped it
/// throws    InvalidInput on options out of range and as maps::outline_of does; where no equilibrium is found
[[nodiscard]] std::optional<MapResult> build_map(const Model& model, const MapOptions& options, MapDesk* desk = nullptr,
                                                 const MapCallback& progress = {});

}  // namespace softkin
