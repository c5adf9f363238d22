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

constexpr std::size_t most_points = 15, samples_per_point = 4, window_samples = 8;
constexpr double anchor_share = 0.05, continue_share = 0.02;  // of a branch's range of inputs

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
  Eigen::MatrixXd a(static_cast<Eigen::Index>(inside.size()), terms);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    const auto& [input, ratio] = samples[inside[static_cast<std::size_t>(row)]];
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
  if (distinct.size() <= most_points) {
    for (const auto& [input, ratio] : distinct) places.push_back(input);
    return places;
  }
  const double share = branch == Branch::loading ? anchor_share : continue_share;
  const double begin = std::abs(low) <= share * range ? 0 : low;
  const std::size_t count = std::clamp<std::size_t>(samples.size() / samples_per_point, 5, most_points);
  for (std::size_t k = 0; k < count; ++k)
    places.push_back(begin + (high - begin) * static_cast<double>(k) / static_cast<double>(count - 1));
  return places;
}

std::vector<double> values_at(const Samples& samples, const std::vector<double>& places) {
  const Samples distinct = merged(samples);
  std::vector<double> values;
  if (distinct.size() == places.size() && distinct.size() <= most_points) {
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
        const double margin = anchor_share * (places.back() - places.front());
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

constexpr double chain_share = 0.95;  // of a Gent chain's limit at which a curve without pull-in ends
constexpr int scan_steps = 20000;
constexpr double farthest_stretch = 100;  // over the prestretch; a neo-hookean maximum lies before it

/// eps in MPa per (kV/mm)^2.
double permittivity(const Dielectric& d) {
  constexpr double pascal_per_square_field = 1e12, mpa_per_pascal = 1e-6;
  return d.relative_permittivity * vacuum_permittivity * pascal_per_square_field * mpa_per_pascal;
}

double invariant(double l) {
  return 2 * l * l + std::pow(l, -4) - 3;
}

/// Gent's stiffening and its derivative by the stretch.
struct Stiffening {
  double value = 1, slope = 0;
};

Stiffening stiffening(const Dielectric& d, double l) {
  if (d.law == DielectricLaw::neo_hookean) return {};
  const double value = d.stretch_limit / (d.stretch_limit - invariant(l));
  return {value, value * value * (4 * l - 4 * std::pow(l, -5)) / d.stretch_limit};
}

/// Force per undeformed section that stretches it to the prestretch, over the shear modulus.
double nominal_stress(const Dielectric& d) {
  const double p = d.prestretch;
  return stiffening(d, p).value * (p - std::pow(p, -5));
}

/// eps (U/H)^2 / mu, and its derivative by the stretch.
double drive(const Dielectric& d, double l) {
  return stiffening(d, l).value * (std::pow(l, -2) - std::pow(l, -8)) - nominal_stress(d) * std::pow(l, -3);
}

double drive_slope(const Dielectric& d, double l) {
  const Stiffening g = stiffening(d, l);
  return g.slope * (std::pow(l, -2) - std::pow(l, -8)) + g.value * (-2 * std::pow(l, -3) + 8 * std::pow(l, -9)) +
         3 * nominal_stress(d) * std::pow(l, -4);
}

/// The stretch between low and high at which a function that is positive at low turns negative.
template <class Function>
double falling_root(double low, double high, const Function& f) {
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) > 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Stretch at which the chains are so near to their limit.
double chain_end(const Dielectric& d) {
  const double most = std::sqrt((d.stretch_limit + 3) / 2);
  return falling_root(1, most, [&](double l) { return chain_share * d.stretch_limit - invariant(l); });
}

double last_stretch(const Dielectric& d) {
  return d.law == DielectricLaw::gent ? chain_end(d) : farthest_stretch * d.prestretch;
}

void check(const Dielectric& d) {
  const auto require = [](bool right, const char* what) {
    if (!right) throw InvalidInput(std::string("dielectric elastomer: ") + what);
  };
  const auto positive = [](double value) { return value > 0 && std::isfinite(value); };
  require(positive(d.shear_modulus_MPa), "the shear modulus must be above 0 MPa");
  require(positive(d.relative_permittivity), "the relative permittivity must be above 0");
  require(positive(d.thickness_mm), "the thickness must be above 0 mm");
  require(d.prestretch >= 1 && std::isfinite(d.prestretch), "the prestretch, a ratio of lengths, must be 1 or more");
  if (d.law != DielectricLaw::gent) return;
  require(positive(d.stretch_limit), "the limit J_lim of a Gent material must be above 0");
  require(d.prestretch < chain_end(d), "the prestretch is beyond 95 % of the limit J_lim of the Gent material");
}

/// True electric field at a stretch and its voltage [kV/mm].
double field_of(const Dielectric& d, double stretch, double voltage_kV) {
  return stretch * stretch * voltage_kV / d.thickness_mm;
}

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

double voltage_of(const Dielectric& d, double stretch) {
  return d.thickness_mm * std::sqrt(std::max(0.0, drive(d, stretch)) * d.shear_modulus_MPa / permittivity(d));
}

std::optional<PullIn> pull_in(const Dielectric& d) {
  check(d);
  const double low = d.prestretch, high = last_stretch(d);
  double before = low;
  for (int i = 1; i <= scan_steps; ++i) {
    const double here = low * std::pow(high / low, static_cast<double>(i) / scan_steps);
    if (drive_slope(d, here) < 0) {
      PullIn found;
      found.stretch = falling_root(before, here, [&](double l) { return drive_slope(d, l); });
      found.voltage_kV = voltage_of(d, found.stretch);
      found.field_kV_mm = field_of(d, found.stretch, found.voltage_kV);
      return found;
    }
    before = here;
  }
  return std::nullopt;
}

DielectricCurve dielectric_curve(const Dielectric& d, int points, double breakdown_kV_mm) {
  if (points < 3) throw InvalidInput("a curve needs at least three points");
  if (!(breakdown_kV_mm >= 0 && std::isfinite(breakdown_kV_mm)))
    throw InvalidInput("dielectric elastomer: the breakdown field must be above 0 kV/mm");
  DielectricCurve curve;
  curve.pull_in = pull_in(d);
  double end = curve.pull_in ? curve.pull_in->stretch : last_stretch(d);
  const auto margin = [&](double l) { return breakdown_kV_mm - field_of(d, l, voltage_of(d, l)); };
  if (breakdown_kV_mm > 0 && margin(end) < 0) {  // the field rises with the stretch: both of its factors do
    end = falling_root(d.prestretch, end, margin);
    curve.broken_down = true;
  }
  for (int k = 0; k < points; ++k) {
    const double share = static_cast<double>(k) / (points - 1);
    const double stretch = d.prestretch + (end - d.prestretch) * share * share;  // even in voltage at the begin
    curve.voltages.push_back(k == 0 ? 0 : voltage_of(d, stretch));
    curve.area_ratios.push_back(std::pow(stretch / d.prestretch, 2));
  }
  curve.end_field_kV_mm = field_of(d, end, curve.voltages.back());
  return curve;
}

}  // namespace softkin::calibration
