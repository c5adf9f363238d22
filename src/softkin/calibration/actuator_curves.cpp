#include <algorithm>
#include <cmath>
#include <map>
#include <softkin/calibration/actuator_curves.hpp>
#include <softkin/core/dense.hpp>
#include <softkin/core/error.hpp>
#include <softkin/core/types.hpp>
#include <string>
#include <utility>

namespace softkin::calibration {

namespace {

constexpr std::size_t max_points = 15, samples_per_point = 4, window_samples = 8;
constexpr double anchor_fraction = 0.05, continue_fraction = 0.02;  // of a branch's range of inputs

using Samples = std::vector<std::pair<double, double>>;  // input, ratio; ascending

/// Equal inputs become one sample.
Samples merged(const Samples& samples) {
  Samples result;
  std::vector<double> counts;
  const double equal = 1e-9 * (samples.back().first - samples.front().first);
  for (const auto& [input, ratio] : samples) {
    if (!result.empty() && input - result.back().first <= equal) {
      result.back().second += (ratio - result.back().second) / ++counts.back();
      continue;
    }
    result.emplace_back(input, ratio);
    counts.push_back(1);
  }
  return result;
}

/// Weighted least squares around x: a parabola, or a straight line where the samples are too few.
double local_fit(const Samples& samples, double x, double width) {
  std::vector<double> distances;
  for (const auto& [input, ratio] : samples) distances.push_back(std::abs(input - x));
  std::vector<double> sorted = distances;
  const std::size_t enough = std::min(window_samples, sorted.size()) - 1;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(enough), sorted.end());
  const double window = std::max(width, 1.001 * sorted[enough]);
  std::vector<std::size_t> inside;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (distances[i] < window) inside.push_back(i);
  const Eigen::Index terms = inside.size() >= 5 ? 3 : inside.size() >= 2 ? 2 : 1;
  Eigen::MatrixXd a(inside.size(), terms);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    const auto& [input, ratio] = samples[inside[row]];
    const double u = (input - x) / window, bump = 1 - std::abs(u * u * u), weight = std::sqrt(bump * bump * bump);
    for (Eigen::Index term = 0; term < terms; ++term) a(row, term) = weight * std::pow(u, static_cast<double>(term));
    b[row] = weight * ratio;
  }
  return least_squares(a, b).solution[0];
}

/// The places of a branch's points.
std::vector<double> places_of(const Samples& samples, Branch branch) {
  std::vector<double> places;
  const double low = samples.front().first, high = samples.back().first, range = high - low;
  const Samples distinct = merged(samples);
  if (distinct.size() <= max_points) {
    for (const auto& [input, ratio] : distinct) places.push_back(input);
    return places;
  }
  const double fraction = branch == Branch::loading ? anchor_fraction : continue_fraction;
  const double begin = std::abs(low) <= fraction * range ? 0 : low;
  const std::size_t count = std::clamp<std::size_t>(samples.size() / samples_per_point, 5, max_points);
  for (std::size_t k = 0; k < count; ++k)
    places.push_back(begin + (high - begin) * static_cast<double>(k) / static_cast<double>(count - 1));
  return places;
}

std::vector<double> values_at(const Samples& samples, const std::vector<double>& places) {
  const Samples distinct = merged(samples);
  std::vector<double> values;
  if (distinct.size() == places.size() && distinct.size() <= max_points) {
    for (const auto& [input, ratio] : distinct) values.push_back(ratio);
    return values;
  }
  const double width = 2 * (places.back() - places.front()) / static_cast<double>(places.size() - 1);
  for (const double place : places) values.push_back(local_fit(samples, place, width));
  return values;
}

struct Block {
  double x = 0, y = 0;
  std::size_t count = 1;
};

/// Pools neighbours that do not ascend; pinned: the first value stays as it is.
std::vector<Block> isotonic(const std::vector<double>& x, const std::vector<double>& y, bool pinned) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < x.size(); ++i) {
    blocks.push_back({x[i], y[i], 1});
    while (blocks.size() > 1) {
      Block &low = blocks[blocks.size() - 2], &high = blocks.back();
      if (high.y > low.y) break;
      const auto m = static_cast<double>(low.count), n = static_cast<double>(high.count);
      const bool first = pinned && blocks.size() == 2;
      const bool begins = blocks.size() == 2, ends = i + 1 == x.size();
      low.y = first ? low.y : (m * low.y + n * high.y) / (m + n);
      low.x = begins ? low.x : ends ? high.x : (m * low.x + n * high.x) / (m + n);
      low.count += high.count;
      blocks.pop_back();
    }
  }
  return blocks;
}

class BranchFit {
 public:
  BranchFit(const std::vector<CurveSample>& samples, Branch branch) : branch_(branch) {
    for (const CurveSample& sample : samples) {
      if (sample.branch != branch) continue;
      samples_.emplace_back(sample.input, sample.ratio);
      repeats_[sample.repeat].emplace_back(sample.input, sample.ratio);
    }
    std::sort(samples_.begin(), samples_.end());
    for (auto& [number, repeat] : repeats_) std::sort(repeat.begin(), repeat.end());
  }

  [[nodiscard]] bool empty() const { return samples_.empty(); }

  std::pair<CurveBranch, BranchQuality> fit() {
    const std::string name = std::string("the ") + branch_name(branch_) + " branch";
    if (samples_.front().first == samples_.back().first)
      throw InvalidInput(name + " has rows of one input alone: that is no curve");
    const std::vector<double> places = places_of(samples_, branch_);
    std::vector<double> values = values_at(samples_, places);
    const double range = places.back() - places.front();
    const bool pinned = branch_ == Branch::loading && std::abs(places.front()) <= 1e-9 * range;
    if (pinned) values.front() = 1;
    std::vector<double> x, y;
    for (const Block& block : isotonic(places, values, pinned)) {
      x.push_back(block.x);
      y.push_back(block.y);
    }
    if (x.size() < 2) throw InvalidInput(name + ": the ratio does not rise with the input");
    quality_.pooled = places.size() - x.size();
    CurveBranch result{MonotoneCurve(x, y), spread(x)};
    judge(result.ratio);
    return {std::move(result), quality_};
  }

 private:
  /// Standard deviation between repeats at each place; the largest one where fewer than two repeats reach.
  std::vector<double> spread(const std::vector<double>& places) {
    quality_.repeats = repeats_.size();
    std::vector<double> result(places.size(), -1);
    double largest = -1, error = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
      std::vector<double> values;
      const double width = 2 * (places.back() - places.front()) / static_cast<double>(places.size() - 1);
      for (const auto& [number, repeat] : repeats_) {
        const double margin = anchor_fraction * (places.back() - places.front());
        if (repeat.size() < 2 || places[k] < repeat.front().first - margin || places[k] > repeat.back().first + margin)
          continue;
        values.push_back(local_fit(repeat, places[k], width));
      }
      if (values.size() < 2) continue;
      double mean = 0, squares = 0;
      for (const double value : values) mean += value / static_cast<double>(values.size());
      for (const double value : values) squares += (value - mean) * (value - mean);
      result[k] = std::sqrt(squares / static_cast<double>(values.size() - 1));
      largest = std::max(largest, result[k]);
      error = std::max(error, result[k] / std::sqrt(static_cast<double>(values.size())));
    }
    if (largest < 0) return {};
    quality_.mean_error = error;
    for (double& each : result)
      if (each < 0) each = largest;
    return result;
  }

  void judge(const MonotoneCurve& curve) {
    double squares = 0;
    for (const auto& [input, ratio] : samples_) {
      const double place = std::clamp(input, curve.x().front(), curve.x().back());
      const double distance = std::abs(ratio - curve.value(place));
      squares += distance * distance;
      quality_.largest = std::max(quality_.largest, distance);
    }
    quality_.samples = samples_.size();
    quality_.rms = std::sqrt(squares / static_cast<double>(samples_.size()));
  }

  Branch branch_;
  Samples samples_;
  std::map<std::size_t, Samples> repeats_;
  BranchQuality quality_;
};

}  // namespace

CurveFit fit_curve(const std::vector<CurveSample>& samples) {
  BranchFit loading(samples, Branch::loading), unloading(samples, Branch::unloading);
  if (loading.empty()) throw InvalidInput("no row belongs to a loading sweep");
  auto [curve, quality] = loading.fit();
  CurveFit fit{std::move(curve), std::nullopt, quality, {}};
  if (unloading.empty()) return fit;
  auto [other, other_quality] = unloading.fit();
  fit.unloading = std::move(other);
  fit.unloading_quality = other_quality;
  return fit;
}

}  // namespace softkin::calibration
