#include <softkin/model/mesh/mesh_order.hpp>
#include <softkin/statics/deformation.hpp>

#include "contact/sphere.hpp"
#include "statics/physical_equations.hpp"
#include "statics/physical_samples.hpp"
#include "statics/pillows.hpp"

/// Robots of layers alone: bags that are inflated from flat.

namespace softkin {

namespace {

using namespace testing;
using contact::testing::make_sphere;
using Ball = contact::testing::Sphere;

/// Of two discs of radius 1 that do not stretch: what Paulsen's surface of revolution has, along whose meridians alone
/// the film is pulled. Its profile has dy/dx = - x^2 / sqrt(r^4 - x^4).
struct Mylar {
  double height = 0, volume = 0;

  Mylar() {
    constexpr int steps = 20000;
    double meridian = 0;  // of r = 1, with x^2 = sin(u^2): no integrand has a pole
    for (int i = 0; i < steps; ++i) {
      const double width = std::sqrt(std::numbers::pi / 2) / steps, u = (i + 0.5) * width;
      const double x = std::sqrt(std::sin(u * u)), angle = 2 * u * width;
      meridian += angle / (2 * x);
      height += angle * x;                             // of both sides
      volume += angle * std::numbers::pi * x * x * x;  // shells: 2 pi x times the height there, by parts
    }
    height /= meridian;
    volume /= std::pow(meridian, 3);
  }
};

}  // namespace

TEST(Sheets, DiscsBecomeMylarBalloons) {
  constexpr double radius = 100;
  const Mylar known;
  EXPECT_NEAR(known.height, 0.9139, 1e-4);
  const Pillow made = pillow(disc(radius, 10));
  const Model model = compile(film_robot(made));
  ASSERT_TRUE(flat_at_rest(model.actuators[0]));
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, Actuation::Constant(1, 1.0));
  EXPECT_EQ(found.report.physical.unstable_modes, 0);
  EXPECT_NEAR(across(made, found.state.positions), known.height * radius, 0.02 * known.height * radius);
  const double volume = enclosed_volume(found.state.positions, model.actuators[0].as<ChamberDrive>()->cavity);
  EXPECT_NEAR(volume, known.volume * std::pow(radius, 3), 0.02 * volume);
  EXPECT_NEAR(achieved_ratio(model, model.actuators[0], found.state.positions), volume / 1000, 1e-9 * volume);  // mL
  // the pressure does work: more of it is nearly the same shape, found from there
  const Equilibrium more = statics.solve(Actuation::Constant(1, 2.0), found.state, {}, {});
  EXPECT_EQ(more.report.status, Status::converged);
  EXPECT_LT(more.report.iterations, 30);
  EXPECT_GT(enclosed_volume(more.state.positions, model.actuators[0].as<ChamberDrive>()->cavity), volume);
}

TEST(Sheets, WithoutLoadsTheyLieAsTheyWereCut) {
  const Pillow made = pillow(disc(50, 4));
  const Model model = compile(film_robot(made));
  const Equilibrium found = solve_converged(Statics(model), Actuation::Constant(1, 0.0));
  EXPECT_EQ(found.state.positions, model.rest);
}

TEST(Sheets, GasOfABagFollowsBoyle) {
  const Pillow made = pillow(disc(100, 6));
  const Model model = compile(film_robot(made, Control::filling, 2000));
  constexpr double amount_mL = 1300, atmosphere_kPa = 101.325;
  const Equilibrium found = solve_converged(Statics(model), Actuation::Constant(1, amount_mL));
  const double volume_mL = enclosed_volume(found.state.positions, model.actuators[0].as<ChamberDrive>()->cavity) / 1000;
  EXPECT_GT(found.state.multipliers[0], 1);
  EXPECT_NEAR((found.state.multipliers[0] + atmosphere_kPa) * volume_mL, atmosphere_kPa * amount_mL,
              1e-6 * atmosphere_kPa * amount_mL);
}

/// A balloon of rubber, held so that it neither moves nor turns.
RobotSpec balloon(const Ball& sphere, const SheetRubber& rubber, double thickness_mm) {
  RobotSpec spec;
  spec.name = "balloon.yaml";
  spec.formulation = Formulation::physical;
  spec.mesh.vertices = sphere.points;
  for (const auto& t : sphere.triangles) spec.mesh.triangles.push_back(t);
  LayerSpec skin;
  skin.name = "skin";
  skin.where = RegionRef{std::string("all"), {}};
  skin.thickness_mm = thickness_mm;
  skin.rubber = rubber;
  spec.layers.push_back(std::make_shared<const LayerSpec>(skin));
  const auto one = [](Index v) { return RegionRef{Selector(VertexList{{v}}), {}}; };
  spec.fixed = {{one(5), {true, true, true}}, {one(2), {true, true, false}}, {one(0), {false, true, false}}};
  ActuatorSpec air;
  air.name = "air";
  air.drive = PneumaticSpec{.wall = "all"};
  air.low = 1;
  air.high = 30;
  spec.actuators.push_back(air);
  return spec;
}

/// p = 2 h S / (r l) of a sphere that is stretched by l, S the second Piola-Kirchhoff stress along either direction.
TEST(Sheets, ABalloonOfRubberBearsWhatItsLawSays) {
  constexpr double radius = 50, thickness = 0.4;
  const Ball sphere = make_sphere(4, radius);
  for (const SheetRubber& rubber :
       {SheetRubber{0.1, 0, 0, 0}, SheetRubber{0.08, 0.01, 0, 0}, SheetRubber{0.1, 0, 0, 1e-4}}) {
    const Model model = compile(balloon(sphere, rubber, thickness));
    const Statics statics(model);
    State from = statics.rest();
    for (const double stretch : {1.05, std::pow(7.0, 1.0 / 6), 2.0, 2.9}) {
      const Equilibrium found = statics.solve(Actuation::Constant(1, std::pow(stretch, 3)), from);
      ASSERT_EQ(found.report.status, Status::converged) << stretch << ": " << found.report.remark;
      const double second = stretch * stretch, over = 2 * second + 1 / (second * second) - 3;
      const double by_first = rubber.c10 + 3 * rubber.c30 * over * over;
      const double tension = 2 * (by_first + rubber.c01 * second) * (1 - std::pow(stretch, -6));  // S of each axis
      const double pressure_kPa = 2 * thickness * tension / (radius * stretch) * 1000;
      EXPECT_NEAR(found.state.multipliers[0], pressure_kPa, 5e-3 * pressure_kPa) << stretch;
      from = found.state;
    }
  }
}

/// A rectangle of squares, divided by either diagonal, of a film with bending stiffness; order 2.
RobotSpec bending_sheet(const Vec3& from, const Vec3& to, int along, int across, double thickness_mm, double modulus,
                        double nu) {
  RobotSpec spec;
  spec.name = "sheet.yaml";
  spec.formulation = Formulation::physical;
  spec.mesh_options.quadratic = true;
  spec.mesh.vertices.resize((along + 1) * (across + 1), 3);
  const auto place = [&](int i, int j) { return static_cast<Index>(i * (across + 1) + j); };
  for (int i = 0; i <= along; ++i)
    for (int j = 0; j <= across; ++j) {
      const Vec3 fraction(static_cast<double>(i) / along, static_cast<double>(j) / across, 0);
      spec.mesh.vertices.row(place(i, j)) = (from + fraction.cwiseProduct(to - from)).transpose();
      if (i == along || j == across) continue;
      const Index a = place(i, j), b = place(i + 1, j), c = place(i + 1, j + 1), d = place(i, j + 1);
      if ((i + j) % 2 == 0)
        spec.mesh.triangles.insert(spec.mesh.triangles.end(), {{a, b, c}, {a, c, d}});
      else
        spec.mesh.triangles.insert(spec.mesh.triangles.end(), {{a, b, d}, {b, c, d}});
    }
  LayerSpec film = *film_layer("all", thickness_mm, modulus);
  film.nu12 = nu;
  film.g12 = modulus / (2 * (1 + nu));
  film.tension_only = false;
  film.bending = true;
  spec.layers.push_back(std::make_shared<const LayerSpec>(film));
  return spec;
}

FixedSpec held_in(const Vec3& low, const Vec3& high, const std::array<bool, 3>& axes) {
  return {{Selector(Box{low, high}), {}}, axes};
}

/// A square without a body, held up along its border, under its weight: Timoshenko and Woinowsky-Krieger, table 8.
TEST(Sheets, ThatBendSinkAsKirchhoffSays) {
  constexpr double side = 40, thickness = 0.5, modulus = 100, nu = 0.3, density = 100;
  RobotSpec spec = bending_sheet({0, 0, 0}, {side, side, 0}, 20, 20, thickness, modulus, nu);
  auto heavy = std::make_shared<LayerSpec>(*spec.layers[0]);
  heavy->density = density;
  spec.layers = {heavy};
  spec.loads.gravity = {0, 0, -9.81};
  const Vec3 low(-1, -1, -1), high(side + 1, side + 1, 1);
  for (int axis = 0; axis < 2; ++axis) {
    Vec3 end = high, begin = low;
    end[axis] = 1e-6;
    begin[axis] = side - 1e-6;
    spec.fixed.push_back(held_in(low, end, {false, false, true}));
    spec.fixed.push_back(held_in(begin, high, {false, false, true}));
  }
  spec.fixed.push_back(held_in(low, {1e-6, 1e-6, 1}, {true, true, true}));
  spec.fixed.push_back(held_in({side - 1e-6, -1, -1}, {side + 1, 1e-6, 1}, {false, true, true}));
  spec.markers = {{"middle", {Vec3(side / 2, side / 2, 0), {}}}};
  const Model model = compile(spec);
  EXPECT_EQ(order_of(model), 2);
  const Statics statics(model);
  const Equilibrium found = solve_converged(statics, model.rest_actuation());
  const double load = density * 1e-9 * 9.81 * thickness;  // [N/mm^2]
  const double rigidity = modulus * std::pow(thickness, 3) / (12 * (1 - nu * nu));
  const double sinks = 0.0040624 * load * std::pow(side, 4) / rigidity;
  EXPECT_NEAR(-marker_at(model, found)[2], sinks, 0.01 * sinks);
  EXPECT_LT(found.report.iterations, 20);
}

/// A strip without a body, clamped by a row of its faces, bent far by a force at its end: K. E. Bisshopp, D. C.
/// Drucker, "Large deflection of cantilever beams", 1945.
TEST(Sheets, ThatBendFollowTheElastica) {
  constexpr double length = 60, width = 6, thickness = 0.5, modulus = 100;
  RobotSpec spec = bending_sheet({-3, 0, 0}, {length, width, 0}, 21, 2, thickness, modulus, 0);
  spec.fixed = {held_in({-9, -1, -1}, {1e-6, width + 1, 1}, {true, true, true})};
  spec.markers = {{"tip", {Vec3(length, width / 2, 0), {}}}};
  spec.regions = {{"end", Selector(Box{{length - 1e-6, -1, -1}, {length + 1, width + 1, 1}}), {}}};
  const double rigidity = modulus * width * std::pow(thickness, 3) / 12;
  for (const auto& [times, sinks, shortens] : {std::array{1.0, 0.3017, 0.0564}, std::array{10.0, 0.8106, 0.5550}}) {
    ForceSpec end;
    end.name = "end";
    end.at = {std::string("end"), {}};
    end.force = {0, 0, -times * rigidity / (length * length)};
    spec.loads.forces = {end};
    const Model model = compile(spec);
    const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
    const Vec3 tip = marker_at(model, found);
    EXPECT_NEAR(-tip[2], sinks * length, 0.01 * sinks * length) << times;
    EXPECT_NEAR(length - tip[0], shortens * length, 0.01 * length) << times;
  }
}

TEST(Sheets, HangOnABodyAndPullIt) {
  // a flap of film beside a block, pulled in its plane: it stretches as a strip of its width does
  constexpr double force = 0.5, thickness = 0.1, modulus = 50;
  RobotSpec spec = physical_robot(block_mesh({2, 2, 2}, {10, 10, 10}));
  spec.fixed = {{{Selector(Box{{-1, -1, -1}, {11, 11, 11}}), {}}, {true, true, true}}};
  Mesh& mesh = spec.mesh;
  const Index before = mesh.vertices.rows();
  const auto corner = [&](double y) {
    for (Index v = 0; v < before; ++v)
      if ((vertex_at(mesh.vertices, v) - Vec3(10, y, 10)).norm() < 1e-9) return v;
    return Index{-1};
  };
  mesh.vertices.conservativeResize(before + 3, 3);
  for (Index i = 0; i < 3; ++i) mesh.vertices.row(before + i) = Vec3(30, 5 * i, 10).transpose();
  Region flap{"flap", 2, {}, {}, {}, {}, {}};
  for (Index i = 0; i < 2; ++i)
    for (const Triangle& t : {Triangle{corner(5.0 * i), before + i, before + i + 1},
                              Triangle{corner(5.0 * i), before + i + 1, corner(5.0 * i + 5)}}) {
      flap.triangles.push_back(mesh.triangles.size());
      mesh.triangles.push_back(t);
    }
  mesh.regions.push_back(flap);
  LayerSpec film;
  film.name = "flap";
  film.where = RegionRef{std::string("flap"), {}};
  film.thickness_mm = thickness;
  film.e1 = film.e2 = modulus;
  film.g12 = modulus / 2;
  spec.layers.push_back(std::make_shared<const LayerSpec>(film));
  const RegionRef end{Selector(VertexList{{before, before + 1, before + 2}}), {}};
  spec.fixed.push_back({end, {false, true, true}});
  for (Index i = 0; i < 3; ++i) {  // as a pull that is even over the width
    const std::string name = "end" + std::to_string(i);
    spec.regions.push_back({name, VertexList{{before + i}}, {}});
    spec.loads.forces.push_back({name, {name, {}}, {force * (i == 1 ? 0.5 : 0.25), 0, 0}});
  }
  spec.markers = {{"end", {Vec3(30, 5, 10), {}}}};
  const Model model = compile(spec);
  const Equilibrium found = solve_converged(Statics(model), model.rest_actuation());
  const double moved = model.markers[0].at(found.state.positions).x() - 30;
  // S = E (s^2 - 1) / 2 along it, force = width thickness s S
  const double s = 1 + moved / 20;
  EXPECT_NEAR(10 * thickness * s * modulus * (s * s - 1) / 2, force, 1e-6 * force);
}

TEST(Sheets, AreRefusedWithAReason) {
  const auto refusal = [](const std::function<void(RobotSpec&)>& change) {
    RobotSpec spec = film_robot(pillow(disc(50, 3)));
    change(spec);
    try {
      (void)compile(spec);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refusal([](RobotSpec&) {}), "accepted");
  const auto expect_says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect_says(refusal([](RobotSpec& spec) { spec.layers.clear(); }), "triangles and no volume element");
  expect_says(refusal([](RobotSpec& spec) {
                spec.actuators[0].control = Control::ratio;
                spec.actuators[0].low = spec.actuators[0].high = spec.actuators[0].rest = 1;
              }),
              "is flat at rest");
  expect_says(refusal([](RobotSpec& spec) { spec.fixed.pop_back(); }), "can turn about");
  expect_says(refusal([](RobotSpec& spec) {
                auto film = *spec.layers[0];
                film.bending = true;
                spec.layers[0] = std::make_shared<const LayerSpec>(film);
              }),
              "order 2");
  expect_says(refusal([](RobotSpec& spec) {  // a mesh of order 2 whose triangles have no nodes on their edges
                Mesh mesh = elevated(block_mesh({1, 1, 1}, {10, 10, 10}));
                const Index before = mesh.vertices.rows();
                mesh.vertices.conservativeResize(before + 1, 3);
                mesh.vertices.bottomRows(1) << 20, 0, 0;
                mesh.regions.push_back({"flap", 2, {}, {}, {static_cast<Index>(mesh.triangles.size())}, {}, {}});
                mesh.triangles.push_back({0, 1, before});
                RobotSpec flagged = physical_robot(std::move(mesh));
                flagged.layers = {film_layer("flap", 0.1, 50)};
                spec = std::move(flagged);
              }),
              "of which a vertex belongs to no element");
  expect_says(refusal([](RobotSpec& spec) { spec.markers = {{"far", {Vec3(0, 0, 40), {}}}}; }), "from the mesh");
}

}  // namespace softkin
