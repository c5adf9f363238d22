#include <algorithm>
#include <cmath>
#include <set>
#include <softkin/model/compile/parts.hpp>

namespace softkin {

namespace {

void hold(Compilation& c, const FixedSpec& spec, Index v, int axis) {
  const double place = c.model.rest(v, axis) + spec.displacement[axis];
  if (c.model.used[v] && c.model.fixed[v][axis] && c.model.held(v, axis) != place)
    throw InvalidInput(spec.where.origin, label(spec.where) + " holds vertex " + std::to_string(v) +
                                              " (from 0) along " + "xyz"[axis] + " elsewhere than an earlier entry");
  c.model.fixed[v][axis] = true;
  c.model.held(v, axis) = place;
}

void fix(Compilation& c, const FixedSpec& spec) {
  if (std::none_of(spec.axes.begin(), spec.axes.end(), [](bool axis) { return axis; }))
    throw InvalidInput(spec.where.origin, label(spec.where) + " is fixed along no axis");
  const Region region = c.regions.resolve(spec.where);
  const bool any = std::any_of(region.vertices.begin(), region.vertices.end(),
                               [&](Index v) { return static_cast<bool>(c.model.used[v]); });
  if (!any)
    throw InvalidInput(spec.where.origin, label(spec.where) + " cannot be fixed: it holds no vertex of the body");
  for (int axis = 0; axis < 3; ++axis) {
    if (!spec.axes[axis] && spec.displacement[axis] != 0)
      throw InvalidInput(spec.where.origin,
                         label(spec.where) + " is displaced along " + "xyz"[axis] + " but not held along it");
    if (!spec.axes[axis]) continue;
    for (const Index v : region.vertices) hold(c, spec, v, axis);
  }
}

std::string rigid_label(const RigidSpec& spec) {
  return spec.name.empty() ? label(spec.where) : "rigid region '" + spec.name + "'";
}

RigidRegion rigid_region(const Compilation& c, const RigidSpec& spec) {
  RigidRegion rigid;
  rigid.name = spec.name;
  for (const Index v : c.regions.resolve(spec.where).vertices)
    if (c.model.used[v]) rigid.vertices.push_back(v);
  if (!span_plane(c.model.rest, rigid.vertices))
    throw InvalidInput(spec.where.origin, rigid_label(spec) +
                                              " needs three vertices that are not on one line; it holds " +
                                              count_text(rigid.vertices.size(), "vertex", "vertices"));
  return rigid;
}

// A rigid region moves as one, so it can be held along an axis as a whole or not at all.
void check_held(const Compilation& c, const RigidSpec& spec, const RigidRegion& rigid) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Index> held;
    for (const Index v : rigid.vertices)
      if (c.model.fixed[v][axis]) held.push_back(v);
    const auto moved = [&](Index v) { return c.model.held(v, axis) - c.model.rest(v, axis); };
    for (const Index v : held)
      if (std::abs(moved(v) - moved(held.front())) > 1e-12 * c.model.diagonal_mm)
        throw InvalidInput(spec.where.origin,
                           rigid_label(spec) + " is held along " + "xyz"[axis] + " with different displacements");
    if (!held.empty() && !span_plane(c.model.rest, held))
      throw InvalidInput(spec.where.origin,
                         rigid_label(spec) + " is held along " + "xyz"[axis] +
                             " at fewer than three non-collinear vertices: hold a face of it or none");
  }
}

}  // namespace

void compile_supports(Compilation& c) {
  for (const FixedSpec& spec : c.spec.fixed) fix(c, spec);
  std::vector<Index> owner(c.model.used.size(), -1);
  std::set<std::string> names;
  for (const RigidSpec& spec : c.spec.rigid) {
    if (!spec.name.empty() && !names.insert(spec.name).second)
      throw InvalidInput(spec.where.origin, "there are two rigid regions '" + spec.name + "'");
    RigidRegion rigid = rigid_region(c, spec);
    for (const Index v : rigid.vertices) {
      if (owner[v] >= 0)
        throw InvalidInput(spec.where.origin, rigid_label(spec) + " and " + rigid_label(c.spec.rigid[owner[v]]) +
                                                  " share vertex " + std::to_string(v) +
                                                  " (from 0): make them one, or keep them apart");
      owner[v] = static_cast<Index>(c.model.rigid.size());
    }
    check_held(c, spec, rigid);
    c.model.rigid.push_back(std::move(rigid));
  }
}

}  // namespace softkin
