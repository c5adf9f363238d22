#pragma once

#include <random>

#include "small_maps.hpp"

namespace softkin::runs::testing {

/// A map as it is tested: what it was exported to, and commands to compare at.
struct Exported {
  Exported(MapData of, bool in_float) : data(std::move(of)), map(data), floats(in_float) {}
  MapData data;
  KinematicMap map;
  bool floats, tampered = false;
  std::string header{};
  std::vector<Eigen::VectorXd> commands{};
};

inline std::vector<MapData> small_maps() {
  return {arm_map(),   redundant_map(), cable_map(),   cable_map(true),
          askew_map(), ending_map(),    divided_map(), single_map()};
}

/// Random ones, corners, ones beside the ranges and what is no number.
inline std::vector<Eigen::VectorXd> commands_of(const KinematicMap& map, bool floats, int count = 250) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> fraction(0, 1);
  std::vector<Eigen::VectorXd> rows;
  const auto add = [&](const auto& fraction_of) {
    Eigen::VectorXd& row = rows.emplace_back(map.inputs());
    for (Index i = 0; i < map.inputs(); ++i) {
      const MapInput& input = map.data().inputs[i];
      const double at = fraction_of(i);
      row[i] = at == 1 ? input.high : input.low + at * (input.high - input.low);
      if (floats) row[i] = static_cast<float>(row[i]);
    }
  };
  for (int n = 0; n < count; ++n) add([&](Index) { return fraction(generator); });
  if (!floats)  // of which the rounded one may be outside
    for (int corner = 0; corner < (1 << map.inputs()); ++corner) add([&](Index i) { return corner >> i & 1; });
  for (Index beside = 0; beside < map.inputs(); ++beside)
    for (const double at : {-0.001, 1.001, std::nan("")}) add([&](Index i) { return i == beside ? at : 0.5; });
  return rows;
}

}  // namespace softkin::runs::testing
