#pragma once

#include <optional>
#include <softkin/kinematics/inverse.hpp>
#include <softkin/kinematics/map.hpp>
#include <softkin/runs/reports.hpp>
#include <string>

namespace softkin::runs {

/// throws  InvalidInput on a file that is no map, or not of this robot
[[nodiscard]] KinematicMap read_map_of(const Model& model, const std::string& file);

/// Equilibria of the solver, or of a map, or of the solver begun at those of the map (polish).
class Answers {
 public:
  /// model must outlive the object; map: its file, empty: none. Throws as read_map_of(), and on a map without shape
  Answers(const Model& model, const std::string& map, bool polish);
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;

  [[nodiscard]] const Statics& statics() const { return statics_; }
  /// Null without a map.
  [[nodiscard]] const UsedMap* map() const { return used_ ? &*used_ : nullptr; }
  [[nodiscard]] const MapData* map_data() const { return used_ ? &used_->data : nullptr; }
  [[nodiscard]] bool by_map_alone() const { return used_ && !used_->polished; }
  /// "answered by the map F.skmap: " and what is known of its errors, a line; empty without a map.
  [[nodiscard]] std::string remark() const;

  /// As solve_inverse_from().
  [[nodiscard]] InverseResult inverse(const std::vector<Goal>& goals, const Actuation& start,
                                      const InverseOptions& options, const ProgressCallback& progress) const;

 private:
  const Model& model_;
  std::optional<KinematicMap> map_;
  std::optional<UsedMap> used_;
  Statics statics_;
};

}  // namespace softkin::runs
