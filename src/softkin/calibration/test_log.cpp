#include <nlohmann/json.hpp>
#include <softkin/calibration/test_log.hpp>
#include <softkin/core/error.hpp>
#include <softkin/model/names.hpp>
#include <softkin/runs/records_json.hpp>
#include <softkin/runs/store.hpp>

namespace softkin::calibration {

namespace {

using runs::known;
using runs::number_or_nan;
using runs::status_of;

std::string line_of(const std::string& test, const SpecimenFit& fit) {
  const SpecimenResponse& r = fit.response;
  return runs::line_of({{"test", test},
                        {"status", name_of(fit.status)},
                        {"remark", fit.remark},
                        {"own_log_ratio", known(fit.own_log_ratio)},
                        {"sensitivity_mm", known(fit.sensitivity_mm)},
                        {"simulations", fit.simulations},
                        {"moved_mm", known(r.moved_mm)},
                        {"turned_deg", known(r.turned_deg)},
                        {"force_n", known(r.force_n)},
                        {"response_status", name_of(r.status)},
                        {"response_remark", r.remark}});
}

SpecimenFit fit_of(const Json& json) {
  SpecimenFit fit;
  fit.status = status_of(json.at("status"));
  fit.remark = json.at("remark");
  fit.own_log_ratio = number_or_nan(json.at("own_log_ratio"));
  fit.sensitivity_mm = number_or_nan(json.at("sensitivity_mm"));
  fit.simulations = json.at("simulations");
  fit.response = {status_of(json.at("response_status")), json.at("response_remark"), number_or_nan(json.at("moved_mm")),
                  number_or_nan(json.at("turned_deg")), number_or_nan(json.at("force_n"))};
  return fit;
}

}  // namespace

TestLog::TestLog(const std::filesystem::path& path, const std::string& set_up, bool resume)
    : store_(std::make_unique<runs::Store>(path, set_up + "\n", resume)) {
  if (store_->head() != set_up + "\n")
    throw InvalidInput({path.string()}, "cannot go on from this journal: it is of other specimens, options or softkin");
  store_->each([&](std::size_t number, std::string_view line) {
    try {
      const Json json = parse_json(line);
      done_[json.at("test")] = fit_of(json);
    } catch (const std::exception& error) {
      throw InvalidInput({.file = path.string(), .line = number + 2},
                         std::string("cannot go on from this journal: ") + error.what());
    }
    return true;
  });
}

TestLog::~TestLog() = default;

SpecimenFit TestLog::once(const std::string& test, const std::function<SpecimenFit()>& make) {
  if (const auto found = done_.find(test); found != done_.end()) return found->second;
  const SpecimenFit fit = make();
  if (fit.status == Status::interrupted || fit.response.status == Status::interrupted) return fit;
  store_->append(line_of(test, fit));
  return done_[test] = fit;
}

void TestLog::remove() {
  store_->remove();
}

}  // namespace softkin::calibration
