#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/tendons.hpp>

namespace softkin::physical {

namespace {

/// Slip over which friction grows to its limit, over the cable's length at rest.
constexpr double creep_fraction = 1e-4;
/// Turn below which friction is reduced to be smooth [rad].
constexpr double straight = 2e-3;

/// Slip over the creep from which a cable is slipping: the stored lengths follow to 1, apart from rounding.
constexpr double whole = 1 - 1e-6;
/// Changes of slip and sines of turns below this value are zero apart from rounding.
constexpr double rounding_size = 1e-9;

/// Returns the fraction of the friction limit, towards the motor, at a slip over the creep.
double friction_fraction(double slip) {
  return std::clamp(slip, -1.0, 1.0);
}

double friction_slope(double slip) {
  return std::abs(slip) >= whole ? 0 : 1;
}

double friction_secant(double slip, double change) {
  if (std::abs(change) < rounding_size) return friction_slope(slip);
  return (friction_fraction(slip + change) - friction_fraction(slip)) / change;
}

/// theta^2 / sqrt(theta^2 + straight^2) of two directions, and its derivative by their scalar product, times -1.
struct Turn {
  double angle = 0, slope = 0;
  Turn(const Vec3& before, const Vec3& after) {
    const double sine = before.cross(after).norm(), theta = std::atan2(sine, before.dot(after));
    const double root = std::sqrt(theta * theta + straight * straight);
    angle = theta * theta / root;
    const double over_sine = sine > rounding_size ? theta / sine : theta < 1 ? 1 : theta / rounding_size;
    slope = over_sine * (theta * theta + 2 * straight * straight) / (root * root * root);
  }
};

}  // namespace

/// The path of a cable in a shape: n segments, and n eyelets where they begin. The first eyelet stands for the sheath.
struct Tendons::TendonPath {
  std::vector<Vec3> points, directions;
  Eigen::VectorXd lengths, beyond;           // of segments; of the path behind the eyelets [mm]
  Eigen::VectorXd limits, slips, fraction;   // mu theta; slip over the creep; tensions over that at the motor
  std::vector<std::array<Vec3, 3>> turns{};  // gradients of the angles by the points before, at and after the eyelet
};

Tendons::Tendons(const Model& model) : model_(model), cables_(model.actuators.size()) {
  for (std::size_t a = 0; a < cables_.size(); ++a) {
    const Actuator& actuator = model.actuators[a];
    if (!softkin::has_friction(actuator)) continue;
    const auto& cable = std::get<CableDrive>(actuator.drive);
    cables_[a] = {remembered_, static_cast<Index>(cable.points.size()) - 1, cable.friction, cable.sheath,
                  creep_fraction * actuator.rest_measure};
    remembered_ += cables_[a].count;
  }
}

const std::vector<EmbeddedPoint>& Tendons::points_of(Index actuator) const {
  return std::get<CableDrive>(model_.actuators[actuator].drive).points;
}

Tendons::TendonPath Tendons::path(Index actuator, const Points& positions) const {
  const Cable& cable = cables_[actuator];
  TendonPath path;
  for (const EmbeddedPoint& point : points_of(actuator)) path.points.push_back(point.at(positions));
  const Index count = std::ssize(path.points) - 1;
  path.lengths.resize(count);
  path.beyond.resize(count);
  path.limits.setZero(count);
  path.turns.resize(count, {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  for (Index j = 0; j < count; ++j) {
    const Vec3 step = path.points[j + 1] - path.points[j];
    path.lengths[j] = step.norm();
    path.directions.emplace_back(step / path.lengths[j]);
  }
  double beyond = 0;
  for (Index j = count; j-- > 0;) path.beyond[j] = beyond += path.lengths[j];
  path.limits[0] = cable.sheath;
  for (Index j = 1; j < count; ++j) {
    const Vec3 &before = path.directions[j - 1], &after = path.directions[j];
    const Turn turn(before, after);
    path.limits[j] = cable.friction * turn.angle;
    const double cosine = before.dot(after);
    auto& slopes = path.turns[j];
    slopes[0] = turn.slope / path.lengths[j - 1] * (after - cosine * before);
    slopes[2] = -turn.slope / path.lengths[j] * (before - cosine * after);
    slopes[1] = -slopes[0] - slopes[2];
  }
  return path;
}

Tendons::TendonPath Tendons::path(Index actuator, const Iterate& at) const {
  TendonPath found = path(actuator, at.positions);
  const Cable& cable = cables_[actuator];
  const Index count = found.lengths.size();
  found.slips.setZero(count);
  found.fraction.resize(count);
  double exponent = 0;
  for (Index j = 0; j < count; ++j) {
    if (!at.eyelets.empty()) found.slips[j] = (at.eyelets[cable.memory + j] - found.beyond[j]) / cable.creep;
    exponent += found.limits[j] * friction_fraction(found.slips[j]);
    found.fraction[j] = std::exp(-exponent);
  }
  return found;
}

void Tendons::spread(Index actuator, const std::vector<Vec3>& vectors, Points& force) const {
  const std::vector<EmbeddedPoint>& points = points_of(actuator);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < points[i].vertices.size(); ++k)
      force.row(points[i].vertices[k]) += points[i].weights[k] * vectors[i].transpose();
}

std::vector<double> Tendons::lengths(const Points& positions) const {
  return lengths(positions, Eigen::VectorXd::Zero(remembered_));
}

std::vector<double> Tendons::lengths(const Points& positions, const Eigen::VectorXd& slips) const {
  std::vector<double> all;
  for (Index a = 0; a < std::ssize(cables_); ++a) {
    if (!has_friction(a)) continue;
    for (const double beyond : path(a, positions).beyond)
      all.push_back(beyond + cables_[a].creep * (slips.size() == remembered_ ? slips[all.size()] : 1));
  }
  return all;
}

void Tendons::slide(const Points& positions, std::vector<double>& eyelets) const {
  const std::vector<double> now = lengths(positions);
  if (eyelets.empty()) eyelets = now;
  for (const Cable& cable : cables_) {
    for (Index j = 0; j < cable.count; ++j) {
      const std::size_t i = cable.memory + j;
      eyelets[i] = std::clamp(eyelets[i], now[i] - cable.creep, now[i] + cable.creep);
    }
  }
}

Eigen::VectorXd Tendons::slips(const Iterate& at) const {
  Eigen::VectorXd all(remembered_);
  for (Index a = 0; a < std::ssize(cables_); ++a) {
    if (!has_friction(a)) continue;
    const TendonPath found = path(a, at);
    all.segment(cables_[a].memory, found.slips.size()) = found.slips;
  }
  return all;
}

Eigen::VectorXd Tendons::fractions(Index actuator, const Iterate& at) const {
  return path(actuator, at).fraction;
}

void Tendons::pull(Index actuator, const Iterate& at, Points& force) const {
  const TendonPath found = path(actuator, at);
  std::vector<Vec3> vectors(found.points.size(), Vec3::Zero());
  for (Index j = 0; j < std::ssize(found.fraction); ++j) {
    vectors[j] -= found.fraction[j] * found.directions[j];
    vectors[j + 1] += found.fraction[j] * found.directions[j];
  }
  force.setZero(at.positions.rows(), 3);
  spread(actuator, vectors, force);
}

void Tendons::add_response(Index actuator, double tension, const Iterate& at, const Points& moves,
                           Points& force) const {
  const TendonPath found = path(actuator, at);
  const double creep = cables_[actuator].creep;
  const Index count = found.fraction.size();
  std::vector<Vec3> steps, vectors(found.points.size(), Vec3::Zero());
  for (const EmbeddedPoint& point : points_of(actuator)) steps.push_back(point.at(moves));
  Eigen::VectorXd slip(count);  // of the moves
  double shorter = 0;
  for (Index j = count; j-- > 0;) slip[j] = shorter -= found.directions[j].dot(steps[j + 1] - steps[j]);
  double change = 0;  // of the logarithm of the tension
  for (Index j = 0; j < count; ++j) {
    double turn = 0;
    if (j > 0)
      for (int k = 0; k < 3; ++k) turn += found.turns[j][k].dot(steps[j - 1 + k]);
    change -= cables_[actuator].friction * turn * friction_fraction(found.slips[j]) +
              found.limits[j] * friction_slope(found.slips[j]) * slip[j] / creep;
    const Vec3 more = tension * found.fraction[j] * change * found.directions[j];
    vectors[j] -= more;
    vectors[j + 1] += more;
  }
  spread(actuator, vectors, force);
}

TendonForces Tendons::forces(Index actuator, double tension, const Iterate& at) const {
  const TendonPath found = path(actuator, at);
  double sticks = 0, all = 0;  // by the same sums: the fraction of a cable that sticks entirely is exactly 1
  for (Index j = 0; j < std::ssize(found.slips); ++j) {
    all += found.limits[j];
    if (std::abs(found.slips[j]) < whole) sticks += found.limits[j];
  }
  return {tension * found.fraction[found.fraction.size() - 1], all > 0 ? sticks / all : 0};
}

TendonColumns Tendons::columns(const Iterate& at, const supports::Freedoms& freedoms) const {
  TendonColumns columns;
  Index count = 0;
  for (Index a = 0; a < std::ssize(cables_); ++a) {
    if (!has_friction(a) || at.multipliers[a] == 0) continue;
    const Cable& cable = cables_[a];
    columns.tendons.push_back({count, cable.count, a, cable.memory, cable.creep, at.multipliers[a]});
    count += cable.count;
  }
  Eigen::MatrixXd along(freedoms.size(), count), turns = Eigen::MatrixXd::Zero(freedoms.size(), count);
  columns.tensions.resize(count);
  columns.limits.resize(count);
  Points slope;
  for (const TendonColumns::Tendon& tendon : columns.tendons) {
    const Index a = tendon.actuator;
    const TendonPath found = path(a, at);
    const double friction = cables_[a].friction;
    columns.tensions.segment(tendon.begin, tendon.count) = at.multipliers[a] * found.fraction;
    columns.limits.segment(tendon.begin, tendon.count) = found.limits;
    std::vector<Vec3> vectors(found.points.size());
    for (Index j = 0; j < tendon.count; ++j) {
      std::fill(vectors.begin(), vectors.end(), Vec3::Zero());
      vectors[j] = -found.directions[j];
      vectors[j + 1] = found.directions[j];
      slope.setZero(at.positions.rows(), 3);
      spread(a, vectors, slope);
      freedoms.reduce(slope, at.positions, along.col(tendon.begin + j));
      const double fraction = friction * friction_fraction(found.slips[j]);
      if (j == 0 || fraction == 0) continue;
      std::fill(vectors.begin(), vectors.end(), Vec3::Zero());
      for (int k = 0; k < 3; ++k) vectors[j - 1 + k] = fraction * found.turns[j][k];
      slope.setZero(at.positions.rows(), 3);
      spread(a, vectors, slope);
      freedoms.reduce(slope, at.positions, turns.col(tendon.begin + j));
    }
  }
  columns.along = along.sparseView();
  columns.turns = turns.sparseView();
  return columns;
}

Eigen::MatrixXd TendonColumns::turned(const Eigen::Ref<const Eigen::MatrixXd>& moves) const {
  Eigen::MatrixXd all = turns.transpose() * moves;
  for (const Tendon& tendon : tendons) {
    for (Index j = 1; j < tendon.count; ++j) all.row(tendon.begin + j) += all.row(tendon.begin + j - 1);
    for (Index j = 0; j < tendon.count; ++j) all.row(tendon.begin + j) *= -tensions[tendon.begin + j];
  }
  return all;
}

Eigen::MatrixXd TendonColumns::rates(const Eigen::VectorXd& slips, const Eigen::VectorXd& lengthening,
                                     const Eigen::VectorXd& growth) const {
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(count(), count());
  for (const Tendon& tendon : tendons) {
    Eigen::VectorXd stiffness(tendon.count), change(tendon.count);  // limit times slope; of the tension's logarithm
    double shorter = 0;
    for (Index j = tendon.count; j-- > 0;) {
      shorter -= lengthening[tendon.begin + j];
      const double slope = friction_secant(slips[tendon.memory + j], shorter / tendon.creep) / tendon.creep;
      stiffness[j] = limits[tendon.begin + j] * slope;
      change[j] = -stiffness[j] * shorter;
    }
    const double grown = growth.size() > 0 ? std::max(0.0, growth[tendon.actuator]) : 1;
    double exponent = 0, sum = 0;
    std::vector<double> sums;
    for (Index j = 0; j < tendon.count; ++j) {
      constexpr double small = 1e-6;
      exponent += change[j];
      sums.push_back(sum += stiffness[j]);
      const double secant = std::abs(exponent) > small ? std::expm1(exponent) / exponent : 1;
      const double scale = grown * tensions[tendon.begin + j] * secant;
      for (Index k = 0; k < tendon.count; ++k) rates(tendon.begin + j, tendon.begin + k) = scale * sums[std::min(j, k)];
    }
  }
  return rates;
}

}  // namespace softkin::physical
