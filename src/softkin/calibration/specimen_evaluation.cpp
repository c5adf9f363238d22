#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <softkin/calibration/specimen_evaluation.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/core/version.hpp>
#include <softkin/io/json_text.hpp>
#include <softkin/model/names.hpp>
#include <utility>

namespace softkin::calibration {

namespace {

/// How a simulated tensile test of a specimen ended, and why.
std::pair<Status, std::string> end_of(const SimulatedTests& tests, std::size_t specimen) {
  if (tests.fit) return {tests.fit->specimens[specimen].status, tests.fit->specimens[specimen].remark};
  return {tests.stretched[specimen].status, tests.stretched[specimen].remark};
}

}  // namespace

const RatioFit* SpecimenResults::fit(Formulation formulation) const {
  for (const SimulatedTests& tests : simulated)
    if (tests.is(formulation)) return &*tests.fit;
  return nullptr;
}

std::vector<std::string> set_up_lines(const SpecimenTask& task,
                                      const std::function<std::string(const std::string&)>& remark) {
  const SpecimenOptions& s = task.options;
  std::vector<std::string> lines{
      "cross-section " + number(s.width_mm) + " x " + number(s.height_mm) + " mm" + remark("--width"),
      std::string("ends ") + (s.grip == Grip::sliding ? "sliding" : "clamped") + remark("--grip")};
  const auto cells = [&](Formulation formulation) {
    return std::to_string(cells_across(s, formulation)) + " cells across the height" + remark("--cells");
  };
  if (task.physical)
    lines.push_back(std::string("physical: law ") + law_name(s.law) + remark("--law") + ", Poisson's ratio " +
                    number(s.poisson_ratio) + remark("--poisson-ratio") + ", " + cells(Formulation::physical));
  if (task.target_shape)
    lines.push_back("target-shape: R_omega " + number(s.stiffer_shape_ratio, 4) + " of the stiffer material" +
                    remark("--stiffer") + ", " + cells(Formulation::target_shape));
  return lines;
}

void check_modulus_b(const SpecimenTask& task, const std::vector<StretchedSpecimen>& specimens) {
  const bool forces =
      std::any_of(specimens.begin(), specimens.end(), [](const auto& s) { return s.force_n.has_value(); });
  if (task.modulus_b && forces)
    throw InvalidInput("a modulus of B is for specimens without a force, but " + task.file +
                       " has a column of it: leave out one of the two");
}

std::string doubt_about_areas(const SpecimenTask& task, const std::vector<StretchedSpecimen>& specimens) {
  constexpr double most = 0.05;
  const double simulated = task.options.width_mm * task.options.height_mm;
  for (const StretchedSpecimen& s : specimens)
    if (s.area_mm2 && std::abs(*s.area_mm2 / simulated - 1) > most)
      return Origin{.file = task.file, .line = s.line}.text() + ": note: the area is " + number(*s.area_mm2) +
             " mm^2, but the simulated cross-section has " + number(simulated) + "; its width and height set it";
  return "";
}

std::string tests_set_up(const SpecimenTask& task, const std::vector<StretchedSpecimen>& specimens,
                         const std::vector<TwistedSpecimen>& twists) {
  const SpecimenOptions& o = task.options;
  Json json{{"softkin", version()},
            {"width_mm", o.width_mm},
            {"height_mm", o.height_mm},
            {"cells", o.cells},
            {"clamped", o.grip == Grip::clamped},
            {"law", law_name(o.law)},
            {"poisson_ratio", o.poisson_ratio},
            {"stiffer_shape_ratio", o.stiffer_shape_ratio}};
  for (const StretchedSpecimen& s : specimens)
    json["stretched"].push_back({s.length_mm, s.interface_mm, s.stretch_mm, s.interface_moved_mm});
  for (const TwistedSpecimen& s : twists) json["twisted"].push_back({s.length_mm, s.interface_mm, s.twist_deg});
  return json.dump();
}

std::size_t number_of_tests(const SpecimenTask& task, std::size_t specimens, std::size_t twists) {
  const std::size_t formulations = (task.physical ? 1 : 0) + (task.target_shape ? 1 : 0);
  return formulations * (2 * specimens + twists) + (task.target_shape ? task.tried.size() : 0) * (specimens + twists);
}

SpecimenResults evaluate(const SpecimenTask& task, std::vector<StretchedSpecimen> specimens,
                         std::vector<TwistedSpecimen> twists,
                         const std::function<void(const std::string&, double)>& progress) {
  const auto reported = [&](const std::string& what) -> FractionDone {
    if (!progress) return {};
    return [&progress, what](double fraction) { progress(what, fraction); };
  };
  SpecimenResults results{std::move(specimens), std::move(twists), {}, {}, {}, false};
  results.rod = rod_ratio(results.specimens);
  results.rod_moduli = rod_moduli(results.specimens, task.options.width_mm * task.options.height_mm);
  const auto add = [&](SimulatedTests tests) {
    const auto stopped = [](const std::vector<SpecimenResponse>& responses) {
      return !responses.empty() && responses.back().status == Status::interrupted;
    };
    results.interrupted =
        stopped(tests.stretched) || stopped(tests.twisted) || (tests.fit && tests.fit->status == Status::interrupted);
    results.simulated.push_back(std::move(tests));
  };
  const auto fit = [&](Formulation formulation) {
    SimulatedTests tests{formulation_name(formulation), {}, 1, {}, {}};
    tests.fit = fit_ratio(results.specimens, task.options, formulation, reported(tests.name + " tensile tests"));
    tests.ratio = tests.fit->estimate.ratio;
    for (const SpecimenFit& each : tests.fit->specimens) tests.stretched.push_back(each.response);
    if (tests.fit->status != Status::interrupted && tests.fit->estimate.specimens > 0)
      tests.twisted = predict(results.twists, task.options, formulation, std::log(tests.ratio),
                              reported(tests.name + " twist tests"));
    add(std::move(tests));
  };
  if (task.physical) fit(Formulation::physical);
  if (task.target_shape && !results.interrupted) fit(Formulation::target_shape);
  for (const double ratio : task.tried) {
    if (!task.target_shape || results.interrupted) break;
    const auto predicted = [&](const auto& tests) {
      return predict(tests, task.options, Formulation::target_shape, std::log(ratio), reported("ratios to try"));
    };
    add({"R_A / R_B " + number(ratio), std::nullopt, ratio, predicted(results.specimens), predicted(results.twists)});
  }
  return results;
}

std::string failure(const SpecimenTask& task, const SpecimenResults& results) {
  const auto words = [](const std::string& file, std::size_t line, const std::string& what, Status status,
                        const std::string& remark) {
    return file + ":" + std::to_string(line) + ": the simulated " + what + " test has status " + name_of(status) +
           (remark.empty() ? "" : ": " + remark);
  };
  for (const SimulatedTests& tests : results.simulated) {
    const std::string name = tests.fit ? tests.name : "tried";
    for (std::size_t i = 0; i < results.specimens.size(); ++i)
      if (const auto [status, remark] = end_of(tests, i); status != Status::converged)
        return words(task.file, results.specimens[i].line, name + " tensile", status, remark);
    for (std::size_t i = 0; i < tests.twisted.size(); ++i)
      if (tests.twisted[i].status != Status::converged)
        return words(task.twist_file, results.twists[i].line, name + " twist", tests.twisted[i].status,
                     tests.twisted[i].remark);
  }
  return "";
}

}  // namespace softkin::calibration
