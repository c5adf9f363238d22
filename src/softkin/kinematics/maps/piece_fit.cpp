#include <algorithm>
#include <cmath>
#include <limits>
#include <softkin/kinematics/maps/piece_fit.hpp>
#include <utility>

namespace softkin::maps {

namespace {

/// Largest error of predictions at new points, over the requested accuracy: these points had the largest variance.
constexpr double enough = 0.5;
/// Number of terms per observed number, a value or a slope.
constexpr double terms_per_number = 0.8;
/// A box is halved where `patience` batches do not reduce its error to this fraction.
constexpr std::size_t patience = 2;
constexpr double worthwhile = 0.3;
/// A box of this fraction of its piece's box or less is not halved any more.
constexpr double min_width = 1.0 / 64;

}  // namespace

PieceFit::PieceFit(const MapData& data, const Wanted& wanted, MapPiece& piece)
    : data_(data),
      wanted_(wanted),
      piece_(piece),
      variables_(piece.inputs.size()),
      error_(std::numeric_limits<double>::infinity()) {
  Chart whole{Eigen::VectorXd(variables_), Eigen::VectorXd(variables_)};
  for (Index j = 0; j < variables_; ++j) {
    const MapInput& input = data.inputs[piece.inputs[j]];
    whole.low[j] = input.low;
    whole.high[j] = input.high;
  }
  whole.decay = Eigen::VectorXd::Constant(variables_, 1.6);
  piece_.tree.assign(1, {});
  low_ = whole.low;
  high_ = whole.high;
  open_.push_back(std::move(whole));
}

Eigen::VectorXd PieceFit::scaled(const Chart& chart, const Eigen::VectorXd& commands) const {
  return (2 * commands - chart.low - chart.high).cwiseQuotient(chart.high - chart.low);
}

/// Returns values and slopes of outputs and probes, over their requested accuracy.
Observation PieceFit::observation(const Chart& chart, const Sample& sample) const {
  const Index outputs = data_.outputs.size();
  const bool shape = wanted_.shape_mm > 0;
  const Index size = outputs + (shape ? static_cast<Index>(3 * wanted_.probes.size()) : 0);
  const Eigen::VectorXd half = 0.5 * (chart.high - chart.low);
  Observation made{scaled(chart, sample.commands), Eigen::VectorXd(size), RowMatrix(variables_, size)};
  for (Index q = 0; q < outputs; ++q) {
    const double unit = wanted_.accuracy[q] > 0 ? 1 / wanted_.accuracy[q] : 0;
    made.values[q] = unit * sample.values[q];
    made.slopes.col(q) = unit * half.cwiseProduct(sample.slopes.col(q));
  }
  for (Index p = 0; shape && p < std::ssize(wanted_.probes); ++p) {
    const Index vertex = wanted_.probes[p];
    for (Index k = 0; k < 3; ++k) {
      const Index q = outputs + 3 * p + k;
      made.values[q] = sample.state.positions(vertex, k) / wanted_.shape_mm;
      made.slopes.col(q) =
          half.cwiseProduct(sample.moves.row(3 * vertex + k).transpose().cast<double>()) / wanted_.shape_mm;
    }
  }
  return made;
}

Index PieceFit::batch_of(const Chart& chart) const {
  if (samples_.empty() || variables_ == 0) return 1;  // the others begin at the first
  return std::max<Index>(2 * variables_ + 1, static_cast<Index>(chart.samples.size() / 4));
}

Terms PieceFit::terms_of(const Chart& chart, Index samples) const {
  if (variables_ == 0) return Terms(1, 0);
  const double numbers = static_cast<double>((1 + variables_) * samples);
  return min_terms(chart.decay, std::max<Index>(1, static_cast<Index>(terms_per_number * numbers)));
}

RowMatrix PieceFit::next() {
  if (!open_.empty() && std::ssize(samples_) >= wanted_.most) {
    gave_up_ = true;
    for (Chart& chart : std::exchange(open_, {}))
      if (!chart.errors.empty() && chart.errors.back() <= 1) keep(std::move(chart));  // the others: outside the map
  }
  if (open_.empty()) return RowMatrix(0, variables_);
  // the widest first: when the maximum of equilibria is reached, the unfinished boxes are small
  std::stable_sort(open_.begin(), open_.end(), [](const Chart& a, const Chart& b) { return a.width < b.width; });
  const Chart& chart = open_.back();
  const Index batch = batch_of(chart);
  RowMatrix commands(batch, variables_);
  if (samples_.empty() || variables_ == 0) {
    commands.row(0) = 0.5 * (chart.low + chart.high);
    return commands;
  }
  RowMatrix known(chart.samples.size(), variables_);
  for (Index i = 0; i < known.rows(); ++i) known.row(i) = scaled(chart, samples_[chart.samples[i]].commands);
  const Terms terms = terms_of(chart, static_cast<Index>(known.rows()) + batch);
  const RowMatrix points = worst_known(terms, chart.decay, known, batch);
  const Eigen::RowVectorXd half = 0.5 * (chart.high - chart.low), middle = 0.5 * (chart.high + chart.low);
  for (Index i = 0; i < batch; ++i)
    commands.row(i) =
        (middle + half.cwiseProduct(points.row(i))).cwiseMax(chart.low.transpose()).cwiseMin(chart.high.transpose());
  return commands;
}

double PieceFit::error_of(const Chart& chart, const Sample& sample) const {
  const Observation found = observation(chart, sample);
  Eigen::VectorXd predicted(found.values.size());
  chart.polynomials.evaluate(found.x.data(), predicted.data());
  return (predicted - found.values).cwiseAbs().maxCoeff();
}

void PieceFit::fit_chart(Chart& chart) const {
  std::vector<Observation> observations;
  for (const Index s : chart.samples) {
    const Sample& sample = samples_[s];
    if (sample.is_good()) observations.push_back(observation(chart, sample));
  }
  chart.polynomials = fit(terms_of(chart, observations.size()), observations, chart.decay);
  if (variables_ > 0) chart.decay = decay_of(chart.polynomials);
}

bool PieceFit::stagnates(const Chart& chart) const {
  const std::size_t batches = chart.errors.size();
  return batches > patience && chart.errors.back() > worthwhile * chart.errors[batches - 1 - patience];
}

void PieceFit::take(std::vector<Sample> samples) {
  Chart chart = std::move(open_.back());
  open_.pop_back();
  double error = 0;
  for (Sample& sample : samples) {
    if (sample.is_good() && chart.polynomials.count() > 0) error = std::max(error, error_of(chart, sample));
    chart.samples.push_back(samples_.size());
    samples_.push_back(std::move(sample));
  }
  const auto is_good = [&](Index s) { return samples_[s].is_good(); };
  const auto good = std::count_if(chart.samples.begin(), chart.samples.end(), is_good);
  if (good < std::ssize(chart.samples) || (chart.polynomials.count() > 0 && stagnates(chart)))
    return halve(std::move(chart));
  const bool tested = chart.polynomials.count() > 0;
  if (tested) chart.errors.push_back(error_ = error);
  fit_chart(chart);
  if (variables_ == 0 || (tested && chart.errors.size() > 1 && error <= enough)) return keep(std::move(chart));
  open_.push_back(std::move(chart));
}

/// Returns the variable along which a box is halved: that which separates samples with and without equilibria, or that
/// along which coefficients fall slowest and the box is longest, as near a kink they fall alike along all.
Index PieceFit::side_of(const Chart& chart) const {
  Eigen::VectorXd score = (chart.high - chart.low).cwiseQuotient(high_ - low_).array().log().matrix() - chart.decay;
  Index bad = 0;
  for (const Index s : chart.samples) bad += samples_[s].is_good() ? 0 : 1;
  if (bad > 0) {
    for (Index j = 0; j < variables_; ++j) {
      double below = 0, above = 0;
      for (const Index s : chart.samples) {
        const Sample& sample = samples_[s];
        if (sample.is_good()) continue;
        (sample.commands[j] < 0.5 * (chart.low[j] + chart.high[j]) ? below : above) += 1;
      }
      score[j] = std::abs(below - above);
    }
  }
  Index best = 0;
  score.maxCoeff(&best);
  return best;
}

void PieceFit::halve(Chart chart) {
  const auto is_good = [&](Index s) { return samples_[s].is_good(); };
  const bool any = std::any_of(chart.samples.begin(), chart.samples.end(), is_good);
  const bool hopeless = !any && std::ssize(chart.samples) > 2 * variables_;
  if (variables_ == 0 || hopeless || chart.width <= min_width) return;  // a node without a cell: outside the map
  const Index side = side_of(chart);
  const double middle = 0.5 * (chart.low[side] + chart.high[side]);
  const Index first = piece_.tree.size();
  piece_.tree[chart.node] = {static_cast<int>(side), middle, first, first + 1, -1};
  for (const bool upper : {false, true}) {
    Chart half{chart.low, chart.high};
    (upper ? half.low : half.high)[side] = middle;
    half.node = piece_.tree.size();
    half.decay = chart.decay;
    half.width = 0.5 * chart.width;
    for (const Index s : chart.samples) {
      const double at = samples_[s].commands[side];
      if (upper ? at >= middle : at <= middle) half.samples.push_back(s);
    }
    const bool clean = !half.samples.empty() && std::all_of(half.samples.begin(), half.samples.end(), is_good);
    if (clean) fit_chart(half);
    piece_.tree.emplace_back();
    open_.push_back(std::move(half));
  }
}

/// A chart that has been fitted becomes a cell.
void PieceFit::keep(Chart chart) {
  if (chart.polynomials.count() == 0) return;
  const Index outputs = data_.outputs.size();
  RowMatrix coefficients = chart.polynomials.coefficients().leftCols(outputs);
  for (Index q = 0; q < outputs; ++q) coefficients.col(q) *= wanted_.accuracy[q];
  piece_.tree[chart.node].cell = piece_.cells.size();
  piece_.cells.push_back({chart.low, chart.high, {chart.polynomials.terms(), std::move(coefficients)}, {}});
  done_.push_back(std::move(chart));
}

const Sample* PieceFit::nearest(const Eigen::VectorXd& commands) const {
  const Sample* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Sample& sample : samples_) {
    if (!sample.is_good()) continue;
    double distance = 0;
    for (Index j = 0; j < variables_; ++j) {
      const MapInput& input = data_.inputs[piece_.inputs[j]];
      const double fraction = (sample.commands[j] - commands[j]) / (input.high - input.low);
      distance += fraction * fraction;
    }
    if (distance < least) {
      least = distance;
      best = &sample;
    }
  }
  return best;
}

void PieceFit::fit_modes(const MapShape& shape) {
  const Eigen::MatrixXf modes = shape.modes.cast<float>() * shape.units.cast<float>().asDiagonal();
  for (std::size_t c = 0; c < done_.size(); ++c) {
    const Chart& chart = done_[c];
    const Eigen::VectorXf half = (0.5 * (chart.high - chart.low)).cast<float>();
    std::vector<Observation> observations;
    for (const Index s : chart.samples) {
      const Sample& sample = samples_[s];
      if (!sample.is_good()) continue;
      const Points& at = sample.state.positions;
      const Eigen::VectorXf away = Eigen::Map<const Eigen::VectorXd>(at.data(), at.size()).cast<float>() - shape.mean;
      observations.push_back({scaled(chart, sample.commands), (modes.transpose() * away).cast<double>(),
                              (modes.transpose() * sample.moves * half.asDiagonal()).transpose().cast<double>()});
    }
    piece_.cells[c].modes = fit(chart.polynomials.terms(), observations, chart.decay);
  }
}

}  // namespace softkin::maps
