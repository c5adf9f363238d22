#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <random>
#include <softkin/core/dense.hpp>
#include <softkin/statics/physical/contact_potential.hpp>

#include "contact/sphere.hpp"

namespace softkin::physical {

namespace {

using contact::Corners;

/// Triangles over a grid of cells, each cut along a diagonal by chance; vertices from `first` on.
std::vector<Corners> sheet(int cells, Index first, std::mt19937& engine) {
  std::vector<Corners> triangles;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const Index a = first + i * (cells + 1) + j, b = a + cells + 1, c = b + 1, d = a + 1;
      if (engine() % 2 == 0)
        triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
      else
        triangles.insert(triangles.end(), {{a, b, d}, {b, c, d}});
    }
  return triangles;
}

/// Returns its vertices: in a square from 0 to cells, with random perturbations in the plane and out of it.
Points places(int cells, double sideways, double height, double bumps, std::mt19937& engine) {
  std::uniform_real_distribution<double> any(-1, 1);
  Points points((cells + 1) * (cells + 1), 3);
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j)
      points.row(i * (cells + 1) + j) << i + sideways * any(engine), j + sideways * any(engine),
          height + bumps * any(engine);
  return points;
}

/// Surfaces with their potential; areas are those at rest, where nobody else gives them.
struct Sample {
  Sample(std::vector<Corners> triangles, Points its_rest, double reach)
      : rest(std::move(its_rest)),
        surface{.surface = contact::make_surface(std::move(triangles), rest), .reach_mm = reach, .modulus_MPa = 2.5} {
    surface.vertex_area = surface.surface.vertex_area;
    surface.edge_area = surface.surface.edge_area;
    broad.emplace(surface.surface, rest);
    leave_out_neighbours(rest, *broad, team, surface);
    potential.emplace(surface, rest);
  }

  void look(const Points& positions) {
    broad->find(positions, surface.reach_mm, team, candidates);
    sort_candidates(candidates);
    potential->find(positions, candidates, terms);
  }
  double energy(const Points& positions) {
    look(positions);
    return potential->energy(positions, terms);
  }
  Points gradient(const Points& positions) {
    look(positions);
    Points out = Points::Zero(positions.rows(), 3);
    potential->add_gradient(positions, terms, out);
    return out;
  }

  Points rest;
  ContactSurfaces surface;
  Team team{1};
  std::optional<contact::BroadPhase> broad;
  std::optional<ContactPotential> potential;
  contact::Candidates candidates;
  std::vector<ContactPotential::Term> terms;
};

/// A body below and one more triangle, whose first vertex alone carries area, far away at rest.
struct Probe : Sample {
  Probe(std::vector<Corners> triangles, const Points& body, double reach)
      : Sample(with_probe(std::move(triangles), body.rows()), beside(body), reach), vertex(body.rows()) {
    std::fill(surface.edge_area.begin(), surface.edge_area.end(), 0);
    std::fill(surface.vertex_area.begin(), surface.vertex_area.end(), 0);
    surface.vertex_area[surface.surface.vertices.size() - 3] = 1;
  }

  static std::vector<Corners> with_probe(std::vector<Corners> triangles, Index first) {
    triangles.push_back({first, first + 1, first + 2});
    return triangles;
  }
  static Points beside(const Points& body) {
    Points all(body.rows() + 3, 3);
    all << body, Points::Constant(3, 3, 1000);
    all(body.rows() + 1, 0) += 1;
    all(body.rows() + 2, 1) += 1;
    return all;
  }
  [[nodiscard]] Points at(const Vec3& place) const {
    Points positions = rest;
    positions.row(vertex) = place.transpose();
    return positions;
  }
  [[nodiscard]] double closest(const Vec3& place) const {
    double least = HUGE_VAL;
    for (const Corners& t : surface.surface.triangles) {
      if (t[0] == vertex) continue;
      contact::FourPoints x;
      x << place, rest.row(t[0]).transpose(), rest.row(t[1]).transpose(), rest.row(t[2]).transpose();
      least = std::min(least, contact::vertex_triangle(x).squared);
    }
    return std::sqrt(least);
  }

  Index vertex;
};

/// Two sheets with bumps, closer than the reach in places.
std::unique_ptr<Sample> two_sheets(unsigned seed) {
  std::mt19937 engine(seed);
  const Points below = places(4, 0.2, 0, 0.15, engine), above = places(4, 0.2, 0.5, 0.15, engine);
  std::vector<Corners> triangles = sheet(4, 0, engine);
  for (const Corners& t : sheet(4, below.rows(), engine)) triangles.push_back(t);
  Points rest(below.rows() + above.rows(), 3);
  rest << below, above;
  Points apart = rest;
  apart.bottomRows(above.rows()).col(2).array() += 50;
  auto sample = std::make_unique<Sample>(std::move(triangles), apart, 0.6);
  sample->rest = rest;  // where they are looked at
  return sample;
}

}  // namespace

/// However a plane is cut into triangles, over their insides, edges and vertices alike.
TEST(ContactPotential, OfAPlaneIsThatOfItsDistance) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> inside(1.5, 4.5), height(0.1, 0.9);
  const Points body = places(6, 0.25, 0, 0, engine);
  Probe probe(sheet(6, 0, engine), body, 1);
  std::vector<Vec3> over;
  for (int i = 0; i < 300; ++i) over.emplace_back(inside(engine), inside(engine), 0);
  for (const Corners& t : probe.surface.surface.triangles) {
    if (t[0] == probe.vertex || (body.row(t[0]).head<2>().array() - 3).abs().maxCoeff() > 1.5) continue;
    over.emplace_back(body.row(t[0]));
    over.emplace_back(0.5 * (body.row(t[0]) + body.row(t[1])));
  }
  for (Vec3 place : over) {
    place.z() = height(engine);
    const energy::LengthLaw law = energy::barrier(place.z(), 1);
    EXPECT_NEAR(probe.energy(probe.at(place)), 2.5 * law.value, 1e-12);
    const Points gradient = probe.gradient(probe.at(place));
    EXPECT_LT((gradient.row(probe.vertex).transpose() - 2.5 * law.slope * Vec3::UnitZ()).norm(), 1e-6);
  }
}

/// Outside of a convex body nothing counts but what is closest.
TEST(ContactPotential, OfAConvexBodyIsThatOfItsDistance) {
  const auto [vertices, triangles] = contact::testing::make_sphere(2, 1);
  Probe probe(triangles, vertices, 0.5);
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> height(1.02, 1.5);
  for (int i = 0; i < 300; ++i) {
    Vec3 place(normal(engine), normal(engine), normal(engine));
    if (i % 4 == 0) place = vertices.row(i % vertices.rows());
    place *= height(engine) / place.norm();
    EXPECT_NEAR(probe.energy(probe.at(place)), 2.5 * energy::barrier(probe.closest(place), 0.5).value, 1e-11);
  }
}

/// Along lines over ridges and through valleys of a bumpy sheet: what jumps would not shrink with the step.
TEST(ContactPotential, GradientIsContinuous) {
  std::mt19937 engine(3);
  const Points body = places(6, 0.3, 0, 0.5, engine);
  Probe probe(sheet(6, 0, engine), body, 1.2);
  std::uniform_real_distribution<double> any(1, 5);
  for (int line = 0; line < 5; ++line) {
    const Vec3 from(any(engine), any(engine), 0.9), to(any(engine), any(engine), 0.9);
    const auto largest_change = [&](int steps) {
      Vec3 last = Vec3::Zero();
      double most = 0;
      for (int i = 0; i <= steps; ++i) {
        const Vec3 now = probe.gradient(probe.at(from + (to - from) * i / steps)).row(probe.vertex).transpose();
        if (i > 0) most = std::max(most, (now - last).norm());
        last = now;
      }
      return most;
    };
    const double coarse = largest_change(200), fine = largest_change(1600);
    EXPECT_LT(fine, 0.25 * coarse + 1e-9) << line;
  }
}

TEST(ContactPotential, GradientAndStiffnessAreDerivatives) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const auto sheets = two_sheets(seed);
    Sample& sample = *sheets;
    const Points at = sample.rest;
    const Points gradient = sample.gradient(at);
    ASSERT_GT(sample.terms.size(), 30u);
    EXPECT_TRUE(std::any_of(sample.terms.begin(), sample.terms.end(), [](const auto& t) { return t.weight < 0; }));
    EXPECT_TRUE(std::any_of(sample.terms.begin(), sample.terms.end(), [](const auto& t) { return t.threshold > 0; }));
    const Index n = 3 * static_cast<Index>(at.rows());
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
    contact::Hessian block;
    for (const auto& term : sample.terms) {
      sample.potential->stiffness(at, term, false, block);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          stiffness.block<3, 3>(3 * term.nodes[i], 3 * term.nodes[j]) += block.block<3, 3>(3 * i, 3 * j);
    }
    constexpr double step = 1e-6;
    for (Index k = 0; k < n; ++k) {
      Points low = at, high = at;
      low(k / 3, k % 3) -= step;
      high(k / 3, k % 3) += step;
      EXPECT_NEAR(gradient(k / 3, k % 3), (sample.energy(high) - sample.energy(low)) / (2 * step),
                  1e-7 * gradient.norm());
      const Points change = (sample.gradient(high) - sample.gradient(low)) / (2 * step);
      const Eigen::Map<const Eigen::VectorXd> flat(change.data(), n);
      EXPECT_LT((stiffness.col(k) - flat).norm(), 1e-6 * stiffness.norm()) << k;
    }
  }
}

TEST(ContactPotential, PushesNothingAsAWhole) {
  const auto sheets = two_sheets(5);
  Sample& sample = *sheets;
  const Points gradient = sample.gradient(sample.rest);
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (Index v = 0; v < gradient.rows(); ++v) {
    force += gradient.row(v).transpose();
    torque += Vec3(sample.rest.row(v)).cross(Vec3(gradient.row(v)));
  }
  EXPECT_LT(force.norm(), 1e-12 * gradient.norm());
  EXPECT_LT(torque.norm(), 1e-11 * gradient.norm());
}

TEST(ContactPotential, ProjectedStiffnessIsPositive) {
  const auto sheets = two_sheets(6);
  Sample& sample = *sheets;
  sample.look(sample.rest);
  contact::Hessian block;
  for (const auto& term : sample.terms) {
    sample.potential->stiffness(sample.rest, term, true, block);
    EXPECT_GT(symmetric_eigenvalues(block).minCoeff(), -1e-12 * block.norm());
  }
}

/// A fine surface, whose triangles are much smaller than the reach, does not feel itself.
TEST(ContactPotential, AtRestThereIsNone) {
  const auto [vertices, triangles] = contact::testing::make_sphere(3, 1);
  Sample sample(triangles, vertices, 0.3);
  EXPECT_EQ(sample.energy(vertices), 0);
  EXPECT_TRUE(sample.terms.empty());
}

}  // namespace softkin::physical
