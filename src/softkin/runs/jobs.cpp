#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/model/backlash.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/jobs.hpp>
#include <softkin/runs/records_json.hpp>
#include <utility>

namespace softkin::runs {

namespace {

/// Reads a line by from_json of the record. Throws InvalidInput where it is none of to_json
template <class Record, class Read>
Codec<Record> codec_of(std::function<Json(const Record&)> write, Read read) {
  return {[write](const Record& record) { return line_of(write(record)); },
          [read](std::string_view line) {
            Record record;
            try {
              read(parse_json(line), record);
            } catch (const std::out_of_range&) {
              throw InvalidInput("it is not a report that this command wrote");
            } catch (const Json::exception&) {
              throw InvalidInput("it is not a report that this command wrote");
            }
            return record;
          }};
}

/// A start knows what acted; else it is where its first command led.
std::vector<Actuation> acting_along(const Model& model, const std::vector<ActuationStep>& steps,
                                    const std::optional<State>& start) {
  std::vector<Actuation> reported;
  for (const ActuationStep& step : steps) reported.push_back(step.actuation);
  if (reported.empty()) return reported;
  const bool known = start && start->knows(model.rest_actuation().size());
  return acting_in_order(model,
                         !start  ? model.rest_actuation()
                         : known ? start->actuation
                                 : reported.front(),
                         reported);
}

}  // namespace

PathJob::PathJob(const Statics& statics, const std::vector<ActuationStep>& steps, std::string file,
                 const StaticsOptions& options, std::optional<State> start)
    : model_(statics.model()),
      statics_(statics),
      steps_(steps),
      acting_(acting_along(model_, steps, start)),
      file_(std::move(file)),
      options_(options),
      clock_(statics),
      state_(start ? std::move(*start) : statics.rest()),
      overlap_(model_) {}

Codec<StepRecord> PathJob::codec() const {
  return codec_of<StepRecord>([this](const StepRecord& record) { return to_json(model_, record); },
                              [this](const Json& json, StepRecord& record) { from_json(model_, json, record); });
}

std::string PathJob::mismatch(std::size_t number, const StepRecord& record) const {
  const std::string step = "step " + std::to_string(number);
  if (number >= steps_.size()) return "it has " + step + ", but " + file_ + " ends before; the path has changed";
  const ActuationStep& requested = steps_[number];
  const std::string where = file_ + ":" + std::to_string(requested.line);
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    const Actuator& actuator = model_.actuators[a];
    const double before = record.actuation[a], now = requested.actuation[a];
    if (before != now)
      return step + " was solved for " + actuator.name + " = " + command_text(actuator, before, 12) + ", but " + where +
             " asks for " + command_text(actuator, now, 12) + "; the path has changed";
  }
  if (record.time_s != requested.time) return step + " has another time than " + where + "; the path has changed";
  return "";
}

PathJob::Made PathJob::make(std::size_t number, const ProgressCallback& progress) {
  clock_.set(steps_[number].time, options_);
  Equilibrium found = statics_.solve(acting_[number], state_, options_, progress);
  found.actuation = steps_[number].actuation;
  const bool stopped = found.report.stopped;
  ElementDeformation deformation = statics_.measured(found.state);
  StepRecord record = step_record(model_, found, deformation);
  record.self_overlap = overlap_.in(found.state.positions);
  record.time_s = steps_[number].time;
  if (stopped) return Made{std::move(record), std::move(found.state), std::move(deformation)};
  if (record.status == Status::converged) record.viscous_loss_mJ = clock_.pass(record.time_s, found.state);
  state_ = std::move(found.state);
  return Made{std::move(record), state_, std::move(deformation)};
}

void PathJob::recall(const StepRecord& record, const Points& positions) {
  if (record.status == Status::converged)
    clock_.recall(record.time_s, {positions, record.shape_actuation.value_or(record.actuation)});
}

void PathJob::go_on(std::size_t, const StepRecord& before, Points positions) {
  statics_.forget();
  state_ = state_of(model_, before, std::move(positions));
}

FollowJob::FollowJob(const Statics& statics, const MarkerPath& path, std::string file, const TrajectoryOptions& options)
    : model_(statics.model()),
      statics_(statics),
      path_(path),
      file_(std::move(file)),
      follower_(statics, path, options),
      overlap_(model_) {}

Codec<WaypointRecord> FollowJob::codec() const {
  return codec_of<WaypointRecord>(
      [this](const WaypointRecord& record) { return to_json(model_, path_, record); },
      [this](const Json& json, WaypointRecord& record) { from_json(model_, path_, json, record); });
}

std::string FollowJob::mismatch(std::size_t number, const WaypointRecord& record) const {
  if (number >= path_.waypoints.size())
    return "it has waypoint " + std::to_string(number) + ", but the path ends before; the path has changed";
  const Waypoint& requested = path_.waypoints[number];
  if (record.requested.targets == requested.targets && record.requested.time == requested.time &&
      record.requested.inserted == requested.inserted)
    return "";
  return "waypoint " + std::to_string(number) + " is another one than in " + file_ + "; the path has changed";
}

FollowJob::Made FollowJob::make(std::size_t number, const ProgressCallback& progress) {
  const InverseResult found = follower_.advance(progress);
  const State& state = found.equilibrium.state;
  ElementDeformation deformation = statics_.measured(state);
  WaypointRecord record = waypoint_record(model_, path_.waypoints[number], found, deformation);
  record.self_overlap = overlap_.in(state.positions);
  record.stopped = found.stopped;
  if (number > 0) note_jump(model_, path_, last_, record);
  if (!found.stopped) record.viscous_loss_mJ = follower_.lost_mJ();
  if (!found.stopped) last_ = record;
  return Made{std::move(record), state, std::move(deformation)};
}

void FollowJob::recall(const WaypointRecord& record, const Points& positions) {
  if (record.status == Status::converged) follower_.recall(record.requested, {positions, record.actuation});
}

void FollowJob::go_on(std::size_t number, const WaypointRecord& before, Points positions) {
  statics_.forget();
  follower_.resume(number, state_of(model_, before, std::move(positions)));
  last_ = before;
}

namespace {

void check_closed(const Model& model, const std::string& file, const std::vector<ActuationStep>& gait) {
  if (gait.size() < 2) throw InvalidInput({file}, "a gait needs two rows or more, not " + std::to_string(gait.size()));
  for (std::size_t a = 0; a < model.actuators.size(); ++a) {
    const auto value = [&](const ActuationStep& step) { return step.actuation[a]; };
    const double first = value(gait.front()), last = value(gait.back());
    if (std::abs(first - last) > 1e-9 * std::max(1.0, std::abs(first)))
      throw InvalidInput({file, gait.back().line}, "a gait ends where it begins, but " + model.actuators[a].name +
                                                       " ends at " + command_text(model.actuators[a], last) +
                                                       " and begins at " + command_text(model.actuators[a], first));
  }
}

}  // namespace

std::vector<GaitStep> repeated(const Model& model, const std::string& file, const std::vector<ActuationStep>& gait,
                               std::size_t cycles) {
  check_closed(model, file, gait);
  const bool timed = gait.front().time.has_value();
  const double period = timed ? *gait.back().time - *gait.front().time : 0;
  std::vector<GaitStep> steps{{gait.front(), 0}};
  for (std::size_t cycle = 1; cycle <= cycles; ++cycle)
    for (std::size_t row = 1; row < gait.size(); ++row) {
      steps.push_back({gait[row], cycle});
      if (timed) *steps.back().requested.time += static_cast<double>(cycle - 1) * period;
    }
  return steps;
}

WalkJob::WalkJob(const Model& model, Walker& walker, const std::vector<GaitStep>& steps, std::string file)
    : model_(model), walker_(walker), steps_(steps), file_(std::move(file)), overlap_(model) {}

Codec<WalkRecord> WalkJob::codec() const {
  return codec_of<WalkRecord>([this](const WalkRecord& record) { return to_json(model_, record); },
                              [this](const Json& json, WalkRecord& record) { from_json(model_, json, record); });
}

std::string WalkJob::mismatch(std::size_t number, const WalkRecord& record) const {
  const std::string step = "step " + std::to_string(number);
  if (number >= steps_.size())
    return "it has " + step + ", but " + counted(steps_.back().cycle, "cycle") + " of " + file_ + " end before";
  const ActuationStep& requested = steps_[number].requested;
  if (record.actuation == requested.actuation && record.time_s == requested.time) return "";
  return step + " is another one than in " + file_ + "; the gait has changed";
}

WalkJob::Made WalkJob::make(std::size_t number, const ProgressCallback& progress) {
  const WalkStep found = walker_.advance(steps_[number].requested.actuation, progress);
  const State& state = found.equilibrium.state;
  ElementDeformation deformation = deformation_of(model_, state.positions);
  WalkRecord record = walk_record(model_, steps_[number].cycle, found, deformation);
  record.self_overlap = overlap_.in(state.positions);
  record.time_s = steps_[number].requested.time;
  return Made{std::move(record), state, std::move(deformation)};
}

void WalkJob::go_on(std::size_t, const WalkRecord& before, Points positions) {
  WalkStep last = before.walk;
  last.equilibrium.state = state_of(model_, before, std::move(positions));
  walker_.resume(last);
}

}  // namespace softkin::runs
