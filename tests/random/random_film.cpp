#include <softkin/model/layer.hpp>

#include "random/parts.hpp"
#include "statics/pillows.hpp"

namespace softkin::random_robots {

using namespace testing;

namespace {

constexpr std::uint64_t draws_of_films = 0x66696C6D73;

/// A rectangle of squares with their diagonals, moved about in its plane.
Sheet random_rectangle(Draw& draw) {
  Sheet sheet;
  const int along = draw.whole(3, 8), across = draw.whole(3, 8);
  const double length = draw.between(0.5, 2);
  const auto place = [&](int i, int j) { return static_cast<Index>(i * (across + 1) + j); };
  for (int i = 0; i <= along; ++i)
    for (int j = 0; j <= across; ++j) {
      const bool rim = i == 0 || j == 0 || i == along || j == across;
      Vec3 point(length * (2.0 * i / along - 1), 2.0 * j / across - 1, 0);
      if (!rim) {
        const double y = draw.between(-1, 1), x = draw.between(-1, 1);
        point += 0.2 / std::max(along, across) * Vec3(x, y, 0);
      }
      sheet.points.push_back(point);
      sheet.rim.push_back(rim);
      if (i == along || j == across) continue;
      const Index a = place(i, j), b = place(i + 1, j), c = place(i + 1, j + 1), d = place(i, j + 1);
      // a triangle of the rim alone would lie on its like
      const bool up = (i == 0 && j == 0) || (i == along - 1 && j == across - 1);
      const bool down = (i == 0 && j == across - 1) || (i == along - 1 && j == 0);
      if (draw.chance(0.5) ? !down : up)
        sheet.triangles.insert(sheet.triangles.end(), {{a, b, c}, {a, c, d}});
      else
        sheet.triangles.insert(sheet.triangles.end(), {{a, b, d}, {b, c, d}});
    }
  return sheet;
}

std::shared_ptr<const LayerSpec> random_film(Draw& draw, double radius, double modulus) {
  LayerSpec film = *film_layer("all", radius * draw.log_between(5e-4, 2e-2), modulus);
  film.tension_only = draw.chance(0.7);
  film.density = draw.chance(0.3) ? draw.between(900, 1500) : 0;
  if (draw.chance(0.25)) {
    film.e2 = film.e1 * draw.log_between(0.1, 1);
    film.g12 = film.e2 * draw.between(0.2, 0.5);
    film.direction = Vec3(1, draw.between(-1, 1), 0);
  } else if (draw.chance(0.3)) {
    film.rubber = SheetRubber{modulus / 6, modulus * draw.between(0, 0.02), 0, 0};
  }
  return std::make_shared<const LayerSpec>(film);
}

/// A bag lies on a floor, just above it.
void lay_on_floor(Draw& draw, double radius, RobotSpec& spec) {
  spec.contact.emplace();
  spec.contact->distance_mm = radius * draw.log_between(1e-3, 5e-3);
  spec.contact->obstacles.push_back(
      {"floor", Halfspace{{0, 0, -1.5 * *spec.contact->distance_mm}, {0, 0, 1}}, std::nullopt, {}});
  spec.loads.gravity = {0, 0, -9.81};
}

}  // namespace

bool make_film(Making& m) {
  Draw draw(m.made.seed ^ draws_of_films);
  if (!draw.chance(0.02)) return false;
  const double radius = draw.log_between(5, 200), modulus = draw.log_between(0.5, 5000);
  Sheet sheet = draw.chance(0.5) ? disc(1, draw.whole(2, 6)) : random_rectangle(draw);
  for (Vec3& point : sheet.points) point *= radius;
  const Control control = draw.chance(0.6) ? Control::load : Control::filling;
  RobotSpec spec = film_robot(pillow(sheet), control);
  spec.name = m.made.spec.name;
  spec.layers = {random_film(draw, radius, modulus)};
  const double stretch = draw.log_between(1e-4, 0.1);  // about, by the largest pressure
  ActuatorSpec& air = spec.actuators[0];
  air.high = control == Control::load ? 1e3 * stretch * modulus * spec.layers[0]->thickness_mm / radius
                                      : 1e-3 * std::pow(radius, 3) * draw.between(1, 4);
  air.low = control == Control::load ? 0 : 0.1 * air.high;
  if (draw.chance(0.25)) lay_on_floor(draw, radius, spec);
  for (int i = draw.whole(1, 3); i > 0; --i)
    m.made.commands.push_back(Actuation::Constant(1, air.low + draw.between(0, 1) * (air.high - air.low)));
  m.made.spec = std::move(spec);
  m.made.options.threads = 1;
  return true;
}

}  // namespace softkin::random_robots
