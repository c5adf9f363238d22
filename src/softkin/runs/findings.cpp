#include <cmath>
#include <softkin/runs/findings.hpp>

namespace softkin::runs {

std::vector<Finding> findings(const Model& model, const StepRecord& record) {
  std::vector<Finding> found;
  const StrainHistogram& strain = record.strain;
  if (!strain.shares.empty())
    found.push_back({Finding::Kind::strain, "", {strain.least, strain.greatest, strain.percentile_95}});
  for (const auto& beyond : strain.beyond)
    found.push_back({Finding::Kind::beyond_linear_range, beyond.region, {beyond.share, beyond.linear_range}});
  if (record.inverted_elements > 0)
    found.push_back({Finding::Kind::inverted, "", {static_cast<double>(record.inverted_elements)}});
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const ActuatorRecord& actuator = record.actuators[a]; actuator.slack)
      found.push_back({Finding::Kind::slack, model.actuators[a].name, {actuator.achieved, actuator.requested}});
  if (model.formulation == Formulation::physical && record.status != Status::converged)
    return found;  // the iteration was of another shape
  if (!std::isfinite(record.step_mm) || !std::isfinite(record.estimated_error_mm))
    found.push_back({Finding::Kind::diverged});
  else
    found.push_back({Finding::Kind::accuracy, "", {record.step_mm, record.estimated_error_mm}});
  return found;
}

std::vector<Shortfall> shortfalls(const Model& model, const StepRecord& record) {
  std::vector<Shortfall> short_of;
  if (!record.shape_actuation) return short_of;
  for (Index a = 0; a < static_cast<Index>(model.actuators.size()); ++a)
    if ((*record.shape_actuation)[a] != record.actuation[a])
      short_of.push_back({a, (*record.shape_actuation)[a], record.actuation[a]});
  return short_of;
}

}  // namespace softkin::runs
