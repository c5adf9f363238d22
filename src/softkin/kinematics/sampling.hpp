#pragma once

#include <cstdint>
#include <softkin/model/equilibrium.hpp>
#include <softkin/model/model.hpp>
#include <softkin/statics/statics.hpp>

namespace softkin {

/// grid: the same number of values for every actuator, both ends of its range included. sobol: a low-discrepancy
/// sequence. random: independent and uniform. The latter two are in [low, high).
enum class Sampling { grid, sobol, random };

/// Which samples of a workspace are taken.
struct SamplingOptions {
  Sampling kind = Sampling::grid;  // how they lie in the ranges
  Index samples = 0;               // >= 1; grid: a full grid's number, see nearest_grid
  std::uint64_t seed = 0;          // random
};

/// A row per sample, a column per actuator: its command, a ratio [-], tension [N], pressure [kPa] or voltage [kV].
using Actuations = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Actuators that grid, sequence or generator run over: those whose range is more than one value.
[[nodiscard]] std::vector<Index> varied_actuators(const Model& model);

/// Values per varied actuator of the full grid whose number of samples is nearest to the one given, 2 or more.
[[nodiscard]] Index nearest_grid(const Model& model, Index samples);

/// Samples of that grid.
[[nodiscard]] Index full_grid(const Model& model, Index samples);

/// Samples inside the ranges of the actuators; the same on every machine.
///
/// returns  grid: the last actuator changes fastest
/// source   sobol: Bratley and Fox 1988 (ACM Algorithm 659), in Gray-code order (Antonov and Saleev 1979), with the
///          direction numbers of Joe and Kuo 2008, 8 varied actuators at most; the sequence starts with the low end of
///          every range. random: 53 upper bits of std::mt19937_64
/// throws   InvalidInput on samples < 1, a grid that is not full, no actuator that varies, more than 8 for sobol
[[nodiscard]] Actuations sample_actuations(const Model& model, const SamplingOptions& options);

/// Options of a solve that is one of many at once: on one thread, and the same bits whatever was solved before.
[[nodiscard]] StaticsOptions one_of_many(StaticsOptions options);

/// Sample numbers in an order in which neighbours follow each other: along a Hilbert curve through the ranges.
///
/// source  Skilling 2004, Programming the Hilbert curve
[[nodiscard]] std::vector<Index> order_of_neighbours(const Model& model, const Actuations& actuations);

}  // namespace softkin
