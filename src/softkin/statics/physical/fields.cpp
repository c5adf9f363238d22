#include <algorithm>
#include <cmath>
#include <numbers>
#include <softkin/statics/physical/fields.hpp>
#include <type_traits>

namespace softkin::physical {

namespace {

constexpr double loop_constant = 0.1;    // mu_0 / (4 pi) [mT mm / A]
constexpr double dipole_constant = 1e5;  // the same [mT mm^3 / (A m^2)]

/// A number that depends on the place, with its first derivatives, and its second ones where they are asked for.
template <bool Second>
struct Local {
  double value = 0;
  Vec3 slope = Vec3::Zero();
  struct Nothing {};
  std::conditional_t<Second, Mat3, Nothing> second{};

  explicit Local(double number = 0, const Vec3& along = Vec3::Zero()) : value(number), slope(along) {
    if constexpr (Second) second.setZero();
  }

  friend Local operator+(const Local& a, const Local& b) {
    Local sum(a.value + b.value, a.slope + b.slope);
    if constexpr (Second) sum.second = a.second + b.second;
    return sum;
  }
  friend Local operator*(double a, const Local& b) {
    Local product(a * b.value, a * b.slope);
    if constexpr (Second) product.second = a * b.second;
    return product;
  }
  friend Local operator*(const Local& a, const Local& b) {
    Local product(a.value * b.value, a.value * b.slope + b.value * a.slope);
    if constexpr (Second)
      product.second =
          a.value * b.second + b.value * a.second + a.slope * b.slope.transpose() + b.slope * a.slope.transpose();
    return product;
  }
};

/// f(a), by f and its derivatives there.
template <bool Second>
Local<Second> composed(const Local<Second>& a, double f, double f1, double f2) {
  Local<Second> of(f, f1 * a.slope);
  if constexpr (Second) of.second = f1 * a.second + f2 * a.slope * a.slope.transpose();
  return of;
}

/// 1 / sqrt(a)^n of a > 0, for all n that are asked for with one division and one root.
template <bool Second>
class InversePowers {
 public:
  explicit InversePowers(const Local<Second>& a) : a_(a), inverse_(1 / a.value), root_(std::sqrt(inverse_)) {}

  template <int N>
  [[nodiscard]] Local<Second> power() const {
    double f = N % 2 == 0 ? 1 : root_;
    for (int i = 0; i < N / 2; ++i) f *= inverse_;
    const double f1 = -0.5 * N * f * inverse_;
    return composed(a_, f, f1, (-0.5 * N - 1) * f1 * inverse_);
  }

 private:
  const Local<Second>& a_;
  double inverse_, root_;
};

/// Along a direction, from a point.
template <bool Second>
Local<Second> along(const Vec3& from_point, const Vec3& direction) {
  return Local<Second>(from_point.dot(direction), direction);
}

template <bool Second>
Local<Second> square_of(const Vec3& from_point) {
  Local<Second> square(from_point.squaredNorm(), 2 * from_point);
  if constexpr (Second) square.second = 2 * Mat3::Identity();
  return square;
}

template <bool Second>
void add_component(const Local<Second>& local, const Vec3& direction, Flux& out) {
  out.value += local.value * direction;
  out.slope += direction * local.slope.transpose();
  if constexpr (Second)
    for (int i = 0; i < 3; ++i) out.second[i] += direction[i] * local.second;
}

/// Integrals over a loop's angle, k^2 = t: f of (1 - k cos)^-3/2 and g of cos (1 - k cos)^-3/2 / k, with derivatives by
/// t; h, of (1 - k cos)^-1/2, is 2 pi F(1/4, 3/4; 1; t), and f = h + t g, h' = g / 4.
struct LoopIntegrals {
  double f, f1, f2, g, g1, g2;

  explicit LoopIntegrals(double t) {
    double h = 0;
    if (t < 0.25)
      by_series(t);
    else
      by_means(t, h);
    if (t >= 0.25) {  // the hypergeometric equation of h, and its derivative
      g1 = (0.75 * h - (1 - 2 * t) * g) / (t * (1 - t));
      g2 = (35.0 / 16 * g - 2 * (1 - 2 * t) * g1) / (t * (1 - t));
    }
    f1 = 1.25 * g + t * g1;
    f2 = 2.25 * g1 + t * g2;
  }

 private:
  struct Series {
    static constexpr int terms = 32;  // of a quarter's powers, below rounding
    std::array<double, terms> h{}, g{};
    constexpr Series() {
      double of_h = 2 * std::numbers::pi, of_g = 1.5 * std::numbers::pi;
      for (std::size_t n = 0; n < terms; ++n) {
        const auto i = static_cast<double>(n);
        h[n] = of_h;
        g[n] = of_g;
        of_h *= (0.25 + i) * (0.75 + i) / ((1.0 + i) * (1.0 + i));
        of_g *= (1.25 + i) * (1.75 + i) / ((2.0 + i) * (1.0 + i));
      }
    }
  };

  void by_series(double t) {
    static constexpr Series series;
    const int terms = t < 0.02 ? 12 : t < 0.08 ? 18 : Series::terms;  // likewise of these powers
    double h = 0;
    g = g1 = g2 = 0;
    for (int n = terms - 1; n >= 0; --n) {  // Horner's scheme, with the derivatives
      g2 = g2 * t + 2 * g1;
      g1 = g1 * t + g;
      g = g * t + series.g[static_cast<std::size_t>(n)];
      h = h * t + series.h[static_cast<std::size_t>(n)];
    }
    f = h + t * g;
  }

  /// Complete elliptic integrals of m = 2 k / (1 + k) by arithmetic-geometric means.
  void by_means(double t, double& h) {
    const double k = std::sqrt(t);
    double a = 1, b = std::sqrt((1 - k) / (1 + k)), sum = 0.5 * (2 * k / (1 + k)), weight = 0.5;
    for (int i = 0; i < 40 && a - b > 1e-16 * a; ++i) {
      const double c = 0.5 * (a - b), next = 0.5 * (a + b);
      b = std::sqrt(a * b);
      a = next;
      weight *= 2;
      sum += weight * c * c;
    }
    const double first = std::numbers::pi / (2 * a), second = first * (1 - sum);
    h = 4 * first / std::sqrt(1 + k);
    f = 4 * second / ((1 - k) * std::sqrt(1 + k));
    g = (f - h) / t;
  }
};

template <bool Second>
bool add_loop(const CoilLoop& loop, double current, const Vec3& place, Flux& out) {
  const double a = loop.radius_mm;
  const Vec3 from_center = place - loop.center;
  const Local<Second> z = along<Second>(from_center, loop.axis);
  const Local<Second> square = square_of<Second>(from_center);
  const Local<Second> size = square + Local<Second>(a * a);
  const Local<Second> across = square + -1.0 * (z * z);  // rho^2
  const InversePowers<Second> over(size);
  const Local<Second> t = 4 * a * a * (across * over.template power<4>());
  if (!(t.value < 1)) return false;
  const LoopIntegrals of(std::max(0.0, t.value));
  const Local<Second> f = composed(t, of.f, of.f1, of.f2), g = composed(t, of.g, of.g1, of.g2);
  const double scale = loop_constant * current * loop.turns * a;
  const Local<Second> axial =
      scale * (over.template power<3>() * (a * f + -2 * a * (across * over.template power<2>() * g)));
  const Local<Second> radial = 2 * a * scale * (z * over.template power<5>() * g);  // over rho
  add_component(axial + -1.0 * (radial * z), loop.axis, out);
  for (int i = 0; i < 3; ++i) {
    const Vec3 unit = Vec3::Unit(i);
    add_component(radial * along<Second>(from_center, unit), unit, out);
  }
  return true;
}

template <bool Second>
bool add_dipole(const Vec3& position, const Vec3& moment, const Vec3& place, Flux& out) {
  const Vec3 from = place - position;
  if (!(from.squaredNorm() > 0)) return false;
  const Local<Second> square = square_of<Second>(from);
  const InversePowers<Second> over(square);
  const Local<Second> toward = 3 * dipole_constant * (along<Second>(from, moment) * over.template power<5>());
  add_component(-dipole_constant * over.template power<3>(), moment, out);
  for (int i = 0; i < 3; ++i) {
    const Vec3 unit = Vec3::Unit(i);
    add_component(toward * along<Second>(from, unit), unit, out);
  }
  return true;
}

}  // namespace

Fields::Fields(const Model& model) : model_(model), magnetism_(*model.magnetism) {
  for (const FieldSource& source : magnetism_.sources) {
    const auto* grid = std::get_if<GridField>(&source.field);
    grids_.push_back(grid ? std::make_unique<const SplineGrid>(*grid) : nullptr);
    any_dipole_ = any_dipole_ || std::holds_alternative<DipoleField>(source.field);
  }
}

bool Fields::Setting::in_space() const {
  return std::any_of(sources.begin(), sources.end(),
                     [](const Source& source) { return source.current != 0 || !source.moment.isZero(0); });
}

Fields::Setting Fields::setting(const Demand& demand) const {
  Setting setting;
  for (const FieldSource& source : magnetism_.sources) {
    Setting::Source& of = setting.sources.emplace_back();
    if (const auto* dipole = std::get_if<DipoleField>(&source.field)) {
      of.position = dipole->position;
      of.moment = dipole->moment;
    }
  }
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    const Actuator& actuator = model_.actuators[a];
    if (actuator.kind != ActuatorKind::magnetic) continue;
    const auto command = static_cast<FieldCommand>(actuator.axis);
    const auto place = static_cast<std::size_t>(actuator.other);
    const double value = demand.actuation[static_cast<Index>(a)];
    if (command == FieldCommand::current)
      setting.sources[place].current = value;
    else if (command == FieldCommand::flux_density)
      setting.uniform += value * std::get<UniformField>(magnetism_.sources[place].field).direction;
    else if (places_dipole(command))
      setting.sources[place].position[axis_of(command)] = value;
    else if (command >= FieldCommand::moment_x)
      setting.sources[place].moment[axis_of(command)] = value;
    else
      setting.uniform[axis_of(command)] += value;
  }
  for (Setting::Source& source : setting.sources) source.moment *= demand.share;
  return setting;
}

Fields::Setting Fields::derivative(Index actuator, const Demand& demand) const {
  const Actuator& of = model_.actuators[static_cast<std::size_t>(actuator)];
  const auto command = static_cast<FieldCommand>(of.axis);
  const auto place = static_cast<std::size_t>(of.other);
  Setting setting = this->setting(demand), result;
  result.sources.resize(setting.sources.size());
  if (command == FieldCommand::current) {
    result.sources[place].current = 1;
  } else if (command == FieldCommand::flux_density) {
    result.uniform = std::get<UniformField>(magnetism_.sources[place].field).direction;
  } else if (places_dipole(command)) {
    result.sources[place] = setting.sources[place];
    result.moved_along = axis_of(command);
  } else if (command >= FieldCommand::moment_x) {
    result.sources[place].position = setting.sources[place].position;
    result.sources[place].moment = demand.share * Vec3::Unit(axis_of(command));
  } else {
    result.uniform = Vec3::Unit(axis_of(command));
  }
  return result;
}

template <bool Second>
bool Fields::sum(const Setting& setting, const Vec3& place, Flux& out) const {
  out = {};
  for (std::size_t s = 0; s < setting.sources.size(); ++s) {
    const auto& [current, position, moment] = setting.sources[s];
    bool known = true;
    if (current != 0 && grids_[s]) known = grids_[s]->add(place, current, out);
    if (const auto* coil = std::get_if<CoilField>(&magnetism_.sources[s].field); coil && current != 0)
      for (const CoilLoop& loop : coil->loops) known = known && add_loop<Second>(loop, current, place, out);
    if (!moment.isZero(0)) known = add_dipole<Second>(position, moment, place, out);
    if (!known) return false;
  }
  return true;
}

bool Fields::flux(const Setting& setting, const Vec3& place, bool second, Flux& out) const {
  const bool moved = setting.moved_along >= 0;
  if (!(second || moved ? sum<true>(setting, place, out) : sum<false>(setting, place, out))) return false;
  if (!moved) return true;
  const Flux there = out;  // the field at x is that of x less the move
  out.value = -there.slope.col(setting.moved_along);
  for (int i = 0; i < 3; ++i) out.slope.row(i) = -there.second[i].col(setting.moved_along).transpose();
  return true;
}

}  // namespace softkin::physical
