#include "live_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/table/measured_poses.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/estimate_json.hpp>
#include <softkin/runs/records_json.hpp>

namespace softkin::view {

namespace {

/// Those of the kinds whose deviation is given.
EstimateSetup with_columns(EstimateSetup setup, const std::vector<PoseColumn>& all,
                           const std::array<double, readings>& deviations) {
  std::vector<double> given;
  for (const PoseColumn& column : all) {
    const double deviation = deviations[static_cast<std::size_t>(column.kind)];
    if (!(deviation > 0)) continue;
    setup.columns.push_back(column);
    given.push_back(deviation);
  }
  setup.deviations = Eigen::Map<const Eigen::VectorXd>(given.data(), given.size());
  return setup;
}

Json axes_json(const std::array<Vec3, 2>& axes) {
  return {json_of(axes[0]), json_of(axes[1])};
}

Json force_json(const runs::ForcePicture& force) {
  Json json{{"name", force.name},
            {"at_mm", json_of(force.at)},
            {"force_N", json_of(force.force)},
            {"deviation_N", force.deviation},
            {"across_N", axes_json(force.across)}};
  json["place_mm"] = force.place ? axes_json(*force.place) : Json();
  return json;
}

}  // namespace

EstimateSetup estimate_setup(const Model& model, std::vector<EstimatedUnknown> unknowns,
                             const std::array<double, readings>& deviations,
                             const std::array<std::string, readings>& options, EstimatorOptions how) {
  const std::vector<PoseColumn> all = possible_readings(model);
  EstimateSetup setup = with_columns({std::move(unknowns), {}, {}, std::move(how)}, all, deviations);
  if (!setup.columns.empty()) return setup;
  std::string missing;  // deviations that would let something be read
  for (std::size_t k = 0; k < readings; ++k)
    if (std::any_of(all.begin(), all.end(), [&](const PoseColumn& c) { return static_cast<std::size_t>(c.kind) == k; }))
      missing +=
          (missing.empty() ? "" : ", ") + options[k] + in_unit(static_cast<Reading>(k)) + " (" + reading_names[k] + ")";
  throw InvalidInput({.file = model.name}, missing.empty() ? "nothing of this robot can be read"
                                                           : "what is read needs its deviation: " + missing);
}

LiveEstimator::LiveEstimator(const Model& model, EstimateSetup setup)
    : model_(model),
      setup_(std::move(setup)),
      estimator_(model, setup_.unknowns, setup_.columns, setup_.deviations, setup_.how),
      page_text_(text_for_page()),
      columns_(setup_.columns),
      pictures_(model) {
  for (const PoseColumn& column : columns_) has_[static_cast<std::size_t>(column.kind)] = true;
}

void LiveEstimator::have(const Eigen::VectorXd& values) {
  for (std::size_t c = 0; c < setup_.columns.size(); ++c)
    if (!std::isnan(values[c])) read_[static_cast<std::size_t>(setup_.columns[c].kind)] = true;
  if (read_ != has_ && read_ != Kinds{}) {
    has_ = read_;
    columns_.clear();
    std::vector<double> deviations;
    for (std::size_t c = 0; c < setup_.columns.size(); ++c) {
      if (!has_[static_cast<std::size_t>(setup_.columns[c].kind)]) continue;
      columns_.push_back(setup_.columns[c]);
      deviations.push_back(setup_.deviations[c]);
    }
    estimator_ = Estimator(model_, setup_.unknowns, columns_,
                           Eigen::Map<const Eigen::VectorXd>(deviations.data(), deviations.size()), setup_.how);
    last_s_.reset();
    last_ = {};
  }
  values_.resize(columns_.size());
  Index next = 0;
  for (std::size_t c = 0; c < setup_.columns.size(); ++c)
    if (has_[static_cast<std::size_t>(setup_.columns[c].kind)]) values_[next++] = values[c];
}

std::string LiveEstimator::text_for_page() const {
  Json columns = Json::array();
  const std::vector<ReadingGroup>& groups = estimator_.groups();
  for (std::size_t c = 0; c < setup_.columns.size(); ++c) {
    const PoseColumn& column = setup_.columns[c];
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const ReadingGroup& g) {
      return std::find(g.columns.begin(), g.columns.end(), c) != g.columns.end();
    });
    columns.push_back({{"name", column.name},
                       {"group", group->name},
                       {"axis", column.axis < 0 ? "" : axis_names[column.axis]},
                       {"unit", reading_units[static_cast<std::size_t>(column.kind)]},
                       {"deviation", setup_.deviations[c]}});
  }
  return runs::line_of({{"columns", columns}, {"told", reported_actuators()}, {"fade_s", setup_.how.fade_s}});
}

const Estimate& LiveEstimator::send(std::uint64_t asker, const ReadingsRequest& request,
                                    const ProgressCallback& progress) {
  const auto now = Clock::now();
  double elapsed = 0;
  const bool is_other = asker != asker_;
  if (is_other) read_ = {};
  have(request.values);
  if (is_other)
    estimator_.forget();
  else if (request.time_s && last_s_)
    elapsed = std::max(0.0, *request.time_s - *last_s_);
  else if (last_ != Clock::time_point{})
    elapsed = std::chrono::duration<double>(now - last_).count();
  asker_ = asker;
  const Estimate& reported = estimator_.update(request.commands, values_, elapsed, progress);
  if (reported.status != Status::converged) return reported;
  last_s_ = request.time_s;
  last_ = now;
  return reported;
}

std::string LiveEstimator::reported_text(const Estimate& reported) const {
  Json json{{"status", name_of(reported.status)}, {"remark", reported.remark}};
  if (reported.status != Status::converged) return runs::line_of(json);
  Json forces = Json::array();
  for (const runs::ForcePicture& force : pictures_.of(reported)) forces.push_back(force_json(force));
  json["numbers"] = runs::reported_numbers_json(reported);
  json["places"] = runs::reported_places_json(reported);
  json["chi_square"] = reported.chi_square;
  json["freedoms"] = reported.freedoms;
  json["misfit"] = reported.misfit();
  json["left_out"] = runs::left_out_json(reported, estimator_.groups());
  json["words"] = estimate_words(reported, estimator_.groups());
  json["seconds"] = reported.seconds;
  json["readings"] = runs::read_json(reported, columns_, values_);
  json["forces"] = std::move(forces);
  return runs::line_of(json);
}

std::string stream_line(const std::string& reported, const std::optional<double>& time_s, std::uint64_t passed_over) {
  Json line{{"t_s", time_s ? Json(*time_s) : Json()}};
  line.update(Json::parse(reported));
  line.erase("readings");
  line.erase("forces");
  line["passed_over"] = passed_over;
  return runs::line_of(line);
}

std::string nothing_reported_text(const std::string& why) {
  return runs::line_of({{"status", name_of(Status::not_converged)}, {"remark", why}});
}

}  // namespace softkin::view
