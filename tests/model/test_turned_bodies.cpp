#include <gtest/gtest.h>

#include <softkin/model/mesh/boundary.hpp>
#include <softkin/model/mesh/curved_edges.hpp>
#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/model/mesh/mesh_review.hpp>
#include <softkin/model/model.hpp>

#include "model/physical_robots.hpp"
#include "model/turned_body.hpp"

/// Bodies of revolution with grooves, beads, notches, bellows, fillets and shoulders: volumes with straight and with
/// curved edges against the exact ones.

namespace softkin {

namespace {

using namespace testing;

bool is_valid_turned(const Mesh& mesh) {
  double sum = 0, least = HUGE_VAL;
  for (const Tetrahedron& t : mesh.tetrahedra) {
    sum += signed_volume(mesh.vertices, t);
    least = std::min(least, signed_volume(mesh.vertices, t));
  }
  return least > 0 &&
         std::abs(enclosed_volume(mesh.vertices, boundary_of(mesh.tetrahedra, {}).triangles) - sum) < 1e-9 * sum;
}

/// Errors of the volume over the exact one.
struct TurnedErrors {
  double straight = 0, curved = 0;
};

TurnedErrors errors_of(const TurnedBody& body, unsigned seed, int finer) {
  Mesh mesh = elevated(body.mesh(seed, finer));
  const double exact = body.volume(), straight = measure_curved(mesh).volume;
  CurveSpec smooth;
  smooth.smooth = true;
  (void)curve_edges(mesh, labels_of(mesh, mesh.regions), smooth);
  return {std::abs(straight / exact - 1), std::abs(measure_curved(mesh).volume / exact - 1)};
}

bool is_advised_to_curve(const TurnedBody& body, unsigned seed) {
  RobotSpec spec = physical_robot(body.mesh(seed));
  spec.fixed = {{{Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}, {}}}};
  spec.mesh_options.quadratic = true;
  const std::vector<std::string> warnings = compile(spec).warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [](const std::string& text) { return text.find("curve: true") != std::string::npos; });
}

/// A shaft of 10 mm radius with a groove of half a circle of 5 mm.
TurnedBody grooved_shaft(int elements, int corners) {
  constexpr double pi = std::numbers::pi;
  TurnedBody body;
  body.corners = corners;
  body.pieces = {profile_line({0, 10}, {15, 10}, 3), profile_arc_piece({20, 10}, 5, pi, 2 * pi, elements),
                 profile_line({25, 10}, {40, 10}, 3)};
  return body;
}

}  // namespace

/// Where it is advised, volumes of coarse meshes come nearer, every one.
TEST(TurnedBodies, TheAdviceToCurveBringsVolumesNearer) {
  int advised = 0, silent = 0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    const TurnedBody body = RandomTurned(seed).draw();
    if (!is_valid_turned(body.mesh(seed))) continue;
    if (!is_advised_to_curve(body, seed)) {
      ++silent;
      continue;
    }
    ++advised;
    const TurnedErrors errors = errors_of(body, seed, 1);
    EXPECT_LT(errors.curved, errors.straight) << seed;
  }
  EXPECT_GT(advised, 25);
  EXPECT_GT(silent, 25);
}

/// With elements of half the size nearly all come nearer, by nine times in the mean.
TEST(TurnedBodies, CurvesOfResolvedSurfacesBringVolumesNearer) {
  int nearer = 0, farther = 0;
  double straight = 0, curved = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const TurnedBody body = RandomTurned(seed).draw();
    if (!is_valid_turned(body.mesh(seed, 2))) continue;
    const TurnedErrors errors = errors_of(body, seed, 2);
    ++(errors.curved < errors.straight ? nearer : farther);
    straight += errors.straight;
    curved += errors.curved;
  }
  EXPECT_LE(farther, nearer / 30);
  EXPECT_LT(curved, 0.12 * straight);
}

/// Three vertices across a groove may be a notch with flat walls, or half a circle.
TEST(TurnedBodies, NoAdviceIsGivenWhereAGrooveMayBeANotch) {
  for (const int corners : {8, 9, 12, 14}) EXPECT_FALSE(is_advised_to_curve(grooved_shaft(2, corners), 1)) << corners;
}

/// Hollow and full arcs in turn of two elements each: where one follows the other the edge may bend to either side.
TEST(TurnedBodies, CurvingNamesWhereTheMeshIsTooCoarse) {
  constexpr double right = 0.5 * std::numbers::pi, angle = 0.7;
  const double across = 4 * std::sin(angle), down = 4 * (1 - std::cos(angle));
  const auto notes_of = [&](int elements) {
    TurnedBody body;
    body.pieces = {
        profile_line({0, 10}, {10, 10}, 2), profile_arc_piece({10, 6}, 4, right, right - angle, elements),
        profile_arc_piece({10 + 2 * across, 14 - 2 * down}, 4, 3 * right - angle, 3 * right + angle, 2 * elements),
        profile_arc_piece({10 + 4 * across, 6}, 4, right + angle, right, elements),
        profile_line({10 + 4 * across, 10}, {20 + 4 * across, 10}, 2)};
    RobotSpec spec = physical_robot(body.mesh(1));
    spec.fixed = {{{Halfspace{{1e-6, 0, 0}, {-1, 0, 0}}, {}}}};
    spec.mesh_options.quadratic = true;
    spec.mesh_options.curve.emplace().smooth = true;
    std::string all;
    for (const std::string& note : compile(spec).notes) all += note;
    return all;
  };
  EXPECT_NE(notes_of(1).find("too coarse to determine how the surface runs at"), std::string::npos) << notes_of(1);
  EXPECT_EQ(notes_of(6).find("too coarse"), std::string::npos) << notes_of(6);
}

}  // namespace softkin
