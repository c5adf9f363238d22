#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <softkin/core/dense.hpp>
#include <softkin/linear/block_matrix.hpp>
#include <softkin/model/equilibrium.hpp>
#include <softkin/statics/physical/contacts.hpp>

#include "statics/contact_scenes.hpp"
#include "statics/difference.hpp"
#include "statics/robots.hpp"

/// Contact of faces of order 2, whose nodes carry the points between which they are flat.

namespace softkin {
namespace {

using namespace testing;

/// Stacked blocks whose nodes are moved by chance, so that faces are curved and many pairs are near.
struct NearBlocks {
  explicit NearBlocks(bool quadratic, double friction = 0)
      : model(compile(robot(quadratic, friction))), contacts(model), scratch(contacts.make_scratch()) {
    near = model.rest;
    for (Index v = 0; v < near.rows(); ++v)
      if (near(v, 2) > StackedBlocks::size + 1) near(v, 2) -= 1.3;
    near += noise(near.rows(), 0.15, 3);
  }

  static RobotSpec robot(bool quadratic, double friction) {
    RobotSpec spec = StackedBlocks{0.9, 2, 0, quadratic}.robot({1, 2, 1}, {2, 2, 1});
    spec.contact->friction = friction;
    return spec;
  }
  double energy(const Points& at) {
    contacts.find(at, *scratch, alone);
    return contacts.energy(at, *scratch);
  }
  Points gradient(const Points& at) {
    contacts.find(at, *scratch, alone);
    Points out = Points::Zero(at.rows(), 3);
    contacts.add_gradient(at, *scratch, out);
    return out;
  }
  /// The stiffness times moves.
  Points product(const Points& at, const Points& moves) {
    contacts.find(at, *scratch, alone);
    contact::Candidates pairs;
    contacts.find_pairs(at, *scratch, alone, pairs);
    linear::Cliques cliques;
    contacts.add_cliques(pairs, cliques);
    const linear::BlockPattern pattern(at.rows(), cliques);
    LargeVector<double> slots(9 * static_cast<std::size_t>(cliques.slots.back()), 5.0), blocks;
    contacts.stiffness(at, false, *scratch, pairs, slots.data());
    pattern.gather(slots, blocks, alone);
    Points out;
    pattern.multiply(blocks, moves, out, alone);
    return out;
  }

  Model model;
  physical::Contacts contacts;
  std::unique_ptr<physical::Contacts::Scratch> scratch;
  Points near;
  Team alone{1};
};

/// A floor that is felt from afar for a while changes nothing between faces of one block: the pattern of the stiffness
/// has no pair of them.
TEST(ContactPoints, WiderReachIsOfDifferentSolidsAlone) {
  const auto pairs_of = [](const RobotSpec& spec) {
    const Model model = compile(spec);
    const physical::Contacts contacts(model);
    const auto scratch = contacts.make_scratch();
    scratch->stiffness_scale.reach = 2 * 10 / *spec.contact->distance_mm;  // all of the block
    Team alone(1);
    contact::Candidates pairs;
    contacts.find_pairs(model.rest, *scratch, alone, pairs);
    return pairs.vertex_triangle.size() + pairs.edge_edge.size();
  };
  for (const bool quadratic : {false, true}) {
    RobotSpec spec = block_on_rough_floor(0, Vec3::Zero(), 3, quadratic);
    EXPECT_GT(pairs_of(spec), 16u);
    spec.contact->obstacles.clear();
    EXPECT_EQ(pairs_of(spec), 0u);
  }
}

/// A block is pushed onto another one repeatedly and in random directions. The memory of earlier motions changes
/// neither the longest admissible step nor the contact energy.
TEST(ContactPoints, WaysBeforeChangeNothing) {
  for (const bool quadratic : {false, true}) {
    NearBlocks blocks(quadratic);
    Points at = blocks.model.rest;
    int cut = 0, short_motions = 0;
    for (int i = 0; i < 150; ++i) {
      const double length = std::pow(10.0, -2 + 0.7 * (i % 6));  // [mm]
      const Points chance = noise(3, 1, 100 + i);
      Points to = at;
      for (Index v = 0; v < to.rows(); ++v)
        if (blocks.model.rest(v, 2) > StackedBlocks::size + 1)
          to.row(v) += length * (chance.row(0) - Eigen::RowVector3d(0, 0, 0.5)) +
                       0.02 * length * (at.row(v) - at.row(0)).cross(chance.row(1));
      to += noise(to.rows(), 0.02 * length, 300 + i);
      const auto fresh = blocks.contacts.make_scratch();
      const double fraction = blocks.contacts.longest_step(at, to, *blocks.scratch, blocks.alone);
      EXPECT_NEAR(fraction, blocks.contacts.longest_step(at, to, *fresh, blocks.alone), 0.01 * fraction) << i;
      cut += fraction < 1;
      short_motions += fraction == 1;
      at += (i % 2 ? 0.95 : 0.5) * fraction * (to - at);
      const auto another = blocks.contacts.make_scratch();
      blocks.contacts.find(at, *another, blocks.alone);
      EXPECT_EQ(blocks.energy(at), blocks.contacts.energy(at, *another)) << i;
    }
    EXPECT_GT(cut, 10);
    EXPECT_GT(short_motions, 50);
  }
}

TEST(ContactPoints, GradientAndStiffnessAreDerivatives) {
  for (const bool quadratic : {false, true})
    for (const double friction : {0.0, 0.6}) {
      NearBlocks blocks(quadratic, friction);
      const Points& at = blocks.near;
      (void)blocks.energy(at);
      std::vector<Anchor> anchors;
      if (friction > 0) {
        blocks.contacts.renew(at + noise(at.rows(), 0.02, 8), at, {at, at}, *blocks.scratch, anchors);
        blocks.contacts.friction().hold(blocks.scratch->terms, anchors, blocks.scratch->holds);
        ASSERT_GT(blocks.scratch->holds.size(), 10u);
      }
      ASSERT_GT(blocks.scratch->terms.size(), 40u);
      const Points gradient = blocks.gradient(at);
      const auto energy_at = [&](const Points& p) { return blocks.energy(p); };
      EXPECT_LT((gradient - difference(energy_at, at, 1e-6)).norm(), 1e-6 * gradient.norm()) << quadratic << friction;
      for (unsigned seed = 1; seed <= 3; ++seed) {
        const Points direction = noise(at.rows(), 1, seed);
        const Points product = blocks.product(at, direction);
        const Points change = change_along([&](const Points& p) { return blocks.gradient(p); }, at, direction, 1e-7);
        EXPECT_LT((product - change).norm(), 1e-5 * product.norm()) << quadratic << friction;
      }
    }
}

TEST(ContactPoints, PushNothingAsAWhole) {
  NearBlocks blocks(true);
  const Points gradient = blocks.gradient(blocks.near);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (Index v = 0; v < gradient.rows(); ++v) {
    force += gradient.row(v).transpose();
    moment += Vec3(blocks.near.row(v)).cross(Vec3(gradient.row(v)));
  }
  EXPECT_LT(force.norm(), 1e-12 * gradient.norm());
  EXPECT_LT(moment.norm(), 1e-11 * gradient.norm());
}

/// The integrals of the shape functions of a triangle of order 2 are 0 at corners and a third of its area at the nodes
/// between: what a floor at an even gap pushes each node with, beyond the block's rim.
TEST(ContactPoints, AnEvenPressureComesAsItsConsistentLoads) {
  const Model model = compile(BlockOnFloor{0.2, 0.5, 0, true}.robot());
  Points at = model.rest;
  at.topRows(model.robot_vertices()).col(2).array() -= 0.4;
  const Points gradient = contact_gradient(model, at);
  const double pressure = push_of_gap(0.1 / 0.2), cell = BlockOnFloor::size / 3;
  std::vector<double> area(at.rows());
  int corners = 0, edges = 0;
  const auto inside = [&](Index v) {
    const auto far = (model.rest.row(v).head<2>().array() - BlockOnFloor::size / 2).abs().maxCoeff();
    return std::abs(model.rest(v, 2) - 0.5) < 1e-9 && far < BlockOnFloor::size / 2 - 1e-9;
  };
  for (const auto& [a, b, node] : model.contact.edges) {
    if (!inside(a) && !inside(b)) continue;
    for (const Index corner : {a, b}) {
      if (!inside(corner)) continue;
      EXPECT_LT(gradient.row(corner).norm(), 1e-12 * pressure * cell * cell);
      ++corners;
    }
    if (!inside(a) || !inside(b)) continue;
    EXPECT_NEAR(-gradient(node, 2), pressure * cell * cell / 3, 1e-12 * pressure * cell * cell);  // of two faces
    ++edges;
  }
  EXPECT_GE(corners, 16);
  EXPECT_GE(edges, 4);
}

/// Of one face, from quadrature of its shape functions: what it encloses with a plane.
TEST(ContactPoints, EncloseWhatTheFaceEncloses) {
  NearBlocks blocks(true);
  const Points& rest = blocks.model.rest;
  Points lifted = rest, room;
  lifted.col(2) += noise(rest.rows(), 0.5, 2).col(2);
  const Points points = blocks.contacts.points().of(lifted, room);
  const auto& triangles = blocks.model.contact.triangles;
  int looked_at = 0;
  for (std::size_t t = 0; t < triangles.size(); t += 4) {
    const Index a = triangles[t][0], b = triangles[t + 1][1], c = triangles[t + 2][2];
    const double twice = (rest.row(b) - rest.row(a)).head<3>().cross((rest.row(c) - rest.row(a)).head<3>()).z();
    if (std::abs(twice) < 1) continue;  // upright
    double of_face = 0, of_triangles = 0;
    for (const Index node : triangles[t + 3]) of_face += std::abs(twice) / 2 * lifted(node, 2) / 3;
    for (std::size_t i = t; i < t + 4; ++i)
      for (const Index v : triangles[i]) of_triangles += std::abs(twice) / 8 * points(v, 2) / 3;
    EXPECT_NEAR(of_triangles, of_face, 1e-12 * std::abs(of_face));
    ++looked_at;
  }
  EXPECT_GT(looked_at, 10);
}

TEST(ContactPoints, AreNodesInTheMiddleOfStraightEdgesAndOfOrderOne) {
  for (const bool quadratic : {false, true}) {
    const NearBlocks blocks(quadratic);
    EXPECT_EQ(blocks.contacts.points().are_nodes(), !quadratic);
    EXPECT_EQ(physical::ContactPoints::in(blocks.model, blocks.model.rest), blocks.model.rest);
    Points room;
    const Points& points = blocks.contacts.points().of(blocks.near, room);
    EXPECT_EQ(&points == &blocks.near, !quadratic);
  }
}

}  // namespace
}  // namespace softkin
