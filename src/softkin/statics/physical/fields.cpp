#include <algorithm>
#include <cmath>
#include <softkin/energy/loop_field.hpp>
#include <softkin/statics/physical/fields.hpp>
#include <type_traits>

namespace softkin::physical {

namespace {

constexpr double loop_constant = 0.1;    // mu_0 / (4 pi) [mT mm / A]
constexpr double dipole_constant = 1e5;  // the same [mT mm^3 / (A m^2)]

/// A number that depends on the position, with its first derivatives, and its second ones if requested.
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

/// Returns f(a) from f and its derivatives at a.
template <bool Second>
Local<Second> composed(const Local<Second>& a, double f, double f1, double f2) {
  Local<Second> of(f, f1 * a.slope);
  if constexpr (Second) of.second = f1 * a.second + f2 * a.slope * a.slope.transpose();
  return of;
}

/// 1 / sqrt(a)^n of a > 0, for all requested n with one division and one root.
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

/// Returns the coordinate along a direction, from a point.
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

void add_lane(const Vec3& vector, int lane, energy::Pack3& to) {
  to.x[lane] += vector[0];
  to.y[lane] += vector[1];
  to.z[lane] += vector[2];
}
void add_lane(const Mat3& matrix, int lane, energy::Pack33& to) {
  for (int r = 0; r < 3; ++r) add_lane(matrix.row(r).transpose(), lane, to.row[r]);
}
void add_lane(const Flux& flux, int lane, bool second, energy::FluxPoint& to) {
  add_lane(flux.value, lane, to.value);
  add_lane(flux.slope, lane, to.slope);
  for (int i = 0; second && i < 3; ++i) add_lane(flux.second[i], lane, to.second[i]);
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

Fields::Setting Fields::setting(const LoadState& load_state) const {
  Setting setting;
  for (const FieldSource& source : magnetism_.sources) {
    Setting::Source& of = setting.sources.emplace_back();
    if (const auto* dipole = std::get_if<DipoleField>(&source.field)) {
      of.position = dipole->position;
      of.moment = dipole->moment;
    }
  }
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    const auto* drive = model_.actuators[a].as<MagneticDrive>();
    if (!drive) continue;
    const FieldCommand command = drive->command;
    const std::size_t place = drive->source;
    const double value = load_state.actuation[a];
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
  for (Setting::Source& source : setting.sources) source.moment *= load_state.load_factor;
  return setting;
}

Fields::Setting Fields::derivative(Index actuator, const LoadState& load_state) const {
  const auto& drive = std::get<MagneticDrive>(model_.actuators[actuator].drive);
  const FieldCommand command = drive.command;
  const std::size_t place = drive.source;
  Setting setting = this->setting(load_state), result;
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
    result.sources[place].moment = load_state.load_factor * Vec3::Unit(axis_of(command));
  } else {
    result.uniform = Vec3::Unit(axis_of(command));
  }
  return result;
}

bool Fields::lane_by_lane(const Setting& setting) const {
  for (std::size_t s = 0; s < setting.sources.size(); ++s)
    if (!setting.sources[s].moment.isZero(0) || (setting.sources[s].current != 0 && grids_[s])) return true;
  return false;
}

template <bool Second>
bool Fields::sum(const Setting& setting, const Vec3& place, Flux& out) const {
  out = {};
  for (std::size_t s = 0; s < setting.sources.size(); ++s) {
    const auto& [current, position, moment] = setting.sources[s];
    bool known = true;
    if (current != 0 && grids_[s]) known = grids_[s]->add(place, current, out);
    if (!moment.isZero(0)) known = add_dipole<Second>(position, moment, place, out);
    if (!known) return false;
  }
  return true;
}

bool Fields::flux_of_lane(const Setting& setting, const Vec3& place, bool second, Flux& out) const {
  const bool moved = setting.moved_along >= 0;
  if (!(second || moved ? sum<true>(setting, place, out) : sum<false>(setting, place, out))) return false;
  if (!moved) return true;
  const Flux there = out;  // the field at x is that of x less the move
  out.value = -there.slope.col(setting.moved_along);
  for (int i = 0; i < 3; ++i) out.slope.row(i) = -there.second[i].col(setting.moved_along).transpose();
  return true;
}

bool Fields::flux(const Setting& setting, const energy::Pack3& places, Index count, bool second,
                  energy::FluxPoint& out) const {
  out = {};
  bool known = true;
  for (std::size_t s = 0; s < setting.sources.size(); ++s) {
    const auto* coil = std::get_if<CoilField>(&magnetism_.sources[s].field);
    const double current = setting.sources[s].current;
    if (!coil || current == 0) continue;
    for (const CoilLoop& loop : coil->loops) {
      const Vec3 &c = loop.center, &a = loop.axis;
      const energy::LoopOfCurrent of{
          {c[0], c[1], c[2]}, {a[0], a[1], a[2]}, loop.radius_mm, loop_constant * current * loop.turns};
      const energy::PackMask there = energy::add_loop(of, places, second, out);
      for (int l = 0; l < count; ++l) known = known && there[l] != 0;
    }
  }
  if (!lane_by_lane(setting)) return known;
  for (int l = 0; l < count; ++l) {
    Flux flux;
    known = flux_of_lane(setting, {places.x[l], places.y[l], places.z[l]}, second, flux) && known;
    add_lane(flux, l, second, out);
  }
  return known;
}

}  // namespace softkin::physical
