#include <algorithm>
#include <cmath>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/compile/samples.hpp>
#include <softkin/model/magnetic_field.hpp>

namespace softkin {

namespace {

// [mT]; the strongest magnets that there are have 1,500, and what has less than the other was given in tesla
constexpr double max_remanence = 2000, min_remanence = 1;
constexpr Index max_points = 1000;  // splines through so many take a second
constexpr double ungiven = 1e-9;    // of a grid's step, rounding

Vec3 unit(const ActuatorSpec& spec, const Vec3& vector, const std::string& what) {
  if (!vector.allFinite() || !(vector.norm() > 0))
    refuse(spec, "needs " + what + " that is finite and not 0, not " + point_text(vector));
  return vector.stableNormalized();
}

/// Refuses a command that is none of the source's.
void check_command(const ActuatorSpec& spec, FieldCommand command, const char* kind, FieldCommand first,
                   FieldCommand last) {
  if (command < first || command > last) refuse(spec, std::string("commands what ") + kind + " does not have");
}

struct CheckedField {
  const ActuatorSpec& spec;
  FieldCommand command;

  void operator()(UniformField& field) const {
    check_command(spec, command, "a uniform field", FieldCommand::flux_density, FieldCommand::flux_density_z);
    field.direction = unit(spec, field.direction, "a direction");
  }
  void operator()(CoilField& field) const {
    check_command(spec, command, "a coil", FieldCommand::current, FieldCommand::current);
    if (field.loops.empty()) refuse(spec, "needs at least one loop of wire");
    for (CoilLoop& loop : field.loops) {
      if (!loop.center.allFinite()) refuse(spec, "has a loop whose center is not finite");
      loop.axis = unit(spec, loop.axis, "an axis");
      if (!(loop.radius_mm > 0) || !std::isfinite(loop.radius_mm))
        refuse(spec, "needs a radius above 0 mm, not " + number(loop.radius_mm));
      if (loop.turns == 0 || !std::isfinite(loop.turns))
        refuse(spec, "needs turns that are finite and not 0, not " + number(loop.turns));
    }
  }
  void operator()(GridField& field) const {
    check_command(spec, command, "the field of a grid", FieldCommand::current, FieldCommand::current);
    std::size_t points = 1;
    for (int axis = 0; axis < 3; ++axis) {
      if (field.counts[axis] < 4 || !(field.step[axis] > 0) || !std::isfinite(field.step[axis]))
        refuse(spec, "needs a grid of at least 4 points along every axis, that ascend");
      if (field.counts[axis] > max_points)
        refuse(spec, "needs a grid of at most " + std::to_string(max_points) + " points along an axis, not " +
                         std::to_string(field.counts[axis]));
      points *= field.counts[axis];
    }
    if (points != field.per_ampere.size()) refuse(spec, "needs a flux density at every point of its grid");
    for (const Vec3& value : field.per_ampere)
      if (!value.allFinite()) refuse(spec, "has a flux density in its grid that is not finite");
  }
  void operator()(DipoleField& field) const {
    check_command(spec, command, "a dipole", FieldCommand::position_x, FieldCommand::moment_z);
    if (!field.position.allFinite() || !field.moment.allFinite())
      refuse(spec, "needs a dipole whose position and moment are finite");
  }
};

/// Its place among the model's sources.
Index place_of(Magnetism& magnetism, std::vector<const FieldSource*>& known, const ActuatorSpec& spec,
               const FieldSpec& commanded) {
  const FieldSource* source = commanded.source.get();
  const auto found = std::find(known.begin(), known.end(), source);
  const Index place = found - known.begin();
  FieldSource checked = *source;
  std::visit(CheckedField{spec, commanded.command}, checked.field);
  if (found == known.end()) {
    known.push_back(source);
    magnetism.sources.push_back(std::move(checked));
  }
  return place;
}

/// Finds the samples of a material's remanence.
class Remanence {
 public:
  explicit Remanence(const MaterialSpec& material)
      : owner_("the material of region '" + material.region + "': its remanence"),
        origin_(material.origin),
        spec_(*material.remanence),
        samples_(spec_.places, spec_.samples, spec_.file, owner_, origin_) {
    if (!spec_.uniform.allFinite()) throw InvalidInput(origin_, owner_ + " is not finite");
  }

  [[nodiscard]] Vec3 of(const Model& model, std::size_t element) const {
    return samples_.empty() ? spec_.uniform : samples_.of(model, element);
  }

 private:
  std::string owner_;
  Origin origin_;
  const RemanenceSpec& spec_;
  ElementSamples samples_;
};

/// Returns whether any element has a remanence.
bool magnetise(const Compilation& c, Magnetism& magnetism) {
  const Model& model = c.model;
  std::vector<std::optional<Remanence>> of_material(c.spec.materials.size());
  for (std::size_t m = 0; m < of_material.size(); ++m)
    if (c.spec.materials[m].remanence) of_material[m].emplace(c.spec.materials[m]);
  bool any = false;
  const auto add = [&](const std::vector<ElementRole>& roles) {
    for (const ElementRole& role : roles) {
      const auto& remanence = of_material[role.material];
      magnetism.remanence.push_back(remanence ? remanence->of(model, magnetism.remanence.size()) : Vec3(0, 0, 0));
      const RemanenceSpec* spec = c.spec.materials[role.material].remanence.get();
      magnetism.magnetisation.push_back(spec ? spec->magnetisation : Magnetisation::turns);
      any = any || !magnetism.remanence.back().isZero(0);
    }
  };
  add(model.elements.tetrahedron_roles);
  add(model.elements.prism_roles);
  return any;
}

/// Refuses a grid that does not contain all magnetic elements.
void check_grid(const Compilation& c, const Magnetism& magnetism, const FieldSource& source, const Origin& origin) {
  const auto* grid = std::get_if<GridField>(&source.field);
  if (grid == nullptr) return;
  const Vec3 margin = ungiven * grid->step, low = grid->low - margin, high = grid->high() + margin;
  const auto check = [&](const auto& nodes) {
    for (const Index v : nodes) {
      const Vec3 at = vertex_at(c.model.rest, v);
      if ((at - low).minCoeff() < 0 || (high - at).minCoeff() < 0)
        throw InvalidInput(origin, "actuator '" + source.name + "': the grid of " + grid->file + ", " +
                                       point_text(grid->low) + " to " + point_text(grid->high()) +
                                       " mm, does not reach the magnetic material at " + point_text(at) + " mm");
    }
  };
  for (std::size_t e = 0; e < magnetism.remanence.size(); ++e) {
    if (magnetism.remanence[e].isZero(0)) continue;
    const std::size_t tetrahedra = c.model.elements.tetrahedra.size();
    if (e < tetrahedra)
      check(c.model.elements.tetrahedra[e]);
    else
      check(c.model.elements.prisms[e - tetrahedra]);
  }
}

void doubt_remanence(Model& model, const Magnetism& magnetism) {
  double most = 0;
  for (const Vec3& remanence : magnetism.remanence) most = std::max(most, remanence.norm());
  if (most > max_remanence || (most > 0 && most < min_remanence))
    model.warnings.push_back("The remanence is up to " + number(most, 4) +
                             " mT; magnets have up to 1,500 mT: is it in mT?");
}

}  // namespace

void compile_magnetism(Compilation& c) {
  const bool remanent = std::any_of(c.spec.materials.begin(), c.spec.materials.end(),
                                    [](const MaterialSpec& material) { return material.remanence != nullptr; });
  if (c.spec.formulation != Formulation::physical) {
    if (remanent) c.model.notes.emplace_back("Remanence is left out: the target-shape formulation knows no forces.");
    return;
  }
  auto magnetism = std::make_shared<Magnetism>();
  const bool any = remanent && magnetise(c, *magnetism);
  std::vector<const FieldSource*> known;
  for (std::size_t a = 0; a < c.spec.actuators.size(); ++a) {
    const ActuatorSpec& spec = c.spec.actuators[a];
    const auto* field = spec.as<FieldSpec>();
    if (field == nullptr) continue;
    if (!any) refuse(spec, "is a magnetic field that acts on nothing: give a material a remanence");
    const MagneticDrive drive{place_of(*magnetism, known, spec, *field), field->command};
    for (std::size_t b = 0; b < a; ++b)
      if (const auto* other = c.model.actuators[b].as<MagneticDrive>();
          other && other->source == drive.source && other->command == drive.command)
        refuse(spec, "commands the same as actuator '" + c.model.actuators[b].name + "'");
    c.model.actuators[a].drive = drive;
    check_grid(c, *magnetism, magnetism->sources[drive.source], spec.origin);
  }
  if (!any) return;
  doubt_remanence(c.model, *magnetism);
  if (known.empty())
    c.model.notes.emplace_back("There is remanence but no magnetic field, so that nothing comes of it.");
  else
    c.model.magnetism = std::move(magnetism);
}

}  // namespace softkin
