#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <softkin/kinematics/inverse_search.hpp>

namespace softkin {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// Terms that are a function of the command fractions; derivatives by central differences.
class Function : public inverse::Response {
 public:
  std::function<Vector(const Vector&)> terms;
  double tolerance = 1e-6;
  int most = 200, requested = 0;
  bool inside = true;

  inverse::Pose at(const Vector& fractions) const {
    inverse::Pose pose;
    pose.fractions = fractions;
    pose.terms = terms(fractions);
    pose.miss = pose.terms.norm() / tolerance;
    pose.idle.setZero(fractions.size());
    pose.tensions.resize(0);
    return pose;
  }
  Outcome go(const Vector& fractions, const inverse::Pose&, inverse::Pose& to) override {
    ++requested;
    inside = inside && fractions.minCoeff() >= 0 && fractions.maxCoeff() <= 1;
    to = at(fractions);
    return Outcome::arrived;
  }
  bool slopes(const inverse::Pose& at, inverse::Slopes& slopes) override {
    slopes.terms = difference(terms, at.fractions);
    slopes.tensions.resize(0, at.fractions.size());
    return true;
  }
  [[nodiscard]] bool any_left() const override { return requested < most; }

  static Matrix difference(const std::function<Vector(const Vector&)>& value, const Vector& at) {
    constexpr double reach = 1e-5;
    Matrix result(value(at).size(), at.size());
    for (Eigen::Index i = 0; i < at.size(); ++i) {
      Vector move = Vector::Zero(at.size());
      move[i] = reach;
      result.col(i) = (value(at + move) - value(at - move)) / (2 * reach);
    }
    return result;
  }
};

/// Tip of a planar arm of links of length 10 mm whose joints turn by -90 to 90 degrees.
Eigen::Vector2d arm(const Vector& fractions) {
  Eigen::Vector2d tip(0, 0);
  double angle = 0;
  for (const double fraction : fractions) {
    angle += std::numbers::pi * (fraction - 0.5);
    tip += 10 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return tip;
}

inverse::SearchSettings settings_for(const Vector& preferred) {
  inverse::SearchSettings settings;
  settings.preferred = preferred;
  settings.resolution_mm = 1e-7;
  settings.accuracy_mm = 1e-12;
  return settings;
}

Vector point(std::initializer_list<double> values) {
  Vector result(values.size());
  std::copy(values.begin(), values.end(), result.data());
  return result;
}

TEST(InverseSearch, ReachesWhatCanBeReached) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> any(0.05, 0.95);
  int reached = 0;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d target = arm(point({any(engine), any(engine)}));
    Function response;
    response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
    const inverse::Pose start = response.at(point({0.5, 0.6}));
    const inverse::SearchResult found = inverse::search_inverse(response, start, settings_for(start.fractions));
    EXPECT_TRUE(response.inside);
    EXPECT_LT(response.requested, 40);
    // else it is at a range's end, with the elbow on the other side
    if (found.end != inverse::SearchEnd::stationary) {
      EXPECT_EQ(found.end, inverse::SearchEnd::reached);
      EXPECT_LT((arm(found.pose.fractions) - target).norm(), 1e-6);
      ++reached;
    }
  }
  EXPECT_GT(reached, 70);
}

TEST(InverseSearch, NearestPointIsThatOfTheGrid) {
  for (const Eigen::Vector2d& target :
       {Eigen::Vector2d(30, 5), Eigen::Vector2d(-15, 12), Eigen::Vector2d(5, -30), Eigen::Vector2d(1, 0.5)}) {
    Function response;
    response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
    double least = HUGE_VAL;
    Vector nearest;
    constexpr int cells = 400;
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j <= cells; ++j) {
        const Vector u = point({i / double(cells), j / double(cells)});
        if (const double error = response.terms(u).norm(); error < least) {
          least = error;
          nearest = u;
        }
      }
    const inverse::Pose start = response.at(nearest.array().max(0.1).min(0.9).matrix());
    const inverse::SearchResult found = inverse::search_inverse(response, start, settings_for(start.fractions));
    ASSERT_EQ(found.end, inverse::SearchEnd::stationary) << target.transpose();
    EXPECT_LE(found.pose.terms.norm(), least + 1e-9) << target.transpose();
    EXPECT_GE(found.pose.terms.norm(), least - 0.05) << target.transpose();  // slope times half a cell
    EXPECT_LT(found.slope, 1e-3);
    EXPECT_TRUE(response.inside);
    EXPECT_LT(response.requested, 30) << target.transpose();
  }
}

/// Far from the curve the terms' curvature is as large as the slopes' squares: Gauss-Newton alone creeps or circles.
TEST(InverseSearch, NearestPointOfACurveFarAway) {
  for (const double far : {0.2, 0.8, 1.5, 4.0}) {
    Function response;  // a quarter of a circle of radius 1, seen from `far` times its radius
    response.terms = [&](const Vector& u) -> Vector {
      const double angle = 0.5 * std::numbers::pi * u[0];
      return 10 * Eigen::Vector2d(std::cos(angle) - far * std::cos(1.0), std::sin(angle) - far * std::sin(1.0));
    };
    const inverse::Pose start = response.at(point({0.1}));
    const inverse::SearchResult found = inverse::search_inverse(response, start, settings_for(start.fractions));
    ASSERT_EQ(found.end, inverse::SearchEnd::stationary) << far;
    EXPECT_NEAR(found.pose.fractions[0], 2 / std::numbers::pi, 1e-4) << far;
    EXPECT_LT(response.requested, 25) << far;
  }
}

/// Poses that are known to 2e-6 mm only; their slopes are exact.
class Coarse : public Function {
 public:
  static constexpr double grain = 4e-6;

  inverse::Pose rounded(const Vector& fractions) const {
    inverse::Pose pose = at(fractions);
    pose.terms = (pose.terms / grain).array().round() * grain;
    return pose;
  }
  Outcome go(const Vector& fractions, const inverse::Pose&, inverse::Pose& to) override {
    ++requested;
    to = rounded(fractions);
    return Outcome::arrived;
  }
};

/// Far from its target a tip that is off by a micrometre is hardly farther away than the nearest one.
TEST(InverseSearch, EndsWhereNothingMeasurableIsLeftToGain) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> any(0, 2 * std::numbers::pi);
  for (int i = 0; i < 60; ++i) {
    const double angle = any(engine);
    const Eigen::Vector2d target = 200 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    Coarse response;
    response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
    const inverse::Pose start = response.rounded(point({0.45, 0.6, 0.4}));
    inverse::SearchSettings settings = settings_for(start.fractions);
    settings.accuracy_mm = Coarse::grain;
    const inverse::SearchResult found = inverse::search_inverse(response, start, settings);
    EXPECT_EQ(found.end, inverse::SearchEnd::stationary) << target.transpose();
    EXPECT_LT(found.slope, 1e-2) << target.transpose();
    EXPECT_LT(response.requested, 60) << target.transpose();
  }
}

/// Three joints for two coordinates: scan the first, solve for the others, and take the nearest to the preferred.
double min_distance(const Eigen::Vector2d& target, const Vector& preferred) {
  double least = HUGE_VAL;
  constexpr int steps = 20000;
  for (int i = 0; i <= steps; ++i) {
    const double first = i / double(steps), angle = std::numbers::pi * (first - 0.5);
    const Eigen::Vector2d rest = target - 10 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const double bend = rest.squaredNorm() / 200 - 1;
    if (std::abs(bend) > 1) continue;
    for (const double third : {std::acos(bend), -std::acos(bend)}) {
      const double second = std::atan2(rest.y(), rest.x()) - third / 2 - angle;
      const Vector u = point({first, std::remainder(second, 2 * std::numbers::pi) / std::numbers::pi + 0.5,
                              third / std::numbers::pi + 0.5});
      if (u.minCoeff() < 0 || u.maxCoeff() > 1) continue;
      least = std::min(least, (u - preferred).norm());
    }
  }
  return least;
}

TEST(InverseSearch, OfManyAnswersTheNearest) {
  const Vector wanted[] = {point({0.5, 0.55, 0.6}), point({0.9, 0.5, 0.2}), point({0.3, 0.7, 0.5})};
  for (const Vector& preferred : wanted)
    for (const Eigen::Vector2d& target :
         {Eigen::Vector2d(22, 10), Eigen::Vector2d(18, 12), Eigen::Vector2d(25, -5), Eigen::Vector2d(16, 18)}) {
      Function response;
      response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
      const inverse::Pose start = response.at(preferred);
      const inverse::SearchResult found = inverse::search_inverse(response, start, settings_for(preferred));
      ASSERT_EQ(found.end, inverse::SearchEnd::reached)
          << target.transpose() << ", preferred " << preferred.transpose();
      EXPECT_LE(found.pose.miss, 1);
      EXPECT_NEAR((found.pose.fractions - preferred).norm(), min_distance(target, preferred), 2e-4)
          << target.transpose() << ", preferred " << preferred.transpose();
      EXPECT_TRUE(response.inside);
      EXPECT_LT(response.requested, 60) << target.transpose() << ", preferred " << preferred.transpose();
    }
}

TEST(InverseSearch, PrefersAnActuationOtherThanTheStart) {
  const Eigen::Vector2d target(22, 10);
  const Vector preferred = point({0.6, 0.3, 0.9});
  Function response;
  response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
  const inverse::SearchResult found =
      inverse::search_inverse(response, response.at(point({0.5, 0.6, 0.6})), settings_for(preferred));
  ASSERT_EQ(found.end, inverse::SearchEnd::reached);
  EXPECT_NEAR((found.pose.fractions - preferred).norm(), min_distance(target, preferred), 2e-4);
}

/// Two cables, of which the second is taut only where it is shorter than a path that depends on the first.
class Cables : public Function {
 public:
  static double path(const Vector& u) { return 0.8 - 0.5 * (1 - u[0]) - 0.2 * (1 - u[0]) * (1 - u[0]); }

  inverse::Pose pose(Vector u) const {
    const bool slack = u[1] >= path(u);
    u[1] = std::min(u[1], path(u));
    inverse::Pose result = at(u);
    result.idle[1] = slack ? 1 : 0;
    result.tensions = Vector::Constant(1, 3 * (path(u) - u[1]));
    return result;
  }
  Outcome go(const Vector& fractions, const inverse::Pose&, inverse::Pose& to) override {
    ++requested;
    inside = inside && fractions.minCoeff() >= 0 && fractions.maxCoeff() <= 1;
    to = pose(fractions);
    return Outcome::arrived;
  }
  bool slopes(const inverse::Pose& at, inverse::Slopes& slopes) override {
    slopes.terms = difference(terms, at.fractions);
    slopes.tensions =
        difference([](const Vector& u) -> Vector { return Vector::Constant(1, 3 * (path(u) - u[1])); }, at.fractions);
    return true;
  }
};

TEST(InverseSearch, PullsASlackCable) {
  const Eigen::Vector2d target = arm(point({0.7, 0.58}));
  Cables response;
  response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
  const Vector start = point({0.9, 1});  // slack
  const inverse::SearchResult found = inverse::search_inverse(response, response.pose(start), settings_for(start));
  ASSERT_EQ(found.end, inverse::SearchEnd::reached);
  EXPECT_LT((found.pose.fractions - point({0.7, 0.58})).norm(), 1e-5);
}

TEST(InverseSearch, CablesDoNotPush) {
  for (const Eigen::Vector2d& target : {Eigen::Vector2d(4, 17), Eigen::Vector2d(-3, 14), Eigen::Vector2d(12, 30)}) {
    Cables response;
    response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
    double least = HUGE_VAL;
    Vector nearest;
    for (int i = 0; i <= 500; ++i)
      for (int j = 0; j <= 500; ++j) {
        const inverse::Pose pose = response.pose(point({i / 500.0, j / 500.0}));
        if (pose.terms.norm() < least) {
          least = pose.terms.norm();
          nearest = pose.fractions;
        }
      }
    ASSERT_GT(least, 0.5) << target.transpose();
    const Vector inside = nearest.array().max(0.15).min(0.85).matrix();
    for (const double pulled : {0.05, 1e-8, 0.0}) {  // also from where the cable all but hangs through
      Vector start = inside;
      start[1] = Cables::path(start) - pulled;
      response.requested = 0;
      const inverse::SearchResult found = inverse::search_inverse(response, response.pose(start), settings_for(start));
      ASSERT_EQ(found.end, inverse::SearchEnd::stationary) << target.transpose() << ", " << pulled;
      EXPECT_LE(found.pose.terms.norm(), least + 1e-4) << target.transpose() << ", " << pulled;
      EXPECT_GE(found.pose.terms.norm(), least - 0.05) << target.transpose() << ", " << pulled;
      EXPECT_LT(found.slope, 1e-3) << target.transpose() << ", " << pulled;
      EXPECT_GE(found.pose.tensions[0], 0);
      EXPECT_LT(response.requested, 40) << target.transpose() << ", " << pulled;
    }
  }
}

/// Nothing converges behind a wall; a solve that is to pass it ends on the path.
class Walled : public Function {
 public:
  double wall = 0.6;
  bool halfway = true;

  Outcome go(const Vector& fractions, const inverse::Pose& from, inverse::Pose& to) override {
    ++requested;
    if (fractions[0] <= wall) {
      to = at(fractions);
      return Outcome::arrived;
    }
    if (!halfway || from.fractions[0] > wall - 1e-3) return Outcome::failed;
    to = at(from.fractions +
            (wall - from.fractions[0]) / (fractions[0] - from.fractions[0]) * (fractions - from.fractions));
    return Outcome::halfway;
  }
};

TEST(InverseSearch, ShortensItsStepsWhereNothingConverges) {
  for (const bool halfway : {true, false}) {
    Walled response;
    response.halfway = halfway;
    const Eigen::Vector2d target = arm(point({0.58, 0.7}));
    response.terms = [&](const Vector& u) -> Vector { return arm(u) - target; };
    const inverse::Pose start = response.at(point({0.1, 0.9}));
    EXPECT_EQ(inverse::search_inverse(response, start, settings_for(start.fractions)).end, inverse::SearchEnd::reached);

    const Eigen::Vector2d beyond = arm(point({0.8, 0.7}));
    response.terms = [&](const Vector& u) -> Vector { return arm(u) - beyond; };
    response.requested = 0;
    const inverse::Pose again = response.at(point({0.1, 0.9}));
    const inverse::SearchResult found = inverse::search_inverse(response, again, settings_for(again.fractions));
    EXPECT_EQ(found.end, inverse::SearchEnd::stuck);  // and does not claim that nothing helps
    EXPECT_LT(found.pose.terms.norm(), again.terms.norm());
  }
}

TEST(InverseSearch, EndsWithItsAllowance) {
  Function response;
  response.most = 2;
  response.terms = [&](const Vector& u) -> Vector { return arm(u) - arm(point({0.9, 0.1})); };
  const inverse::Pose start = response.at(point({0.3, 0.6}));
  const inverse::SearchResult found = inverse::search_inverse(response, start, settings_for(start.fractions));
  EXPECT_EQ(found.end, inverse::SearchEnd::none_left);
  EXPECT_EQ(response.requested, 2);
  EXPECT_LE(found.pose.terms.norm(), start.terms.norm());
}

}  // namespace
}  // namespace softkin
