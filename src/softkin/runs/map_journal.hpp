#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <softkin/kinematics/map_build.hpp>
#include <softkin/runs/store.hpp>
#include <string>
#include <utility>

namespace softkin::runs {

/// What a map's making has found so far, on disk beside the map to be: MAP.run. It outlives kills, and is gone when
/// the map is there.
class MapJournal : public MapDesk {
 public:
  /// Begins or, with resume, continues the journal.
  ///
  /// throws  InvalidInput where there is a journal that is not to be gone on with, or one of another robot or other
  ///         options that is; where it cannot be written
  MapJournal(const std::filesystem::path& map, const Model& model, const MapOptions& options, bool resume);

  /// Equilibria that were there.
  [[nodiscard]] std::size_t known() const { return known_.size(); }

  [[nodiscard]] std::optional<maps::Sample> known(Index piece, Index number, const Eigen::VectorXd& commands) override;
  void keep(Index piece, Index number, const maps::Sample& sample) override;

  void remove();

  [[nodiscard]] static std::filesystem::path path_of(const std::filesystem::path& map);

 private:
  std::map<std::pair<Index, Index>, maps::Sample> known_;  // by piece and number
  std::optional<Store> store_;
};

}  // namespace softkin::runs
