#include <gtest/gtest.h>

#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <softkin/model/mesh/profile_arc.hpp>
#include <softkin/model/mesh/quadratic_elements.hpp>
#include <softkin/model/model.hpp>

#include "model/physical_robots.hpp"
#include "model/turned_body.hpp"

namespace softkin {

namespace {

using namespace testing;

constexpr double turned_pi = std::numbers::pi;

struct TurnedResult {
  double exact = 0, straight = 0, curved = 0;  // volumes [mm^3]
  CurvedEdges done;
  double least_quality = HUGE_VAL;  // of the elements' Jacobians over those with straight edges
};

TurnedResult curve_turned(const TurnedBody& body, unsigned seed = 1) {
  Mesh mesh = elevated(body.mesh(seed));
  TurnedResult result{body.volume(), measure_curved(mesh).volume, 0, {}};
  CurveSpec smooth;
  smooth.smooth = true;
  result.done = curve_edges(mesh, labels_of(mesh, mesh.regions), smooth);
  result.curved = measure_curved(mesh).volume;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
    result.least_quality =
        std::min(result.least_quality, least_jacobian(nodes_of(mesh.vertices, mesh.tetrahedra[t], mesh.edge_nodes[t])) /
                                           (6 * signed_volume(mesh.vertices, mesh.tetrahedra[t])));
  return result;
}

/// A shaft of 10 mm radius around a piece between z = 15 and z = 25.
TurnedBody shaft_with(std::vector<ProfilePiece> pieces, int corners) {
  TurnedBody body;
  body.corners = corners;
  body.pieces.push_back(profile_line({0, 10}, {15, 10}, 3));
  body.pieces.insert(body.pieces.end(), pieces.begin(), pieces.end());
  body.pieces.push_back(profile_line({25, 10}, {40, 10}, 3));
  return body;
}

/// Half a circle of 5 mm radius.
TurnedBody grooved_shaft(int elements, int corners, double slide = 0) {
  TurnedBody body = shaft_with({profile_arc_piece({20, 10}, 5, turned_pi, 2 * turned_pi, elements)}, corners);
  body.slide = slide;
  return body;
}

bool is_valid(const Mesh& mesh) {
  double sum = 0, least = HUGE_VAL;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    sum += signed_volume(mesh.vertices, t);
    least = std::min(least, signed_volume(mesh.vertices, t));
  }
  return least > 0 &&
         std::abs(enclosed_volume(mesh.vertices, boundary_of(mesh.tetrahedra, {}).triangles) - sum) < 1e-9 * sum;
}

ProfilePatch polyline(const std::vector<Vec2>& points, int first) {
  ProfilePatch patch;  // the edge first, then the other points
  std::vector<int> number(points.size());
  number[first] = 0;
  number[first + 1] = 1;
  int next = 2;
  for (int i = 0; i < std::ssize(points); ++i)
    if (i != first && i != first + 1) number[i] = next++;
  patch.points.resize(points.size());
  patch.neighbours.resize(points.size());
  for (int i = 0; i < std::ssize(points); ++i) {
    patch.points[number[i]] = points[i];
    if (i > 0) patch.neighbours[number[i]].push_back(number[i - 1]);
    if (i + 1 < std::ssize(points)) patch.neighbours[number[i]].push_back(number[i + 1]);
  }
  return patch;
}

}  // namespace

/// The bend of an arc of radius R over a chord of length L is 1 / sqrt(4 R^2 - L^2).
TEST(ProfileArc, IsFoundFromFivePointsOfACircleAndNotFromThree) {
  std::vector<Vec2> groove{{-10, 10}, {-5, 10}};
  for (const double angle : {225.0, 270.0, 315.0})
    groove.emplace_back(5 * std::cos(angle * turned_pi / 180), 10 + 5 * std::sin(angle * turned_pi / 180));
  groove.insert(groove.end(), {{5, 10}, {10, 10}});
  const double chord = 2 * 5 * std::sin(turned_pi / 8);
  for (int edge = 1; edge < 5; ++edge) {
    const ProfileArc arc = profile_arc(polyline(groove, edge), false);
    EXPECT_TRUE(arc.determined) << edge;
    EXPECT_NEAR(arc.bend, 1 / std::sqrt(100 - chord * chord), 1e-9) << edge << " hollow: the centre is to the left";
  }
  EXPECT_EQ(profile_arc(polyline(groove, 0), true).bend, 0);
  const std::vector<Vec2> notch{{-10, 10}, {-5, 10}, {0, 5}, {5, 10}, {10, 10}};
  for (const int edge : {1, 2}) {
    const ProfileArc arc = profile_arc(polyline(notch, edge), false);
    EXPECT_FALSE(arc.determined);
    EXPECT_EQ(arc.bend, 0);
    EXPECT_LT(arc.least, -0.01);
    EXPECT_GT(arc.most, 0.01);
  }
}

TEST(ProfileArc, IsStraightBetweenTheCornersOfASquareGroove) {
  const std::vector<Vec2> groove{{-15, 10}, {-10, 10}, {-5, 10}, {-5, 5}, {0, 5}, {0, 10}, {5, 10}, {10, 10}};
  for (int edge = 0; edge + 1 < std::ssize(groove); ++edge) {
    const ProfileArc arc = profile_arc(polyline(groove, edge), true);
    EXPECT_TRUE(arc.determined) << edge;
    EXPECT_EQ(arc.bend, 0) << edge;
  }
}

/// A quarter of a circle in two chords, tangent to both neighbours: full at a rounded end, hollow at a shoulder.
TEST(ProfileArc, IsFoundFromTwoChordsThatAreTangentToTheirNeighbours) {
  for (const double sign : {1.0, -1.0}) {
    std::vector<Vec2> fillet{{-10, 0}, {-5, 0}, {0, 0}};
    for (const double angle : {45.0, 90.0})
      fillet.emplace_back(3 * std::sin(angle * turned_pi / 180), sign * 3 * (std::cos(angle * turned_pi / 180) - 1));
    fillet.emplace_back(3, -sign * 6);
    fillet.emplace_back(3, -sign * 9);
    const double chord = 2 * 3 * std::sin(turned_pi / 8);
    for (const int edge : {2, 3}) {
      const ProfileArc arc = profile_arc(polyline(fillet, edge), false);
      EXPECT_TRUE(arc.determined);
      EXPECT_NEAR(arc.bend, -sign / std::sqrt(36 - chord * chord), 1e-9);
    }
  }
}

TEST(TurnedBodies, GroovesAreHollowWhereTheMeshDeterminesThem) {
  for (const auto& [elements, slide] : {std::pair(3, 0.0), std::pair(4, 0.0), std::pair(6, 0.0), std::pair(3, 0.25)}) {
    const TurnedResult groove = curve_turned(grooved_shaft(elements, 9, slide));
    EXPECT_NEAR(groove.curved, groove.exact, 6e-3 * groove.exact) << elements;
    EXPECT_LT(groove.straight, 0.965 * groove.exact);
    EXPECT_EQ(groove.done.left_straight, 0u);
  }
}

/// Three vertices across a groove may be a notch with flat walls, or half a circle.
TEST(TurnedBodies, NothingCurvesWhereAGrooveMayBeANotch) {
  const TurnedResult groove = curve_turned(grooved_shaft(2, 9));
  EXPECT_EQ(groove.done.moved, 0u);
  EXPECT_GT(groove.done.left_straight, 100u);
  EXPECT_FALSE(groove.done.would_fold);
  EXPECT_NEAR(std::abs(groove.done.doubtful_place[0] - 20), 2.5, 1e-9) << "in the groove's walls";
}

TEST(TurnedBodies, AdviceIsGivenWhereCurvingHelpsAlone) {
  const auto compiled = [](const TurnedBody& body) {
    RobotSpec spec = physical_robot(body.mesh(1));
    spec.fixed = {{{Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}, {}}}};
    spec.mesh_options.quadratic = true;
    return compile(spec);
  };
  const auto has = [](const std::vector<std::string>& texts, const std::string& part) {
    return std::any_of(texts.begin(), texts.end(),
                       [&](const std::string& text) { return text.find(part) != std::string::npos; });
  };
  const Model known = compiled(grooved_shaft(4, 9)), unknown = compiled(grooved_shaft(2, 9));
  EXPECT_TRUE(has(known.warnings, "The edges are straight where the surface through the vertices is round"));
  EXPECT_FALSE(has(unknown.warnings, "curve: true"));
  EXPECT_TRUE(has(unknown.notes, "'curve: true' would not help"));
  EXPECT_TRUE(has(unknown.notes, "too coarse to determine whether the surface is flat, full or hollow"));
}

/// Shafts with one to five grooves, beads, notches, bellows, shoulders with hollow fillets and rounded ends each.
TEST(TurnedBodies, VolumesOfRandomOnesComeNearerOrStay) {
  int nearer = 0, same = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const TurnedBody body = RandomTurned(seed).draw();
    if (!is_valid(body.mesh(seed))) continue;
    const TurnedResult result = curve_turned(body, seed);
    EXPECT_LE(std::abs(result.curved - result.exact), std::abs(result.straight - result.exact) * (1 + 1e-9)) << seed;
    EXPECT_GT(result.least_quality, 0.1 - 1e-9) << seed;
    EXPECT_EQ(result.done.moved == 0, result.done.left_straight > 0) << seed;
    ++(result.done.moved == 0 ? same : nearer);
  }
  EXPECT_GT(nearer, 35);
  EXPECT_GT(same, 0);
}

}  // namespace softkin
