#include "source.hpp"

#include <softkin/io/file.hpp>

#include "archive.hpp"

namespace softkin::python {

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
void members(A& archive, CurveData::Line& l) {
  archive(l.x, l.y, l.spread);
}
template <class A>
void members(A& archive, CurveData& c) {
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
void members(A& archive, Source& s) {
  archive(s.name, s.tree, s.formulation, s.forces, s.meshes, s.surfaces, s.sidecars, s.curves, s.scenes, s.samples);
}

namespace {

CurveData::Line data_of(const CurveBranch& branch) {
  return {branch.ratio.x(), branch.ratio.y(), branch.spread};
}

CurveData data_of(const ActuatorCurve& curve) {
  CurveData data{curve.file, curve.end, curve.input, curve.atmosphere_kPa, data_of(curve.loading), {}};
  if (curve.unloading) data.unloading = data_of(*curve.unloading);
  return data;
}

CurveBranch branch_of(const CurveData::Line& line) {
  return {MonotoneCurve(line.x, line.y), line.spread};
}

ActuatorCurve curve_of(const CurveData& data) {
  ActuatorCurve curve{data.file, data.input, data.atmosphere_kPa, data.end, branch_of(data.loading), {}};
  if (data.unloading) curve.unloading = branch_of(*data.unloading);
  return curve;
}

/// What is known of a file, or reads it and keeps it.
template <class Data, class Read>
const Data& kept(std::map<std::string, Data>& known, const std::filesystem::path& path, bool read, const Read& reader) {
  const auto found = known.find(path.string());
  if (found != known.end()) return found->second;
  if (!read) throw InvalidInput({path.string()}, "the robot was made without this file");
  return known.emplace(path.string(), reader(path)).first->second;
}

}  // namespace

RobotSpec Source::spec(bool read) {
  using Path = std::filesystem::path;
  const auto mesh = [&](const Path& path) { return kept(meshes, path, read, read_mesh); };
  const auto surface = [&](const Path& path) { return kept(surfaces, path, read, read_stl); };
  const auto sidecar = [&](const Path& path) { return kept(sidecars, path, read, read_sidecar); };
  const auto curve = [&](const Path& path) {
    return curve_of(kept(curves, path, read, [](const Path& file) { return data_of(read_actuator_curve(file)); }));
  };
  const auto scene = [&](const Path& path) { return kept(scenes, path, read, read_file); };
  const auto sampled = [&](const Path& path) { return kept(samples, path, read, read_field_samples); };
  RobotSpec result = parse_scene(*tree, name, {mesh, surface, sidecar, curve, scene, sampled});
  AskedScene asked;
  asked.formulation = formulation;
  asked.forces = forces;
  change(result, asked, "forces");
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
