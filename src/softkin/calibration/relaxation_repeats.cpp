#include <algorithm>
#include <cmath>
#include <softkin/calibration/relaxation_repeats.hpp>

namespace softkin::calibration {

namespace {

const std::vector<double>& imposed_values(const RelaxationRun& run) {
  return run.load_imposed ? run.stress_MPa : run.stretch;
}

const std::vector<double>& answered_values(const RelaxationRun& run) {
  return run.load_imposed ? run.stretch : run.stress_MPa;
}

double distance_from_rest(const RelaxationRun& run, double value) {
  return std::abs(value - (run.load_imposed ? 0 : 1));
}

bool repeat_each_other(const RelaxationRun& a, const RelaxationRun& b) {
  constexpr double same_time = 1e-3, same_value = 1e-2;
  if (a.load_imposed != b.load_imposed || a.time_s.size() != b.time_s.size()) return false;
  double most = 0;
  for (const double value : imposed_values(a)) most = std::max(most, distance_from_rest(a, value));
  for (std::size_t i = 0; i < a.time_s.size(); ++i) {
    const double since = a.time_s[i] - a.time_s[0];
    if (std::abs(b.time_s[i] - b.time_s[0] - since) > same_time * since) return false;
    if (std::abs(imposed_values(a)[i] - imposed_values(b)[i]) > same_value * most) return false;
  }
  return true;
}

}  // namespace

std::optional<Repeats> repeats_of(const std::vector<RelaxationRun>& runs, bool load_imposed) {
  std::vector<std::vector<const RelaxationRun*>> groups;
  for (const RelaxationRun& run : runs) {
    if (run.load_imposed != load_imposed) continue;
    const auto found = std::find_if(groups.begin(), groups.end(),
                                    [&](const auto& group) { return repeat_each_other(*group.front(), run); });
    found == groups.end() ? groups.push_back({&run}) : found->push_back(&run);
  }
  double squares = 0;
  Repeats repeats;
  for (const auto& group : groups) {
    for (std::size_t i = 0; group.size() > 1 && i < group.front()->time_s.size(); ++i) {
      double mean = 0;
      for (const RelaxationRun* run : group) mean += answered_values(*run)[i] / static_cast<double>(group.size());
      for (const RelaxationRun* run : group) squares += std::pow(answered_values(*run)[i] - mean, 2);
      repeats.freedoms += group.size() - 1;
    }
  }
  if (repeats.freedoms == 0) return std::nullopt;
  repeats.deviation = std::sqrt(squares / static_cast<double>(repeats.freedoms));
  return repeats;
}

}  // namespace softkin::calibration
