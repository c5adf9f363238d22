#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "random/runs.hpp"

namespace softkin::random_robots {

namespace {

/// A message without names and numbers.
std::string kind_of(const std::string& message) {
  std::string kind;
  bool quoted = false;
  for (const char c : message) {
    if (c == '\'') quoted = !quoted;
    if (quoted) continue;
    if (std::isdigit(static_cast<unsigned char>(c)) == 0)
      kind += c;
    else if (kind.empty() || kind.back() != '#')
      kind += '#';
  }
  if (const auto begin = kind.find(": "); begin != std::string::npos && kind.compare(0, 6, "random") == 0)
    kind.erase(0, begin + 2);
  // numbers with a point, an exponent or a sign are one number
  for (const char* mark : {"#.#", "#e-#", "#e+#", "-#"})
    for (auto at = kind.find(mark); at != std::string::npos; at = kind.find(mark))
      kind.replace(at, std::char_traits<char>::length(mark), "#");
  return kind.substr(0, 90);
}

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string csv_field(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '"') text.insert(i++, 1, '"');
  return '"' + text + '"';
}

}  // namespace

void Summary::add(const RunResult& run) {
  ++runs_;
  ++by_formulation_[run.physical ? 0 : 1].of[static_cast<int>(run.outcome)];
  if (run.sensible) {
    ++sensible_;
    ++of_sensible_.of[static_cast<int>(run.outcome)];
  }
  confirmed_ += run.confirmed;
  blurred_ += run.blurred;
  undecided_ += run.undecided;
  unstable_ += run.unstable;
  inverted_ += run.inverted;
  for (const Effort& effort : run.efforts) {
    for (std::size_t i = 0; i < effort.of.size(); ++i) efforts_[i].emplace_back(effort.of[i], run.seed);
    if (effort.of[0] > long_path) long_ways_[kind_of(effort.end)].push_back(run.seed);
    for (const auto& [why, times] : effort.rejections)
      rejections_.try_emplace(why, 0, run.seed).first->second.first += times;
  }
  total_seconds_ += run.seconds;
  seconds_.enter(run.seconds, run.seed);
  if (run.outcome == Outcome::refused) {
    auto& [count, seed] = refusals_.try_emplace(kind_of(run.message), 0, run.seed).first->second;
    ++count;
  }
  if (run.outcome == Outcome::failed) {
    failures_.push_back(run);
    return;
  }
  residual_.enter(run.residual_ratio, run.seed);
  constraint_.enter(run.constraint_error, run.seed);
  step_.enter(run.step_ratio, run.seed);
}

std::string Summary::text() const {
  std::string text = line("%-16s %10s %14s %10s\n", "outcome", "physical", "target-shape", "sensible");
  for (int i = 0; i < outcomes; ++i)
    text += line("%-16s %10zu %14zu %10zu\n", name_of(static_cast<Outcome>(i)), by_formulation_[0].of[i],
                 by_formulation_[1].of[i], of_sensible_.of[i]);
  text += line(
      "%zu runs, %zu of sensible robots; %zu with an equilibrium that was checked, %zu of them where rounding of "
      "coordinates could hide much, %zu where a best rotation is not unique; %zu unstable, %zu with inverted "
      "elements\n",
      runs_, sensible_, confirmed_, blurred_, undecided_, unstable_, inverted_);
  const auto extreme = [&](const char* what, const Extreme& most) {
    text += line("%-60s %9.2g  seed %llu\n", what, most.value, static_cast<unsigned long long>(most.seed));
  };
  extreme("largest residual over the largest force at a vertex [-]", residual_);
  extreme("largest miss of a volume or length over what was asked [-]", constraint_);
  extreme("largest step of Algorithm 1 over the tolerance [-]", step_);
  extreme("slowest run [s]", seconds_);
  text += line("%.1f s in all runs together\n", total_seconds_);
  if (!refusals_.empty()) text += "refused:\n";
  for (const auto& [kind, found] : refusals_)
    text += line("%6zu  %s  (seed %llu)\n", found.first, kind.c_str(), static_cast<unsigned long long>(found.second));
  for (const RunResult& failure : failures_)
    text += "FAILED  seed " + std::to_string(failure.seed) + ": " + failure.message + "\n";
  return text;
}

namespace {

/// Of values in ascending order.
std::pair<int, std::uint64_t> quantile(const std::vector<std::pair<int, std::uint64_t>>& sorted, double fraction) {
  if (sorted.empty()) return {};
  const double place = std::ceil(fraction * static_cast<double>(sorted.size())) - 1;
  return sorted[std::max(0.0, place)];
}

}  // namespace

int Summary::iterations_of(double fraction) const {
  auto sorted = efforts_[0];
  std::sort(sorted.begin(), sorted.end());
  return quantile(sorted, fraction).first;
}

std::string Summary::effort_text() const {
  constexpr std::size_t shown = 10;
  std::string text = line("of %zu solves %10s %8s %8s %8s  seed of the last, and of those before\n", efforts_[0].size(),
                          "median", "90 %", "99 %", "all");
  for (std::size_t i = 0; i < efforts_.size(); ++i) {
    auto sorted = efforts_[i];
    std::sort(sorted.begin(), sorted.end());
    text += line("%-14s", Effort::names[i]);
    for (const double fraction : {0.5, 0.9, 0.99, 1.0}) text += line(" %8d", quantile(sorted, fraction).first);
    text += " ";
    for (std::size_t k = 0; k < std::min(shown, sorted.size()); ++k)
      text += " " + std::to_string(sorted[sorted.size() - 1 - k].second);
    text += "\n";
  }
  for (const auto& [end, seeds] : long_ways_) {
    text += line("%6zu solves of more than %d iterations: %s (seeds", seeds.size(), long_path, end.c_str());
    for (std::size_t i = 0; i < std::min(shown, seeds.size()); ++i) text += " " + std::to_string(seeds[i]);
    text += ")\n";
  }
  for (const auto& [why, found] : rejections_)
    text += line("%6zu steps not taken: %s (seed %llu)\n", found.first, why.c_str(),
                 static_cast<unsigned long long>(found.second));
  return text;
}

std::string Summary::failure_table() const {
  std::string text = "seed,formulation,features,fault\n";
  for (const RunResult& failure : failures_)
    text += std::to_string(failure.seed) + (failure.physical ? ",physical," : ",target-shape,") +
            csv_field(failure.sensible ? "sensible" : failure.features) + "," + csv_field(failure.message) + "\n";
  return text;
}

}  // namespace softkin::random_robots
