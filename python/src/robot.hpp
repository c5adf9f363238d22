#pragma once

#include <softkin/kinematics/map.hpp>
#include <softkin/runs/records.hpp>
#include <softkin/runs/reports.hpp>
#include <softkin/statics/statics.hpp>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "source.hpp"

namespace softkin::python {

/// A compiled robot with its statics; shared by all that was made of it, not modified.
class Robot : public std::enable_shared_from_this<Robot> {
 public:
  /// read: may files of the description that the source does not hold be read from disk
  Robot(Source source, bool read) : source_(std::move(source)), model_(compile(source_.spec(read))), statics_(model_) {}

  [[nodiscard]] const Source& source() const { return source_; }
  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Statics& statics() const { return statics_; }
  [[nodiscard]] const OverlapSearch& overlaps() const {
    std::call_once(overlap_made_, [this] { overlap_.emplace(model_); });
    return *overlap_;
  }
  /// Does an iteration of a solve take so long that a user who stops it would notice?
  [[nodiscard]] bool is_large() const { return model_.rest.rows() > 3000; }
  /// throws  InvalidInput with the nearest name
  [[nodiscard]] Index marker(const std::string& name) const;
  /// The marker of that name, which must have an orientation.
  [[nodiscard]] Index oriented_marker(const std::string& name) const;
  [[nodiscard]] Index actuator(const std::string& name) const;

 private:
  Source source_;
  Model model_;
  Statics statics_;
  mutable std::once_flag overlap_made_;
  mutable std::optional<OverlapSearch> overlap_;
};
using RobotPtr = std::shared_ptr<Robot>;

/// A kinematic map; not modified.
struct Map : std::enable_shared_from_this<Map> {
  /// of: for messages, its file
  Map(MapData data, std::string of) : map(std::move(data)), name(std::move(of)) {}

  KinematicMap map;
  std::string name;
};
using MapPtr = std::shared_ptr<Map>;

/// Statics of its own, which keep threads and factors from call to call: for one user at a time. Those of a map keep
/// nothing, so that several may use them at once.
struct Session : std::enable_shared_from_this<Session> {
  explicit Session(RobotPtr of) : robot(std::move(of)), statics(robot->model()) {}
  /// by      null: none; answers in the solver's place
  /// polish  the solver continues from its answers
  /// throws  InvalidInput where it is the map of another robot, or one without shape
  Session(RobotPtr of, MapPtr by, bool polish);

  /// What reports say of the map.
  [[nodiscard]] std::optional<runs::UsedMap> used() const {
    if (!map) return std::nullopt;
    return runs::UsedMap{map->name, map->map.data(), polishes};
  }

  RobotPtr robot;
  MapPtr map;
  bool polishes = false;
  Statics statics;
};
using SessionPtr = std::shared_ptr<Session>;

/// Turns from rest of a shape of a run, continued from its first shape on [degrees]; empty: it is of no run.
struct RunTurns {
  std::vector<double> markers{};  // of each marker
  std::vector<double> lines{};    // of the line between every two, as runs::LineTurns has them
};

/// An equilibrium and its request. The record is made at the first access.
class Shape : public std::enable_shared_from_this<Shape> {
 public:
  Shape(RobotPtr robot, Equilibrium found, StaticsOptions options, RunTurns turns = {})
      : robot_(std::move(robot)), found_(std::move(found)), options_(options), turns_(std::move(turns)) {}

  [[nodiscard]] const RobotPtr& robot() const { return robot_; }
  [[nodiscard]] const Model& model() const { return robot_->model(); }
  [[nodiscard]] const Equilibrium& found() const { return found_; }
  [[nodiscard]] const Points& positions() const { return found_.state.positions; }
  [[nodiscard]] const StaticsOptions& options() const { return options_; }
  [[nodiscard]] const ElementDeformation& deformation() const;
  [[nodiscard]] const runs::StepRecord& record() const;
  [[nodiscard]] const RunTurns& turns() const { return turns_; }
  /// By how much a marker that has an orientation, or the line from a marker to another one, has turned from rest
  /// [degrees].
  ///
  /// throws  InvalidInput where there is no such marker, it has no orientation, or both are at one place at rest
  [[nodiscard]] double turn(const std::string& marker, const std::optional<std::string>& to) const;

 private:
  RobotPtr robot_;
  Equilibrium found_;
  StaticsOptions options_;
  RunTurns turns_;
  mutable std::once_flag measured_, recorded_;
  mutable ElementDeformation deformation_;
  mutable runs::StepRecord record_;
};
using ShapePtr = std::shared_ptr<Shape>;

/// A line about a shape, as the command prints it: its kind, whether it is a warning, its text.
using FindingOut = std::tuple<std::size_t, bool, std::string>;
[[nodiscard]] std::vector<FindingOut> finding_lines_of(const Model& model, const runs::StepRecord& record);

}  // namespace softkin::python
