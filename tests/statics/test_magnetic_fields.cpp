#include <softkin/statics/physical/fields.hpp>

#include "statics/magnetic_samples.hpp"

/// The flux density of the sources, against the law of Biot and Savart and against differences.

namespace softkin {

namespace {

using namespace testing;

/// A robot of which only the fields count.
struct FieldSample {
  FieldSample(FieldSource source, const std::vector<FieldCommand>& commands) {
    RobotSpec spec = physical_robot(block_mesh({1, 1, 1}, {1, 1, 1}));
    magnetise(spec, {100, 0, 0});
    add_field(spec, std::move(source), commands);
    model = compile(spec);
    fields = std::make_unique<physical::Fields>(model);
    load_state = {Actuation::Zero(commands.size()), 1};
  }

  /// In one lane of many, all at the same place; none where the field is not known there.
  [[nodiscard]] std::optional<physical::Flux> known(const Vec3& place) const {
    energy::Pack3 places{};
    for (int l = 0; l < energy::lanes; ++l) {
      places.x[l] = place[0];
      places.y[l] = place[1];
      places.z[l] = place[2];
    }
    energy::FluxPoint found;
    if (!fields->flux(fields->setting(load_state), places, energy::lanes, true, found)) return {};
    const int lane = energy::lanes - 1;
    const auto row = [&](const energy::Pack3& v) { return Vec3(v.x[lane], v.y[lane], v.z[lane]); };
    physical::Flux flux;
    flux.value = row(found.value);
    for (int i = 0; i < 3; ++i) {
      flux.slope.row(i) = row(found.slope.row[i]).transpose();
      for (int j = 0; j < 3; ++j) flux.second[i].row(j) = row(found.second[i].row[j]).transpose();
    }
    return flux;
  }

  [[nodiscard]] physical::Flux at(const Vec3& place) const {
    const std::optional<physical::Flux> flux = known(place);
    EXPECT_TRUE(flux) << place.transpose();
    return flux.value_or(physical::Flux{});
  }

  Model model;
  std::unique_ptr<physical::Fields> fields;
  physical::LoadState load_state;
};

/// mu_0 / (4 pi) times the sum over short pieces of the wire [mT].
Vec3 biot_savart(const CoilLoop& loop, double current, const Vec3& place) {
  constexpr int pieces = 20000;
  const Vec3 axis = loop.axis.normalized(), u = axis.unitOrthogonal(), v = axis.cross(u);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < pieces; ++i) {
    const double angle = 2 * M_PI * (i + 0.5) / pieces;
    const Vec3 at = loop.center + loop.radius_mm * (std::cos(angle) * u + std::sin(angle) * v);
    const Vec3 along = loop.radius_mm * 2 * M_PI / pieces * (std::cos(angle) * v - std::sin(angle) * u);
    const Vec3 from = place - at;
    sum += along.cross(from) / std::pow(from.norm(), 3);
  }
  return 0.1 * current * loop.turns * sum;
}

/// slope and second are the derivatives of value and slope.
void expect_derivatives(const FieldSample& sample, const Vec3& place, double length) {
  const physical::Flux flux = sample.at(place);
  const double reach = 1e-4 * length;
  for (int axis = 0; axis < 3; ++axis) {
    const physical::Flux high = sample.at(place + reach * Vec3::Unit(axis)),
                         low = sample.at(place - reach * Vec3::Unit(axis));
    const Vec3 slope = (high.value - low.value) / (2 * reach);
    EXPECT_LT((slope - flux.slope.col(axis)).norm(), 1e-6 * flux.slope.norm()) << place.transpose();
    for (int i = 0; i < 3; ++i) {
      const Vec3 second = (high.slope.row(i) - low.slope.row(i)).transpose() / (2 * reach);
      const double size = flux.second[0].norm() + flux.second[1].norm() + flux.second[2].norm();
      EXPECT_LT((second - flux.second[i].col(axis)).norm(), 1e-6 * size) << place.transpose();
    }
  }
}

/// There are no magnetic charges and no currents outside the wires.
void expect_free(const physical::Flux& flux) {
  EXPECT_LT(std::abs(flux.slope.trace()), 1e-11 * flux.slope.norm());
  EXPECT_LT((flux.slope - flux.slope.transpose()).norm(), 1e-11 * flux.slope.norm());
}

const std::vector<Vec3> probed{{0, 0, 0.5},  {0, 0, 0},  {1e-7, 0, 3}, {3, -2, 5},
                               {20, 10, -7}, {39, 0, 2}, {90, 50, 60}};

}  // namespace

TEST(MagneticFields, LoopsAreThoseOfBiotAndSavart) {
  const CoilField coil = two_loops({1, 2, 3});
  FieldSample sample({"coil", coil}, {FieldCommand::current});
  sample.load_state.actuation[0] = 2.5;
  for (const Vec3& place : probed) {
    Vec3 expected = Vec3::Zero();
    for (const CoilLoop& loop : coil.loops) expected += biot_savart(loop, 2.5, place);
    const physical::Flux flux = sample.at(place);
    EXPECT_LT((flux.value - expected).norm(), 1e-8 * expected.norm()) << place.transpose();
    expect_derivatives(sample, place, 1);
    expect_free(flux);
  }
}

TEST(MagneticFields, ALoopIsSmoothOnItsAxisAndWhereSeriesBegin) {
  const CoilField coil{{{Vec3(0, 0, 0), Vec3(0, 0, 1), 10, 1}}};
  FieldSample sample({"coil", coil}, {FieldCommand::current});
  sample.load_state.actuation[0] = 1;
  EXPECT_NEAR(sample.at({0, 0, 0}).value.z(), 0.2 * M_PI / 10, 1e-14);  // mu_0 I / (2 a)
  EXPECT_NEAR(sample.at({0, 0, 10}).value.z(), 0.2 * M_PI / 10 / std::pow(2, 1.5), 1e-14);
  // in the plane 4 a^2 rho^2 / (a^2 + rho^2)^2 is a quarter here
  const double rho = 10 * (2 - std::sqrt(3.0));
  const physical::Flux below = sample.at({rho - 1e-9, 0, 0}), above = sample.at({rho + 1e-9, 0, 0});
  EXPECT_LT((below.value - above.value).norm(), 1e-9);
  EXPECT_LT((below.slope - above.slope).norm(), 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_LT((below.second[i] - above.second[i]).norm(), 1e-9);
  EXPECT_FALSE(sample.known({10, 0, 0})) << "the wire";
}

TEST(MagneticFields, ADipoleIsASmallLoop) {
  const CoilLoop loop{Vec3(3, 4, 5), Vec3(1, -1, 2).normalized(), 0.01, 1000};
  const double current = 7, moment = loop.turns * current * M_PI * 1e-10;  // [A m^2]: radius 1e-5 m
  FieldSample small({"coil", CoilField{{loop}}}, {FieldCommand::current});
  small.load_state.actuation[0] = current;
  FieldSample dipole({"magnet", DipoleField{loop.center, moment * loop.axis}}, {FieldCommand::moment_x});
  dipole.load_state.actuation[0] = moment * loop.axis.x();
  for (const Vec3& place : probed) {
    const Vec3 expected = small.at(place).value;
    EXPECT_LT((dipole.at(place).value - expected).norm(), 1e-4 * expected.norm());
    expect_derivatives(dipole, place, 1);
    expect_free(dipole.at(place));
  }
}

/// Cubic polynomials are splines; of other fields a grid twice as fine is sixteen times as near.
TEST(MagneticFields, AGridIsInterpolatedToFourthOrder) {
  const auto cubic = [](const Vec3& p) {
    return Vec3(1 + p.x() * p.y() * p.z() + std::pow(p.x(), 3), p.y() * p.y() - 2 * p.z(), std::pow(p.z(), 3) * p.x());
  };
  const Vec3 low(-1, -2, 0), high(3, 2, 2);
  FieldSample exact({"grid", sampled(cubic, low, high, {5, 6, 4})}, {FieldCommand::current});
  exact.load_state.actuation[0] = 1;
  for (const Vec3& place : {Vec3(-1, -2, 0), Vec3(0.3, 0.7, 1.9), Vec3(3, 2, 2), Vec3(2.9, -1.4, 0.1)}) {
    EXPECT_LT((exact.at(place).value - cubic(place)).norm(), 1e-11) << place.transpose();
    if (place.x() > 0 && place.x() < 3) expect_derivatives(exact, place, 1);
  }
  EXPECT_FALSE(exact.known({3.01, 0, 1}));
  const auto wave = [](const Vec3& p) { return Vec3(std::sin(p.x()), std::cos(p.y() + p.z()), std::exp(0.5 * p.x())); };
  std::vector<double> errors;
  for (const Index n : {9, 17}) {
    FieldSample grid({"grid", sampled(wave, low, high, {n, n, n})}, {FieldCommand::current});
    grid.load_state.actuation[0] = 1;
    double most = 0;
    for (int i = 0; i < 50; ++i) {
      const Vec3 place =
          low + (high - low).cwiseProduct(0.5 * (Vec3(std::sin(i), std::sin(2 * i), std::sin(3 * i)) + Vec3::Ones()));
      most = std::max(most, (grid.at(place).value - wave(place)).norm());
    }
    errors.push_back(most);
  }
  EXPECT_GT(errors[0] / errors[1], 10);
}

}  // namespace softkin
