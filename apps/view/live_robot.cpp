#include "live_robot.hpp"

#include <chrono>
#include <cmath>
#include <softkin/model/names.hpp>
#include <softkin/runs/shortfall_text.hpp>
#include <softkin/statics/deformation.hpp>
#include <utility>

namespace softkin::view {

namespace {

using Clock = std::chrono::steady_clock;

// time that work in progress may still take once a newer request arrives; the short one for searches lets them advance
// where requests never end [s]
constexpr double patience_of_solves = 0.3, patience_of_searches = 0.05;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::vector<std::optional<double>> loads_of(const Model& model, const State& state) {
  std::vector<std::optional<double>> loads(model.actuators.size());
  if (model.formulation != Formulation::physical) return loads;
  for (std::size_t a = 0; a < loads.size() && static_cast<Index>(a) < state.multipliers.size(); ++a)
    if (shows_measure(model.actuators[a]))
      loads[a] = achieved_ratio(model, model.actuators[a], state.positions);
    else if (!multiplier_key(model.actuators[a]).empty())
      loads[a] = state.multipliers[a];
  return loads;
}

std::vector<std::optional<double>> measures_of(const Model& model, const State& state) {
  std::vector<std::optional<double>> measures;
  for (const Actuator& actuator : model.actuators)
    measures.push_back(runs::page_measure_unit(model, actuator).empty()
                           ? std::nullopt
                           : std::optional(achieved_ratio(model, actuator, state.positions)));
  return measures;
}

/// Returns the distance of an unchanged shape from a requested target.
TargetAnswer target_answer(const Model& model, const TargetRequest& request, const Points& positions) {
  const Vec3 place = model.markers[request.marker].at(positions);
  return {request.marker, request.at, (place - request.at).norm(), false, ""};
}

}  // namespace

std::optional<LiveShape> live_shape(const Statics& statics, const runs::PageDocument& page, const Equilibrium& found) {
  const Model& model = statics.model();
  const Points& positions = found.state.positions;
  if (!positions.allFinite()) return std::nullopt;
  LiveShape shape;
  shape.status = name_of(found.report.status);
  shape.remark = found.report.remark;
  shape.commands = found.actuation;
  shape.loads = loads_of(model, found.state);
  shape.measures = measures_of(model, found.state);
  for (const Marker& marker : model.markers) shape.markers.push_back(marker.at(positions));
  shape.iterations = found.report.iterations;
  shape.seconds = found.report.seconds;
  shape.vertices = page.vertices().size();
  const auto fields = page.fields(statics.measured(found.state));
  shape.numbers.reserve((3 + fields.size()) * shape.vertices);
  for (const Index v : page.vertices())
    for (int axis = 0; axis < 3; ++axis) shape.numbers.push_back(static_cast<float>(positions(v, axis)));
  for (const runs::VertexField& field : fields) {
    shape.arrays.push_back(field.name);
    for (const float value : field.values) shape.numbers.push_back(std::isfinite(value) ? value : 0.0f);
  }
  return shape;
}

LiveRobot::LiveRobot(const Statics& statics, const runs::PageDocument& page, const StaticsOptions& options,
                     Equilibrium rest, Publish publish, LiveEstimator* estimator)
    : model_(statics.model()),
      statics_(statics),
      page_(page),
      options_(options),
      publish_(std::move(publish)),
      estimator_(estimator) {
  options_.keep_history = false;
  std::optional<LiveShape> shape = live_shape(statics_, page_, rest);
  if (!shape) throw InvalidInput("the robot's shape at rest is not finite");
  stand(std::move(rest), std::move(*shape));
  say(0, shape_);
  thread_ = std::thread([this] { work(); });
}

LiveRobot::~LiveRobot() {
  stop(0);
  thread_.join();
}

void LiveRobot::ask(LiveRequest request) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    next_ = std::move(request);
  }
  changed_.notify_all();
}

bool LiveRobot::stop(double seconds) {
  std::unique_lock<std::mutex> lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return ended_; });
}

bool LiveRobot::has_newer() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stopped_ || next_.has_value();
}

bool LiveRobot::is_stopped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stopped_;
}

void LiveRobot::work() {
  for (;;) {
    std::optional<LiveRequest> request;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return stopped_ || next_; });
      if (stopped_) break;
      request = std::exchange(next_, std::nullopt);
    }
    answer(*request);
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  ended_ = true;
  changed_.notify_all();
}

/// Every failure is reported in a frame; the robot keeps its shape.
void LiveRobot::answer(const LiveRequest& request) {
  try {
    std::visit(
        [&](const auto& what) {
          using What = std::decay_t<decltype(what)>;
          if constexpr (std::is_same_v<What, CommandRequest>)
            solve(what, request.asker);
          else if constexpr (std::is_same_v<What, TargetRequest>)
            search(what, request.asker);
          else
            send(what, request.asker);
        },
        request.what);
  } catch (const std::exception& error) {
    LiveShape shape = shape_;
    shape.id = std::visit([](const auto& what) { return what.id; }, request.what);
    shape.status = name_of(Status::not_converged);
    shape.remark = error.what();
    if (std::holds_alternative<ReadingsRequest>(request.what)) shape.estimate = nothing_reported_text(error.what());
    say(request.asker, std::move(shape));
  }
}

ProgressCallback LiveRobot::patience(double seconds) const {
  return [this, seconds, begin = Clock::now()](const Progress&) {
    return seconds_since(begin) < seconds ? !is_stopped() : !has_newer();
  };
}

void LiveRobot::stand(Equilibrium found, LiveShape shape) {
  last_ = std::move(found);
  sensitivity_.reset();
  shape_ = std::move(shape);
}

void LiveRobot::say(std::uint64_t asker, LiveShape shape) const {
  publish_(std::make_shared<const LiveAnswer>(LiveAnswer{asker, std::move(shape)}));
}

void LiveRobot::solve(const CommandRequest& request, std::uint64_t asker) {
  Equilibrium found = statics_.solve(request.commands, last_.state, options_, patience(patience_of_solves));
  if (found.report.status == Status::interrupted) return;
  std::optional<LiveShape> shape;
  if (found.report.status == Status::converged) shape = live_shape(statics_, page_, found);
  if (shape) {
    stand(std::move(found), std::move(*shape));
    shape = shape_;
  } else {
    shape = shape_;
    shape->status = name_of(found.report.status);
    shape->remark = found.report.remark;
    shape->iterations = found.report.iterations;
    shape->seconds = found.report.seconds;
    if (found.report.status == Status::limit)
      shape->remark =
          runs::reached_text(model_, runs::step_record(model_, found, deformation_of(model_, found.state.positions))) +
          ": " + found.report.remark;
  }
  shape->id = request.id;
  say(asker, std::move(*shape));
}

InverseResult LiveRobot::searched(const std::vector<Goal>& goals, int other_starts) const {
  InverseOptions options = usual_options(InverseMethod::newton);
  options.statics = options_;
  options.other_starts = other_starts;
  if (sensitivity_) options.start_sensitivity = &*sensitivity_;
  return solve_inverse(statics_, goals, last_, options, patience(patience_of_searches));
}

/// From the last shape; where that leads to no end, from elsewhere too.
void LiveRobot::search(const TargetRequest& request, std::uint64_t asker) {
  const std::vector<Goal> goals{{PositionGoal{request.marker, request.at}}};
  double before = std::numeric_limits<double>::infinity();
  for (const int other_starts : {0, usual_options(InverseMethod::newton).other_starts}) {
    InverseResult found = searched(goals, other_starts);
    const bool interrupted = found.status == InverseStatus::interrupted;
    const bool stands = found.equilibrium.report.status == Status::converged && found.errors_mm.size() > 0;
    if (other_starts > 0 && !(stands && found.errors_mm[0] < 0.99 * before)) return;
    std::optional<LiveShape> shape;
    if (stands) shape = live_shape(statics_, page_, found.equilibrium);
    if (shape) {
      shape->iterations = found.iterations;
      shape->seconds = found.seconds;
      stand(found.equilibrium, std::move(*shape));
      if (found.sensitivity.regular) sensitivity_ = std::move(found.sensitivity);
    }
    if (interrupted) return;
    LiveShape answer = shape_;
    answer.id = request.id;
    answer.target = target_answer(model_, request, last_.state.positions);
    answer.target->reached = shape && found.status == InverseStatus::reached;
    if (!answer.target->reached)
      answer.target->why = stands ? runs::shortfall_text(model_, goals, found) : "not converged: " + found.remark;
    if (!shape) {
      answer.status = name_of(Status::not_converged);
      answer.remark = found.remark;
    }
    before = answer.target->error_mm;
    const bool reached = answer.target->reached;
    say(asker, std::move(answer));
    if (reached || has_newer()) return;
  }
}

/// Sends the estimated shape, with its forces.
void LiveRobot::send(const ReadingsRequest& request, std::uint64_t asker) {
  if (estimator_ == nullptr) throw InvalidInput("nothing is estimated of this robot");
  const Estimate& reported = estimator_->send(asker, request, [this](const Progress&) { return !is_stopped(); });
  if (reported.status == Status::interrupted) return;
  std::optional<LiveShape> shape;
  if (reported.status == Status::converged) {
    Equilibrium found{reported.state, reported.actuation, {}};
    found.report.status = reported.status;
    found.report.iterations = reported.iterations;
    found.report.seconds = reported.seconds;
    shape = live_shape(statics_, page_, found);
    if (shape) stand(std::move(found), std::move(*shape));
  }
  LiveShape answer = shape_;
  answer.id = request.id;
  answer.estimate = estimator_->reported_text(reported);
  if (!shape) {
    answer.status = name_of(reported.status);
    answer.remark = reported.remark;
    answer.seconds = reported.seconds;
  }
  say(asker, std::move(answer));
}

}  // namespace softkin::view
