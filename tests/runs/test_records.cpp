#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <softkin/runs/findings.hpp>
#include <softkin/runs/records_json.hpp>

#include "small_runs.hpp"

namespace softkin::runs {
namespace {

/// What is read is what was written: all of it where it can be compared, and the same text again.
void expect_same(const StepRecord& a, const StepRecord& b) {
  EXPECT_EQ(a.actuation, b.actuation);
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reached_fraction, b.reached_fraction);
  EXPECT_EQ(a.remark, b.remark);
  EXPECT_EQ(a.shape_actuation.has_value(), b.shape_actuation.has_value());
  if (a.shape_actuation && b.shape_actuation) {
    EXPECT_EQ(*a.shape_actuation, *b.shape_actuation);
  }
  EXPECT_EQ(a.shape_load_fraction, b.shape_load_fraction);
  EXPECT_EQ(a.markers, b.markers);
  ASSERT_EQ(a.marker_turns.size(), b.marker_turns.size());
  for (std::size_t m = 0; m < a.marker_turns.size(); ++m) {
    EXPECT_EQ(std::isnan(a.marker_turns[m]), std::isnan(b.marker_turns[m]));
    if (!std::isnan(a.marker_turns[m])) {
      EXPECT_EQ(a.marker_turns[m], b.marker_turns[m]);
    }
  }
  EXPECT_EQ(a.largest_displacement_mm, b.largest_displacement_mm);
  EXPECT_EQ(a.self_overlap.points, b.self_overlap.points);
  EXPECT_EQ(a.self_overlap.deepest_mm, b.self_overlap.deepest_mm);
  EXPECT_EQ(a.self_overlap.where, b.self_overlap.where);
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.shape, b.shape);
  EXPECT_EQ(a.shape_fingerprint, b.shape_fingerprint);
  EXPECT_EQ(a.physical.unstable_modes, b.physical.unstable_modes);
  EXPECT_EQ(a.physical.buckled_mm, b.physical.buckled_mm);
  EXPECT_EQ(a.physical.snapped_from, b.physical.snapped_from);
  EXPECT_EQ(a.physical.residual_N, b.physical.residual_N);
  EXPECT_EQ(a.physical.pull_N, b.physical.pull_N);
  ASSERT_EQ(a.forces.stress.has_value(), b.forces.stress.has_value());
  if (a.forces.stress) {
    EXPECT_EQ(a.forces.stress->von_mises.value, b.forces.stress->von_mises.value);
    EXPECT_EQ(a.forces.stress->least.at, b.forces.stress->least.at);
    EXPECT_EQ(a.forces.stress->greatest.region, b.forces.stress->greatest.region);
  }
  ASSERT_EQ(a.forces.reactions.size(), b.forces.reactions.size());
  for (std::size_t i = 0; i < a.forces.reactions.size(); ++i) {
    EXPECT_EQ(a.forces.reactions[i].force, b.forces.reactions[i].force);
    EXPECT_EQ(a.forces.reactions[i].moment, b.forces.reactions[i].moment);
    EXPECT_EQ(a.forces.reactions[i].center, b.forces.reactions[i].center);
    ASSERT_EQ(a.forces.reactions[i].chambers.size(), b.forces.reactions[i].chambers.size());
    for (std::size_t c = 0; c < a.forces.reactions[i].chambers.size(); ++c) {
      EXPECT_EQ(a.forces.reactions[i].chambers[c].actuator, b.forces.reactions[i].chambers[c].actuator);
      EXPECT_EQ(a.forces.reactions[i].chambers[c].force, b.forces.reactions[i].chambers[c].force);
      EXPECT_EQ(a.forces.reactions[i].chambers[c].moment, b.forces.reactions[i].chambers[c].moment);
    }
  }
  ASSERT_EQ(a.forces.contacts.has_value(), b.forces.contacts.has_value());
  for (std::size_t i = 0; a.forces.contacts && i < a.forces.contacts->size(); ++i) {
    const PairForces &one = a.forces.contacts->at(i), &other = b.forces.contacts->at(i);
    EXPECT_EQ(one.a, other.a);
    EXPECT_EQ(one.b, other.b);
    EXPECT_EQ(one.force, other.force);
    EXPECT_EQ(one.moment, other.moment);
    EXPECT_EQ(one.center, other.center);
    EXPECT_EQ(one.normal_N, other.normal_N);
    EXPECT_EQ(one.pressure_kPa, other.pressure_kPa);
    EXPECT_EQ(one.area_mm2, other.area_mm2);
    EXPECT_EQ(one.gap_mm, other.gap_mm);
    EXPECT_EQ(one.slipping, other.slipping);
  }
  ASSERT_EQ(a.actuators.size(), b.actuators.size());
  for (std::size_t i = 0; i < a.actuators.size(); ++i) {
    EXPECT_EQ(a.actuators[i].achieved, b.actuators[i].achieved);
    EXPECT_EQ(a.actuators[i].multiplier, b.actuators[i].multiplier);
    EXPECT_EQ(a.actuators[i].slack, b.actuators[i].slack);
  }
}

template <class Record>
Record read_back(const Codec<Record>& codec, const Record& record) {
  const std::string line = codec.write(record);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  Record read = codec.read(line);
  EXPECT_EQ(codec.write(read), line);
  expect_same(record, read);
  return read;
}

/// Lines that lack something or hold something else.
template <class Record>
void expect_damage_refused(const Codec<Record>& codec, const Record& record, const std::vector<std::string>& keys) {
  const std::string line = codec.write(record);
  const auto refused = [&](const std::string& damaged) {
    EXPECT_THROW((void)codec.read(damaged), InvalidInput) << damaged.substr(0, 80);
  };
  for (const char* other : {"", "{}", "[]", "7", "null", "\"text\""}) refused(other);
  for (std::size_t length = 1; length < line.size(); length += 37) refused(line.substr(0, length));
  for (const std::string& key : keys) {
    const Json::json_pointer at(key);
    ASSERT_TRUE(Json::parse(line).contains(at)) << key;
    Json json = Json::parse(line);
    json[at] = Json::array({"other"});
    refused(json.dump());
    json = Json::parse(line);
    json[at.parent_pointer()].erase(at.back());
    refused(json.dump());
  }
}

const std::vector<std::string> step_keys{"/actuation",
                                         "/actuation/air",
                                         "/status",
                                         "/remark",
                                         "/reached",
                                         "/iterations",
                                         "/seconds",
                                         "/energy",
                                         "/shape_actuation",
                                         "/markers/tip",
                                         "/actuators/air",
                                         "/strain",
                                         "/strain/least",
                                         "/history/iteration",
                                         "/largest_displacement_mm",
                                         "/self_overlap/points",
                                         "/self_overlap/deepest_mm"};

class Steps : public ::testing::Test {
 protected:
  /// The records of a job's first steps.
  template <class Record>
  static std::vector<Record> made(Job<Record>& job) {
    std::vector<Record> records;
    for (std::size_t i = 0; i < job.size(); ++i) records.push_back(job.make(i, {}).record);
    return records;
  }
};

TEST_F(Steps, OfAPathAreReadBack) {
  for (const Model& model : {testing::bending_model(), testing::swelling_model()}) {
    const Statics statics(model);
    const auto steps = testing::steps_of(model, 3);
    PathJob job(statics, steps, "path.csv", testing::one_thread());
    auto records = made(job);
    for (const StepRecord& record : records) {
      EXPECT_EQ(record.status, Status::converged);
      (void)read_back(job.codec(), record);
    }
    EXPECT_EQ(job.mismatch(1, records[1]), "");
    EXPECT_NE(job.mismatch(0, records[1]), "");
    EXPECT_NE(job.mismatch(3, records[1]), "");
    EXPECT_GT(records[2].largest_displacement_mm, 0);
    records[2].self_overlap = {12, 0.1 + 0.2, {1.5, -2, 1e-3}};
    if (model.formulation == Formulation::physical) {
      EXPECT_TRUE(records[2].forces.stress.has_value());
      EXPECT_EQ(records[2].forces.reactions.size(), 1u);
      records[2].forces.reactions[0].chambers = {{0, {0.1 + 0.2, -2, 1e-3}, {1, 2, 3}}};
      records[2].physical.unstable_modes = 2;
      records[2].physical.buckled_mm = 1.5;
      records[2].physical.snapped_from = 0.25;
      expect_damage_refused(
          job.codec(), records[2],
          {"/unstable_modes", "/stress", "/stress/von_mises_MPa/at_mm", "/reactions", "/reactions/0/force_N",
           "/reactions/0/chambers/0/actuator", "/reactions/0/chambers/0/air_force_N", "/residual_N"});
    }
    records[2].shape = "s_0002.vtu";
    records[2].shape_fingerprint = "0123456789abcdef";
    (void)read_back(job.codec(), records[2]);
    expect_damage_refused(job.codec(), records[2], step_keys);
  }
}

TEST_F(Steps, OfMagnetsAreReadBack) {
  const Model model = testing::block_model(
      "softkin: 1\nmesh: {file: block.msh}\nvoid: [chamber]\n"
      "materials: [{youngs_modulus: 1, poisson_ratio: 0.3, remanence: [100, 0, 50]}]\nfixed: [{region: base}]\n"
      "actuators: [{name: field, kind: magnetic, direction: [0, 0, 1], range: [-100, 100]}]\n"
      "markers: [{name: tip, region: tip}]\n");
  const Statics statics(model);
  const auto steps = testing::steps_of(model, 3);
  PathJob job(statics, steps, "path.csv", testing::one_thread());
  const auto records = made(job);
  const StepRecord& last = records.back();
  ASSERT_TRUE(last.forces.magnetic.has_value());
  const StepRecord read = read_back(job.codec(), last);
  EXPECT_EQ(read.forces.magnetic->force, last.forces.magnetic->force);
  EXPECT_EQ(read.forces.magnetic->moment, last.forces.magnetic->moment);
  EXPECT_EQ(read.forces.magnetic->center, last.forces.magnetic->center);
  expect_damage_refused(job.codec(), last, {"/magnetic", "/magnetic/moment_N_mm", "/magnetic/center_mm"});
}

/// Friction continues from its last state.
TEST_F(Steps, OfWhatRubsKeepWhereItSticks) {
  const Model model = testing::block_model(
      "softkin: 1\nmesh: {file: block.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
      "fixed: [{region: base}]\nactuators:\n"
      "  - {name: air, kind: pneumatic, region: chamber, control: volume, range: [0.5, 3]}\n"
      "markers: [{name: tip, region: tip}]\ncontact: {distance: 0.1, friction: 0.4}\n"
      "obstacles: [{name: floor, halfspace: {point: [0, 0, -0.05], normal: [0, 0, 1]}}]\n");
  const Statics statics(model);
  const auto steps = testing::steps_of(model, 3);
  PathJob job(statics, steps, "path.csv", testing::one_thread());
  const auto records = made(job);
  const StepRecord& last = records.back();
  ASSERT_EQ(last.status, Status::converged);
  ASSERT_FALSE(last.anchors.empty());
  const State known = state_of(model, read_back(job.codec(), last), model.rest);
  ASSERT_EQ(known.anchors.size(), last.anchors.size());
  StepRecord agreed = last;
  agreed.physical.friction_change = 3e-5;
  EXPECT_EQ(read_back(job.codec(), agreed).physical.friction_change, 3e-5);
  for (std::size_t i = 0; i < known.anchors.size(); ++i) {
    EXPECT_EQ(known.anchors[i].vertex, last.anchors[i].vertex);
    EXPECT_EQ(known.anchors[i].part, last.anchors[i].part);
    EXPECT_EQ(known.anchors[i].triangle, last.anchors[i].triangle);
    EXPECT_EQ(known.anchors[i].weights, last.anchors[i].weights);
    EXPECT_EQ(known.anchors[i].slipped_mm, last.anchors[i].slipped_mm);
  }
  for (const char* other :
       {"[]", "[[0, 0, 99999, 1, 0, 0, 0]]", "[[-1, 1, 0, 1, 0, 0, 0]]", "[[0, 9, 0, 1, 0, 0, 0]]"}) {
    Json json = Json::parse(job.codec().write(last));
    json["anchors"] = Json::parse(other);
    if (json["anchors"].empty())
      EXPECT_TRUE(job.codec().read(json.dump()).anchors.empty());
    else
      EXPECT_THROW((void)job.codec().read(json.dump()), InvalidInput) << other;
  }
}

TEST_F(Steps, KeepWhatTouches) {
  for (const double height : {-0.1, -2.0}) {
    const Model model = testing::leaning_model(height);
    const Statics statics(model);
    const std::vector<ActuationStep> steps{{model.rest_actuation()}};
    PathJob job(statics, steps, "path.csv", testing::one_thread());
    auto records = made(job);
    ASSERT_TRUE(records[0].forces.contacts.has_value());
    ASSERT_EQ(records[0].forces.contacts->size(), height > -1 ? 1u : 0u);
    const Json json = Json::parse(job.codec().write(records[0]));
    (void)read_back(job.codec(), records[0]);
    int contacts = 0, untouched = 0;
    for (const Finding& each : findings(model, records[0])) {
      contacts += std::holds_alternative<finding::Contact>(each);
      untouched += std::holds_alternative<finding::Untouched>(each);
    }
    EXPECT_EQ(contacts, height > -1 ? 1 : 0);
    EXPECT_EQ(untouched, height > -1 ? 0 : 1);
    if (height < -1) {
      EXPECT_EQ(json.at("contacts"), Json::array());
      continue;
    }
    EXPECT_EQ(json.at("/contacts/0/on"_json_pointer), "robot");
    EXPECT_EQ(json.at("/contacts/0/by"_json_pointer), "floor");
    EXPECT_FALSE(json.at("/contacts/0"_json_pointer).contains("slipping"));
    EXPECT_EQ(json.at("/contacts/0/pressure_kPa"_json_pointer), records[0].forces.contacts->at(0).pressure_kPa);
    expect_damage_refused(job.codec(), records[0],
                          {"/contacts", "/contacts/0/on", "/contacts/0/by", "/contacts/0/force_N",
                           "/contacts/0/moment_N_mm", "/contacts/0/center_mm", "/contacts/0/normal_N",
                           "/contacts/0/pressure_kPa", "/contacts/0/area_mm2", "/contacts/0/gap_mm"});
    records[0].forces.contacts->at(0).slipping = 0.25;
    (void)read_back(job.codec(), records[0]);
  }
}

TEST_F(Steps, ThatDidNotConvergeKeepWhatIsNotKnown) {
  const Model model = testing::bending_model();
  const Statics statics(model);
  const auto steps = testing::steps_of(model, 1);
  PathJob job(statics, steps, "path.csv", testing::one_thread());
  StepRecord record = job.make(0, {}).record;
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  record.status = Status::not_converged;
  record.reached_fraction.reset();
  record.shape_actuation.reset();
  record.time_s.reset();
  record.gradient_norm = record.energy = unknown;
  record.remark = "it \"blew up\"\nin two lines";
  const StepRecord read = read_back(job.codec(), record);
  EXPECT_TRUE(std::isnan(read.gradient_norm) && std::isnan(read.energy));
}

TEST_F(Steps, LongHistoriesAreWrittenEverSparser) {
  const Model model = testing::bending_model();
  const Statics statics(model);
  const auto steps = testing::steps_of(model, 1);
  PathJob job(statics, steps, "path.csv", testing::one_thread());
  StepRecord record = job.make(0, {}).record;
  record.history.assign(10000, {1.23456789, 2, 3});
  const StepRecord read = read_back(job.codec(), record);
  EXPECT_LT(read.history.size(), 400u);
  EXPECT_EQ(read.history_iterations.size(), read.history.size());
  EXPECT_EQ(read.history[0].energy, 1.23457);
}

TEST_F(Steps, OfAFollowedPathAreReadBack) {
  const Model model = testing::bending_model();
  const MarkerPath path = testing::path_through(model, testing::steps_of(model, 3));
  const Statics statics(model);
  TrajectoryOptions options;
  options.inverse.statics = testing::one_thread();
  FollowJob job(statics, path, "path.csv", options);
  const auto records = made(job);
  for (const WaypointRecord& record : records) {
    EXPECT_TRUE(record.is_reached());
    const WaypointRecord read = read_back(job.codec(), record);
    EXPECT_EQ(read.requested.targets, record.requested.targets);
    EXPECT_EQ(read.end, record.end);
    EXPECT_EQ(read.error_mm, record.error_mm);
    EXPECT_EQ(read.equilibria, record.equilibria);
  }
  EXPECT_EQ(job.mismatch(2, records[2]), "");
  EXPECT_NE(job.mismatch(1, records[2]), "");
  auto keys = step_keys;
  keys.insert(keys.end(), {"/waypoint", "/waypoint/targets/tip", "/waypoint/status", "/waypoint/equilibria"});
  expect_damage_refused(job.codec(), records[2], keys);
}

TEST_F(Steps, OfAWalkAreReadBack) {
  const Model model = testing::walking_model();
  const auto gait =
      repeated(model, "gait.csv", {{Actuation::Zero(1), 0.0}, {Actuation::Ones(1), 0.5}, {Actuation::Zero(1), 1.0}}, 2);
  Walker walker(model, testing::one_thread());
  WalkJob job(model, walker, gait, "gait.csv");
  const auto records = made(job);
  ASSERT_EQ(records.size(), 5u);
  EXPECT_NE(records.back().walk.travel_mm, 0);
  for (const WalkRecord& record : records) {
    const WalkRecord read = read_back(job.codec(), record);
    EXPECT_EQ(read.cycle, record.cycle);
    EXPECT_EQ(read.walk.sliding, record.walk.sliding);
    for (const auto member :
         {&WalkStep::friction_N, &WalkStep::rear_mm, &WalkStep::front_mm, &WalkStep::travel_mm, &WalkStep::shift_mm})
      EXPECT_EQ(read.walk.*member, record.walk.*member);
  }
  EXPECT_EQ(job.mismatch(4, records[4]), "");
  EXPECT_NE(job.mismatch(3, records[4]), "");
  expect_damage_refused(job.codec(), records[4],
                        {"/actuation/tendon", "/status", "/walk", "/walk/cycle", "/walk/sliding", "/walk/friction_N",
                         "/walk/feet_mm/heel", "/walk/travel_mm", "/walk/shift_mm"});
}

}  // namespace
}  // namespace softkin::runs
