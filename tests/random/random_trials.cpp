#include <Eigen/Geometry>
#include <softkin/model/layer.hpp>

#include "random/parts.hpp"

namespace softkin::random_robots {

namespace {

/// Draws of their own, so that robots of the same seed are otherwise what they were.
constexpr std::uint64_t draws_of_stiffness = 0x7374696666, draws_of_floor = 0x666C6F6F72,
                        draws_of_weights = 0x77656967687473, draws_of_turns = 0x7475726E73,
                        draws_of_tractions = 0x7472616374, draws_of_fibres = 0x666962726573,
                        draws_of_mixed = 0x6D69786564, draws_of_sealed = 0x7365616C6564,
                        draws_of_layers = 0x6C6179657273, draws_of_wrenches = 0x7772656E6368;

void scale(ElasticSpec& elastic, double by) {
  for (std::optional<double>* modulus : {&elastic.youngs_modulus, &elastic.shear_modulus, &elastic.bulk_modulus,
                                         &elastic.c10, &elastic.c01, &elastic.c20, &elastic.c30})
    if (*modulus) **modulus *= by;
}

}  // namespace

void make_stiff(Making& m) {
  Draw draw(m.made.seed ^ draws_of_stiffness);
  if (!m.physical || !draw.chance(0.15)) return;
  std::vector<MaterialSpec>& materials = m.made.spec.materials;
  for (const char* part : {"layer", "part0", "part1"}) {
    const bool is_there = std::any_of(m.mesh().regions.begin(), m.mesh().regions.end(),
                                      [&](const Region& region) { return region.name == part; });
    if (!is_there || materials.empty() || !materials.front().elastic) continue;
    MaterialSpec stiff = materials.front();
    stiff.region = part;
    scale(*stiff.elastic, draw.log_between(300, 3000));
    std::erase_if(materials, [&](const MaterialSpec& material) { return material.region == part; });
    materials.push_back(std::move(stiff));
    return;
  }
}

void make_weights(Making& m) {
  Draw draw(m.made.seed ^ draws_of_weights);
  if (!m.physical && draw.chance(0.3)) m.made.spec.weights = ElementWeights::mesh_independent;
  for (ActuatorSpec& actuator : m.made.spec.actuators)
    if (draw.chance(0.25)) actuator.distribution = Distribution::proportional;
}

void make_turns(Making& m) {
  Draw draw(m.made.seed ^ draws_of_turns);
  if (!draw.chance(0.12) || m.is(Oddity::supports)) return;
  for (FixedSpec& fixed : m.made.spec.fixed) {
    const bool whole = std::all_of(fixed.axes.begin(), fixed.axes.end(), [](bool axis) { return axis; });
    if (!whole || !draw.chance(0.7)) continue;
    fixed.rotation = RotationSpec{draw.offset(), draw.between(-60, 60), {}};
    if (draw.chance(0.5)) fixed.rotation->about = Vec3(m.size.cwiseProduct(draw.offset()));
    for (Actuation& actuation : m.made.commands) {
      actuation.conservativeResize(actuation.size() + 1);
      actuation[actuation.size() - 1] = draw.between(-60, 60);
    }
  }
}

void make_tractions(Making& m) {
  Draw draw(m.made.seed ^ draws_of_tractions);
  if (!m.physical || !draw.chance(0.12)) return;
  const double slender = std::min(1.0, std::min(m.size[1], m.size[2]) / m.size[0]);
  for (int i = draw.whole(1, 2); i > 0; --i) {
    const double kilopascals = 1e3 * draw.log_between(1e-6, 0.02) * slender * m.modulus;
    TractionSpec spec;
    spec.name = "traction" + std::to_string(i);
    spec.where = {std::string(draw.pick({"x_high", "z_high", "y_high", "z_low"})), {}};
    spec.follows = draw.chance(0.8);
    if (spec.follows && draw.chance(0.5))
      spec.pressure_kPa = draw.chance(0.5) ? kilopascals : -kilopascals;
    else
      spec.kilopascals = kilopascals * draw.offset();
    m.made.spec.loads.tractions.push_back(std::move(spec));
  }
}

void make_wrenches(Making& m) {
  Draw draw(m.made.seed ^ draws_of_wrenches);
  const auto command = [&](double value) {
    for (Actuation& actuation : m.made.commands) {
      actuation.conservativeResize(actuation.size() + 1);
      actuation[actuation.size() - 1] = value * draw.between(-1, 1);
    }
  };
  if (!m.physical) return;
  const double slender = std::min(1.0, std::min(m.size[1], m.size[2]) / m.size[0]);
  for (const RigidSpec& rigid : m.made.spec.rigid) {
    const auto* region = std::get_if<std::string>(&rigid.where.region);
    if (region == nullptr || !draw.chance(0.4)) continue;
    const double most = draw.log_between(1e-6, 0.1) * m.modulus * slender * m.size[1] * m.size[2] * m.size[2];
    ForceSpec wrench{"wrench", {*region, {}}};
    wrench.moment = most * draw.offset();
    if (draw.chance(0.5)) {
      Vec3 low = wrench.moment, high = wrench.moment;
      low[1] = -most;
      high[1] = most;
      wrench.moment[1] = 0;
      wrench.moment_range = std::array<Vec3, 2>{low, high};
      command(most);
    }
    m.made.spec.loads.forces.push_back(wrench);
    break;
  }
  for (TractionSpec& traction : m.made.spec.loads.tractions) {
    if (traction.pressure_kPa == 0 || !draw.chance(0.5)) continue;
    const double most = std::abs(traction.pressure_kPa);
    traction.range_kPa = {-most, most};
    command(most);
  }
}

void make_fibres(Making& m) {
  Draw draw(m.made.seed ^ draws_of_fibres);
  if (!draw.chance(m.physical ? 0.1 : 0.01) || m.mesh().vertices.rows() == 0) return;
  const Vec3 low = m.mesh().vertices.colwise().minCoeff().transpose(),
             size = m.mesh().vertices.colwise().maxCoeff().transpose() - low;
  const auto place = [&](double x, double y, double z) { return Vec3(low + size.cwiseProduct(Vec3(x, y, z))); };
  const auto anywhere = [&] {
    const double z = draw.unit(), y = draw.unit(), x = draw.unit();
    return place(x, y, z);
  };
  for (int i = draw.whole(1, 2); i > 0; --i) {
    FibreSpec fibre;
    fibre.name = "fibre" + std::to_string(i);
    if (draw.chance(0.4))
      fibre.path = Helix{.start = place(draw.between(0, 0.3), 0.5, 0.5),
                         .axis = Vec3::UnitX(),
                         .first = Vec3(0, draw.between(-1, 1), 1),
                         .radius = draw.between(0.2, 0.5) * std::min(size[1], size[2]),
                         .pitch = draw.between(0.05, 0.4) * size[0],
                         .turns = draw.between(0.3, 2),
                         .left_handed = draw.chance(0.5)};
    else
      fibre.path = std::vector<Vec3>{anywhere(), anywhere()};
    if (draw.chance(0.9)) fibre.stiffness_N = draw.log_between(1e-3, 30) * m.modulus * size[1] * size[2];
    fibre.tension_only = draw.chance(0.4);
    m.made.spec.fibres.push_back(std::move(fibre));
  }
}

void make_layers(Making& m) {
  Draw draw(m.made.seed ^ draws_of_layers);
  if (!draw.chance(m.physical ? 0.1 : 0.01) || (!m.mesh().prisms.empty() && draw.chance(0.8))) return;
  const double across = std::min(m.size[1], m.size[2]);
  for (int i = draw.whole(1, 2); i > 0; --i) {
    LayerSpec layer;
    layer.name = "layer" + std::to_string(i);
    layer.where = RegionRef{std::string(draw.pick({"x_high", "z_high", "y_high", "z_low"})), {}};
    layer.thickness_mm = draw.log_between(0.002, 0.05) * across;
    layer.e1 = draw.log_between(1, 300) * m.modulus;
    layer.e2 = draw.chance(0.5) ? layer.e1 : draw.log_between(0.05, 1) * layer.e1;
    layer.nu12 = draw.between(-0.3, 0.45);
    layer.g12 = layer.e1 == layer.e2 ? layer.e1 / (2 * (1 + layer.nu12)) : draw.between(0.1, 0.5) * layer.e2;
    if (layer.e1 != layer.e2) layer.direction = Vec3(1, 0.7, 0.4);
    layer.tension_only = draw.chance(0.3);
    layer.bending = m.made.spec.mesh_options.quadratic && draw.chance(0.6);
    if (layer.nu12 < -0.1 && !layer.bending) {  // drawn for another sheet: rubber in its place
      const double fraction = layer.thickness_mm / (0.05 * across);
      layer.rubber = SheetRubber{layer.e1 / 6 * (1 - fraction), layer.e1 / 6 * fraction, 0.05 * fraction * layer.e1, 0};
    }
    m.made.spec.layers.push_back(std::make_shared<const LayerSpec>(layer));
  }
}

void make_mixed(Making& m) {
  Draw draw(m.made.seed ^ draws_of_mixed);
  if (!m.physical || !m.mesh().prisms.empty() || !draw.chance(0.12)) return;
  for (MaterialSpec& material : m.made.spec.materials) {
    if (!material.elastic || !has_bulk_part(material.elastic->law) || !draw.chance(0.8)) continue;
    material.mixed = true;
    if (material.elastic->poisson_ratio && draw.chance(0.6))
      material.elastic->poisson_ratio = draw.pick({0.49, 0.499, 0.4999, 0.5});
  }
}

namespace {

/// Of a chamber at rest, about [mL].
double chamber_mL(const Mesh& mesh, const PneumaticSpec& chamber) {
  double mm3 = 0;
  if (chamber.surface) mm3 = std::abs(enclosed_volume(chamber.surface->vertices, chamber.surface->triangles));
  const auto corner = [&](Index v) { return Vec3(mesh.vertices.row(v).transpose()); };
  for (const Region& region : mesh.regions) {
    if (!chamber.region || region.name != *chamber.region) continue;
    for (const Index e : region.tetrahedra) {
      const Tetrahedron& t = mesh.tetrahedra[e];
      if (*std::min_element(t.begin(), t.end()) < 0 || *std::max_element(t.begin(), t.end()) >= mesh.vertices.rows())
        return 0;
      const Vec3 a = corner(t[0]);
      mm3 += std::abs((corner(t[1]) - a).dot((corner(t[2]) - a).cross(corner(t[3]) - a))) / 6;
    }
  }
  return mm3 / 1000;
}

}  // namespace

void make_sealed(Making& m) {
  Draw draw(m.made.seed ^ draws_of_sealed);
  if (!m.physical || !draw.chance(0.3)) return;
  std::vector<ActuatorSpec>& actuators = m.made.spec.actuators;
  for (std::size_t a = 0; a < actuators.size(); ++a) {
    ActuatorSpec& spec = actuators[a];
    auto* chamber = spec.as<PneumaticSpec>();
    if (chamber == nullptr || spec.control != Control::ratio) continue;
    const double rest = chamber_mL(m.mesh(), *chamber);
    if (!(rest > 0 && std::isfinite(rest))) continue;
    FillingSpec filling;
    filling.liquid = draw.chance(0.2);
    filling.atmosphere_kPa = 1e3 * m.modulus * draw.log_between(3e-3, 3);
    filling.exponent = draw.pick({1.0, 1.0, 1.4, 1.2});
    if (filling.liquid) filling.compressibility = draw.chance(0.2) ? 0 : draw.log_between(1e-5, 1) / m.modulus;
    if (draw.chance(0.5)) filling.dead_mL = rest * draw.log_between(0.01, 1);
    if (draw.chance(0.5)) filling.syringe_mL = rest * draw.log_between(1, 3);
    // what would be a ratio to rest is that of all that is sealed, or adds as much to the chamber
    const auto command = [&](double ratio) {
      return filling.syringe_mL ? std::min(rest * (ratio - 1), *filling.syringe_mL) : ratio * (rest + filling.dead_mL);
    };
    spec.control = Control::filling;
    spec.low = command(spec.low);
    spec.high = command(spec.high);
    chamber->filling = filling;
    for (Actuation& actuation : m.made.commands)
      if (static_cast<Index>(a) < actuation.size()) actuation[a] = command(actuation[a]);
  }
}

void make_floor(Making& m) {
  Draw draw(m.made.seed ^ draws_of_floor);
  if (!draw.chance(m.physical ? 0.15 : 0.01) || m.mesh().vertices.rows() == 0) return;
  RobotSpec& spec = m.made.spec;
  ContactSpec contact;
  contact.self = false;
  contact.distance_mm = draw.log_between(1e-3, 0.02) * m.size.minCoeff();
  const double gap = *contact.distance_mm * draw.between(1.01, 3);
  const double low = m.mesh().vertices.col(2).minCoeff();
  ObstacleSpec floor;
  floor.name = "floor";
  floor.shape = Halfspace{{0, 0, low - gap}, {0, 0, 1}};
  contact.obstacles.push_back(std::move(floor));
  spec.contact = std::move(contact);
  if (!draw.chance(0.7) || spec.materials.empty()) return;
  // scaled to about this strain of a column; a robot that is held at one end bends by far more
  const double strain = draw.log_between(1e-6, 1e-3), density = std::max(900.0, spec.materials[0].density);
  for (MaterialSpec& material : spec.materials) material.density = density;
  spec.loads.gravity = {0, 0, -strain * m.modulus / (1e-9 * density * m.longest())};
}

}  // namespace softkin::random_robots
