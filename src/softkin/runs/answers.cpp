#include <softkin/kinematics/map_robot.hpp>
#include <softkin/runs/answers.hpp>
#include <softkin/runs/map_file.hpp>

namespace softkin::runs {

KinematicMap read_map_of(const Model& model, const std::string& file) {
  MapData data = read_map(file);
  check_robot(data, model, file);
  return KinematicMap(std::move(data));
}

Answers::Answers(const Model& model, const std::string& map, bool polish)
    : model_(model),
      map_(map.empty() ? std::nullopt : std::optional(read_map_of(model, map))),
      statics_(statics_by(model, map_ ? &*map_ : nullptr, polish)) {
  if (map_) used_.emplace(UsedMap{map, map_->data(), polish});
}

std::string Answers::remark() const {
  if (!used_) return "";
  return (used_->polished ? "begun from the map " : "answered by the map ") + used_->file + ": " +
         map_text(used_->data) + "\n";
}

InverseResult Answers::inverse(const std::vector<Goal>& goals, const Actuation& start, const InverseOptions& options,
                               const ProgressCallback& progress) const {
  if (used_ && used_->polished) return solve_inverse_by_map(model_, *map_, statics_, goals, start, options, progress);
  return solve_inverse_from(statics_, goals, start, options, progress);
}

}  // namespace softkin::runs
