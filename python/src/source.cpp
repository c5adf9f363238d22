#include "source.hpp"

#include "archive.hpp"

namespace softkin::python {

template <>
CurveBranch blank() {
  return {MonotoneCurve({0, 1}, {0, 1}), {}};
}
template <>
ActuatorCurve blank() {
  return {{}, {}, {}, {}, blank<CurveBranch>(), {}};
}

// Found by the archive's namespace, so in no unnamed one.

template <class A>
void members(A& archive, Region& r) {
  archive(r.name, r.dimension, r.tetrahedra, r.prisms, r.triangles, r.quads, r.vertices);
}
template <class A>
void members(A& archive, Mesh& m) {
  archive(m.vertices, m.tetrahedra, m.edge_nodes, m.prisms, m.triangles, m.quads, m.regions);
}
template <class A>
void members(A& archive, TriangleSurface& s) {
  archive(s.vertices, s.triangles);
}
template <class A>
void members(A& archive, Sidecar& s) {
  archive(s.rows, s.columns, s.bare);
}
template <class A>
void members(A& archive, CurveBranch& b) {
  std::vector<double> x = b.ratio.x(), y = b.ratio.y();
  archive(x, y, b.spread);
  if constexpr (std::is_same_v<A, Reader>) b.ratio = MonotoneCurve(std::move(x), std::move(y));
}
template <class A>
void members(A& archive, ActuatorCurve& c) {
  archive(c.file, c.end, c.input, c.atmosphere_kPa, c.loading, c.unloading);
}
template <class A>
void members(A& archive, FieldSamples& s) {
  archive(s.file, s.places, s.values, s.in_mm, s.lines);
}
template <class A>
void members(A& archive, Origin& o) {
  std::uint64_t line = o.line, byte = o.byte;
  archive(o.file, line, byte, o.binary);
  o.line = line;
  o.byte = byte;
}
template <class A>
void members(A& archive, scene::Node::Entry& e) {
  archive(e.key, e.origin, e.value);
}
template <class A>
void members(A& archive, scene::Node& n) {
  archive(n.kind, n.origin, n.name, n.text, n.plain, n.items, n.entries);
}
template <class A>
void members(A& archive, FileContents& f) {
  archive(f.meshes, f.surfaces, f.sidecars, f.curves, f.scenes, f.samples, f.routes, f.directions);
}
template <class A>
void members(A& archive, Source& s) {
  archive(s.name, s.tree, s.formulation, s.forces, s.files);
}

RobotSpec Source::spec(bool read) {
  RobotSpec result = parse_scene(*tree, name, files.kept(read));
  RequestedScene requested;
  requested.formulation = formulation;
  requested.forces = forces;
  change(result, requested, "forces");
  return result;
}

std::string pickled(const Source& source) {
  Writer writer;
  writer(source);
  return writer.bytes();
}

Source unpickled(std::string_view bytes) {
  Source source;
  Reader reader(bytes);
  reader(source);
  reader.finish();
  return source;
}

}  // namespace softkin::python
