#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/kinematics/sampling.hpp>

namespace softkin {

namespace {

/// Coordinates in the unit cube of the varied actuators, a row per sample.
using Fractions = Actuations;

constexpr int sobol_bits = 32;
constexpr int max_sobol_actuators = 8;
using Directions = std::array<std::uint32_t, sobol_bits>;

/// A primitive polynomial of degree s over GF(2), its inner coefficients a, and the initial numbers m.
struct Recurrence {
  int degree;
  std::uint32_t inner;
  std::array<std::uint32_t, 5> initial;
};

/// Joe and Kuo 2008, "new-joe-kuo-6": dimensions 2 to 8.
constexpr std::array<Recurrence, max_sobol_actuators - 1> recurrences{{{1, 0, {1}},
                                                                       {2, 1, {1, 3}},
                                                                       {3, 1, {1, 3, 1}},
                                                                       {3, 2, {1, 1, 1}},
                                                                       {4, 1, {1, 1, 3, 3}},
                                                                       {4, 4, {1, 3, 5, 13}},
                                                                       {5, 2, {1, 1, 5, 5, 17}}}};

Directions directions_of(std::size_t dimension) {
  Directions v{};
  if (dimension == 0) {
    for (int k = 0; k < sobol_bits; ++k) v[k] = std::uint32_t{1} << (sobol_bits - 1 - k);
    return v;
  }
  const Recurrence& rule = recurrences[dimension - 1];
  for (int k = 0; k < sobol_bits; ++k) {
    if (k < rule.degree) {
      v[k] = rule.initial[k] << (sobol_bits - 1 - k);
      continue;
    }
    v[k] = v[k - rule.degree] ^ (v[k - rule.degree] >> rule.degree);
    for (int j = 1; j < rule.degree; ++j)
      if ((rule.inner >> (rule.degree - 1 - j)) & 1u) v[k] ^= v[k - j];
  }
  return v;
}

Fractions sobol_fractions(Index samples, std::size_t dimensions) {
  if (dimensions > max_sobol_actuators)
    throw InvalidInput("Sobol's sequence is for " + std::to_string(max_sobol_actuators) +
                       " actuators at most, and this robot has " + std::to_string(dimensions) +
                       " whose range is more than one value; sample at random");
  Fractions fractions(samples, dimensions);
  for (std::size_t d = 0; d < dimensions; ++d) {
    const Directions v = directions_of(d);
    std::uint32_t x = 0;
    for (Index i = 0; i < samples; ++i) {
      fractions(i, d) = std::ldexp(static_cast<double>(x), -sobol_bits);
      x ^= v[std::countr_one(static_cast<std::uint32_t>(i))];
    }
  }
  return fractions;
}

/// std::uniform_real_distribution differs between standard libraries.
Fractions random_fractions(Index samples, std::size_t dimensions, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  Fractions fractions(samples, dimensions);
  for (Index i = 0; i < fractions.size(); ++i)
    fractions.data()[i] = std::ldexp(static_cast<double>(generator() >> 11), -53);
  return fractions;
}

/// Number of samples of a full grid, or a value beyond every Index.
double grid_samples(double values, std::size_t dimensions) {
  return std::pow(values, static_cast<double>(dimensions));
}

std::size_t varied_or_refuse(const Model& model) {
  const std::size_t count = varied_actuators(model).size();
  if (count > 0) return count;
  throw InvalidInput("the robot has no actuator whose range is more than one value: there is nothing to sample");
}

Fractions grid_fractions(const Model& model, Index samples, std::size_t dimensions) {
  const Index values = nearest_grid(model, samples);
  if (grid_samples(values, dimensions) != samples)
    throw InvalidInput(std::to_string(samples) + " samples fill no grid over " + std::to_string(dimensions) +
                       " actuators; the nearest grid has " + std::to_string(values) + " values each, " +
                       std::to_string(std::llround(grid_samples(values, dimensions))) + " samples");
  Fractions fractions(samples, dimensions);
  for (Index i = 0; i < samples; ++i)
    for (Index d = fractions.cols(), rest = i; d-- > 0; rest /= values)
      fractions(i, d) = static_cast<double>(rest % values) / (values - 1);
  return fractions;
}

/// Returns the place of a point along a Hilbert curve, with `bits` bits per coordinate, most significant coordinate
/// first.
std::uint64_t hilbert_place(std::vector<std::uint32_t>& x, int bits) {
  const std::size_t n = x.size();
  const std::uint32_t top = std::uint32_t{1} << (bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1)
    for (std::uint32_t& each : x) {
      const std::uint32_t swapped = each & q ? 0 : (x[0] ^ each) & (q - 1);
      x[0] ^= each & q ? q - 1 : swapped;
      each ^= swapped;
    }
  for (std::size_t i = 1; i < n; ++i) x[i] ^= x[i - 1];
  std::uint32_t flip = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1)
    if (x[n - 1] & q) flip ^= q - 1;
  std::uint64_t place = 0;
  for (std::uint32_t q = top; q > 0; q >>= 1)
    for (const std::uint32_t each : x) place = place << 1 | (((each ^ flip) & q) != 0 ? 1 : 0);
  return place;
}

/// Rounded once, whether the machine multiplies and adds in one or not.
double between(const Actuator& actuator, double fraction) {
  if (fraction == 1) return actuator.high;
  return std::min(std::fma(fraction, actuator.high - actuator.low, actuator.low), actuator.high);
}

std::vector<std::uint64_t> hilbert_places(const Model& model, const Actuations& actuations) {
  std::vector<Index> varied = varied_actuators(model);
  varied.resize(std::min<std::size_t>(varied.size(), 64));  // a bit each: more cannot matter to any number of samples
  const int bits = std::min(16, 64 / static_cast<int>(varied.size()));
  std::vector<std::uint64_t> places;
  std::vector<std::uint32_t> x(varied.size());
  for (Index i = 0; i < actuations.rows(); ++i) {
    for (std::size_t d = 0; d < varied.size(); ++d) {
      const Actuator& actuator = model.actuators[varied[d]];
      const double fraction = (actuations(i, varied[d]) - actuator.low) / (actuator.high - actuator.low);
      x[d] = static_cast<std::uint32_t>(std::min(std::ldexp(fraction, bits), std::ldexp(1.0, bits) - 1));
    }
    places.push_back(hilbert_place(x, bits));
  }
  return places;
}

}  // namespace

std::vector<Index> varied_actuators(const Model& model) {
  std::vector<Index> varied;
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (varies(model.actuators[a])) varied.push_back(a);
  return varied;
}

Index nearest_grid(const Model& model, Index samples) {
  const std::size_t dimensions = varied_or_refuse(model);
  if (grid_samples(2, dimensions) > std::numeric_limits<Index>::max())
    throw InvalidInput("a grid over " + std::to_string(dimensions) + " actuators has at least " +
                       number(grid_samples(2, dimensions), 3) + " samples, more than can be solved: sample at random");
  const auto root = static_cast<Index>(std::pow(samples, 1 / static_cast<double>(dimensions)));
  Index best = std::max<Index>(2, root - 1);
  for (Index values = best + 1; values <= root + 2; ++values)
    if (std::abs(grid_samples(values, dimensions) - samples) < std::abs(grid_samples(best, dimensions) - samples))
      best = values;
  return best;
}

Index full_grid(const Model& model, Index samples) {
  return static_cast<Index>(std::llround(grid_samples(nearest_grid(model, samples), varied_or_refuse(model))));
}

Actuations sample_actuations(const Model& model, const SamplingOptions& options) {
  const std::size_t dimensions = varied_or_refuse(model);
  if (options.samples < 1) throw InvalidInput("the number of samples must be 1 or more");
  const Fractions fractions = options.kind == Sampling::grid ? grid_fractions(model, options.samples, dimensions)
                              : options.kind == Sampling::sobol
                                  ? sobol_fractions(options.samples, dimensions)
                                  : random_fractions(options.samples, dimensions, options.seed);
  Actuations actuations(options.samples, model.actuators.size());
  Index d = 0;
  for (Index a = 0; a < actuations.cols(); ++a) {
    const Actuator& actuator = model.actuators[a];
    if (!varies(actuator)) {
      actuations.col(a).setConstant(drives(actuator) ? actuator.low : actuator.rest);
      continue;
    }
    for (Index i = 0; i < actuations.rows(); ++i) actuations(i, a) = between(actuator, fractions(i, d));
    ++d;
  }
  return actuations;
}

StaticsOptions one_of_many(StaticsOptions options) {
  options.threads = 1;
  options.reuse_factor = false;
  options.keep_history = false;
  return options;
}

std::vector<Index> order_of_neighbours(const Model& model, const Actuations& actuations) {
  std::vector<Index> order(actuations.rows());
  std::iota(order.begin(), order.end(), 0);
  const std::vector<std::uint64_t> places = hilbert_places(model, actuations);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return places[a] < places[b]; });
  return order;
}

}  // namespace softkin
