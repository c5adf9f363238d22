#include <Eigen/Geometry>
#include <softkin/model/mesh/mesh_order.hpp>

#include "random/parts.hpp"

namespace softkin::random_robots {

using namespace testing;

namespace {

/// Cells of several kinds: prisms below, tetrahedra above.
Mesh layered_block(const std::array<int, 3>& cells, const Vec3& size, Split above) {
  Mesh mesh = testing::layered_mesh(cells, size, above);
  add_volume_region(mesh, "body", [](const Vec3&) { return true; });
  add_face_regions(mesh, size);
  return mesh;
}

/// Regions by place; one that would be empty is left out.
template <class Inside>
bool add_part(Mesh& mesh, const std::string& name, const Inside& inside) {
  add_volume_region(mesh, name, inside);
  if (!mesh.regions.back().tetrahedra.empty() || !mesh.regions.back().prisms.empty()) return true;
  mesh.regions.pop_back();
  return false;
}

void add_regions(Making& m, bool closed) {
  const Vec3 cell(m.size[0] / m.cells[0], m.size[1] / m.cells[1], m.size[2] / m.cells[2]);
  if (m.has_chamber) {
    // closed: the cells inside; open: up to a face of the block
    const Vec3 high = closed ? Vec3(m.size - cell) : Vec3(m.size[0], m.size[1] - cell[1], m.size[2] - cell[2]);
    m.has_chamber = add_part(m.mesh(), "chamber", [&](const Vec3& p) {
      return (p.array() > cell.array()).all() && (p.array() < high.array()).all();
    });
  }
  if (m.has_layer) {
    const double from = m.draw.chance(0.5) ? 0 : cell[0];
    m.has_layer = add_part(m.mesh(), "layer", [&](const Vec3& p) { return p.z() < cell[2] && p.x() > from; });
    if (m.has_layer) m.mesh().regions.back().tetrahedra.clear();
  }
  for (int i = 0; i < 2; ++i) {
    const Vec3 normal = m.draw.offset(), point = m.size.cwiseProduct(0.5 * (Vec3::Ones() + 0.6 * m.draw.offset()));
    (void)add_part(m.mesh(), "part" + std::to_string(i), [&](const Vec3& p) { return (p - point).dot(normal) > 0; });
  }
}

void jitter(Making& m, double fraction) {
  Points& points = m.mesh().vertices;
  const Vec3 cell(m.size[0] / m.cells[0], m.size[1] / m.cells[1], m.size[2] / m.cells[2]);
  for (Index v = 0; v < points.rows(); ++v) points.row(v) += fraction * m.draw.offset().cwiseProduct(cell).transpose();
}

}  // namespace

void make_mesh(Making& m) {
  const int kind = m.draw.below(10);
  Split split = m.draw.chance(0.5) ? Split::six : Split::five;
  bool layered = false;
  if (kind < 3) {  // with a chamber
    m.has_chamber = true;
    m.cells = {m.draw.whole(3, 5), 3, 3};
  } else if (kind < 5) {  // with a layer of prisms
    m.has_layer = true;
    layered = m.draw.chance(0.5);
    split = layered ? Split::six : Split::prisms;
    m.cells = {m.draw.whole(2, 6), m.draw.whole(1, 3), m.draw.whole(1, 3)};
  } else {
    m.cells = {m.draw.whole(1, 8), m.draw.whole(1, 2), m.draw.whole(1, 2)};
  }
  for (int axis = 0; axis < 3; ++axis) m.size[axis] = m.cells[axis] * m.draw.between(0.6, 1.6);
  if (m.draw.chance(0.15)) m.size[2] *= m.draw.log_between(0.05, 1);  // thin
  m.mesh() = layered ? layered_block(m.cells, m.size, split) : block_mesh(m.cells, m.size, split);
  add_regions(m, m.draw.chance(0.85));
  if (m.draw.chance(0.6)) jitter(m, m.draw.between(0, 0.12));
  const std::size_t tetrahedra = m.mesh().tetrahedra.size();
  m.made.spec.mesh_options.quadratic =
      m.physical && m.mesh().prisms.empty() && tetrahedra <= 130 && m.draw.chance(0.35);
}

namespace {

Index random_vertex(Making& m) {
  return m.draw.below(static_cast<int>(m.mesh().vertices.rows()));
}

Index add_vertex(Mesh& mesh, const Vec3& place) {
  mesh.vertices.conservativeResize(mesh.vertices.rows() + 1, 3);
  mesh.vertices.row(mesh.vertices.rows() - 1) = place.transpose();
  return static_cast<Index>(mesh.vertices.rows()) - 1;
}

/// Moves a vertex of an element towards the plane of the others, up to a fraction of its height.
void flatten(Making& m) {
  if (m.mesh().tetrahedra.empty()) return;
  const Tetrahedron t = m.mesh().tetrahedra[m.draw.below(static_cast<int>(m.mesh().tetrahedra.size()))];
  Points& p = m.mesh().vertices;
  const Vec3 a = p.row(t[0]), b = p.row(t[1]), c = p.row(t[2]), top = p.row(t[3]);
  const Vec3 normal = (b - a).cross(c - a).normalized();
  if (!normal.allFinite()) return;
  const double keep = std::pow(10, -m.draw.between(1, 14));
  p.row(t[3]) = (top - (1 - keep) * (top - a).dot(normal) * normal).transpose();
}

void repeat_elements(Making& m) {
  Mesh& mesh = m.mesh();
  for (int i = m.draw.whole(1, 3); i > 0; --i) {
    if (!mesh.tetrahedra.empty())
      mesh.tetrahedra.push_back(mesh.tetrahedra[m.draw.below(static_cast<int>(mesh.tetrahedra.size()))]);
    else
      mesh.prisms.push_back(mesh.prisms[m.draw.below(static_cast<int>(mesh.prisms.size()))]);
  }
}

/// Gives every other element of some vertices a vertex of its own in the same place.
void crack(Making& m) {
  for (int i = m.draw.whole(1, 4); i > 0; --i) {
    const Index v = random_vertex(m), twin = add_vertex(m.mesh(), vertex_at(m.mesh().vertices, v));
    const auto part = [&](auto& elements) {
      for (auto& element : elements)
        for (Index& corner : element)
          if (corner == v && m.draw.chance(0.5)) corner = twin;
    };
    part(m.mesh().tetrahedra);
    part(m.mesh().prisms);
  }
}

void add_block(Making& m, const Vec3& place, const Vec3& size, bool joined) {
  const Mesh block = block_mesh({1, 1, 1}, size, m.mesh().tetrahedra.empty() ? Split::prisms : Split::five);
  std::vector<Index> vertex_of;
  for (Index v = 0; v < block.vertices.rows(); ++v)
    vertex_of.push_back(joined && v == 0 ? random_vertex(m)
                                         : add_vertex(m.mesh(), place + vertex_at(block.vertices, v)));
  const auto append = [&](const auto& from, auto& to) {
    for (auto element : from) {
      for (Index& v : element) v = vertex_of[v];
      to.push_back(element);
    }
  };
  append(block.tetrahedra, m.mesh().tetrahedra);
  append(block.prisms, m.mesh().prisms);
}

void spoil_cells(Making& m) {
  Mesh& mesh = m.mesh();
  const Index bad = m.draw.pick<Index>({-1, static_cast<Index>(mesh.vertices.rows()), 1 << 30, 0});
  if (!mesh.tetrahedra.empty())
    mesh.tetrahedra[m.draw.below(static_cast<int>(mesh.tetrahedra.size()))][m.draw.below(4)] = bad;
  else
    mesh.prisms[m.draw.below(static_cast<int>(mesh.prisms.size()))][m.draw.below(6)] = bad;
}

void bend_edges(Making& m) {
  Mesh& mesh = m.mesh();
  if (!m.made.spec.mesh_options.quadratic || m.is(Oddity::bad_cells)) return;
  const Index corners = mesh.vertices.rows();
  mesh = elevated(mesh);
  m.made.spec.mesh_options.quadratic = m.draw.chance(0.5);
  const double fraction = m.draw.pick({0.02, 0.05, 0.2});
  for (Index v = corners; v < mesh.vertices.rows(); ++v) mesh.vertices.row(v) += fraction * m.draw.offset().transpose();
}

}  // namespace

void spoil_mesh(Making& m) {
  if (m.is(Oddity::inverted)) jitter(m, m.draw.between(0.3, 0.9));
  if (m.is(Oddity::sliver))
    for (int i = m.draw.whole(1, 3); i > 0; --i) flatten(m);
  if (m.is(Oddity::repeated)) repeat_elements(m);
  if (m.is(Oddity::cracked)) crack(m);
  if (m.is(Oddity::overlapping)) {
    const double fraction = m.draw.between(0.3, 1);
    add_block(m, m.size.cwiseProduct(0.3 * (Vec3::Ones() + m.draw.offset())), fraction * m.size, false);
  }
  if (m.is(Oddity::loose)) {
    const bool joined = m.draw.chance(0.5);
    add_block(m, (Vec3::Ones() + 0.1 * m.draw.offset()).cwiseProduct(m.size), {1, 1, 1}, joined);
  }
  if (m.is(Oddity::isolated))
    for (int i = m.draw.whole(1, 4); i > 0; --i) {
      const Vec3 offset = m.draw.offset();
      (void)add_vertex(m.mesh(), m.draw.pick({1.0, 10.0, 1e6}) * m.size.cwiseProduct(offset));
    }
  if (m.is(Oddity::bad_cells)) spoil_cells(m);
  if (m.is(Oddity::curved)) bend_edges(m);
}

void scale_robot(Making& m) {
  double scale = m.draw.log_between(0.1, 1e4) / m.longest();
  Vec3 place = Vec3::Zero();
  if (m.draw.chance(0.3)) {
    place = m.draw.offset();
    place *= m.draw.between(0, 3) * scale * m.longest();
  }
  if (m.is(Oddity::far_away)) {
    if (m.draw.chance(0.5)) scale *= m.draw.pick({1e-6, 1e-3, 1e3, 1e6});
    if (m.draw.chance(0.7)) {
      const Vec3 offset = m.draw.offset();
      place = m.draw.log_between(1e2, 1e9) * scale * offset;
    }
  }
  const auto moved = [&](const Vec3& p) { return Vec3(scale * p + place); };
  RobotSpec& spec = m.made.spec;
  for (Index v = 0; v < m.mesh().vertices.rows(); ++v)
    m.mesh().vertices.row(v) = moved(vertex_at(m.mesh().vertices, v)).transpose();
  for (ActuatorSpec& actuator : spec.actuators) {
    if (auto* cable = actuator.as<CableSpec>())
      for (PointRef& point : cable->points)
        if (auto* at = std::get_if<Vec3>(&point.point)) *at = moved(*at);
    if (auto* chamber = actuator.as<PneumaticSpec>(); chamber && chamber->surface)
      for (Index v = 0; v < chamber->surface->vertices.rows(); ++v)
        chamber->surface->vertices.row(v) = moved(vertex_at(chamber->surface->vertices, v)).transpose();
  }
  const auto move_box = [&](RegionRef& where) {
    if (auto* selector = std::get_if<Selector>(&where.region))
      if (auto* box = std::get_if<Box>(selector)) *box = {moved(box->low), moved(box->high)};
  };
  for (FixedSpec& fixed : spec.fixed) {
    move_box(fixed.where);
    fixed.displacement *= scale;
  }
  for (RigidSpec& rigid : spec.rigid) move_box(rigid.where);
  for (RegionRef& where : spec.voids) move_box(where);
  m.size *= scale;
}

}  // namespace softkin::random_robots
