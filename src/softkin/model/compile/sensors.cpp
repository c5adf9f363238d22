#include <set>
#include <softkin/model/compile/parts.hpp>
#include <softkin/model/sensor.hpp>

namespace softkin {

namespace {

[[noreturn]] void refuse_sensor(const SensorSpec& spec, const std::string& what) {
  throw InvalidInput(spec.origin, "sensor '" + spec.name + "' " + what);
}

TurningSection section_of(Compilation& c, const SensorSpec& spec, const std::string& region) {
  const EmbeddedPoint mean = embed_point(c, {region, spec.origin}, "sensor '" + spec.name + "'");
  if (!span_plane(c.model.rest, mean.vertices))
    refuse_sensor(spec,
                  "has the section '" + region + "', whose vertices are on a line: its rotation is not determined");
  const Vec3 middle = mean.at(c.model.rest);
  std::vector<Vec3> arms;
  for (const Index v : mean.vertices) arms.push_back(vertex_at(c.model.rest, v) - middle);
  TurningSection section;
  for (int axis = 0; axis < 3; ++axis) section.along[axis] = {spec.name, mean, Vec3::Unit(axis), arms};
  return section;
}

Sensor sensor_of(Compilation& c, const SensorSpec& spec) {
  Sensor sensor{.name = spec.name, .kind = spec.kind, .places = {}};
  if (spec.kind == SensorKind::length) {
    sensor.places = places_along(c, spec.name, spec.points, spec.robot, spec.origin);
    return sensor;
  }
  if (!spec.axis.allFinite() || !(spec.axis.stableNorm() > 0)) refuse_sensor(spec, "has an axis without direction");
  sensor.axis = spec.axis.stableNormalized();
  const bool angle = spec.kind == SensorKind::angle;
  if (angle && spec.sections[0] == spec.sections[1]) refuse_sensor(spec, "is between a section and itself");
  for (std::size_t i = 0; i < (angle ? 2 : 1); ++i) sensor.sections[i] = section_of(c, spec, spec.sections[i]);
  return sensor;
}

}  // namespace

void compile_sensors(Compilation& c) {
  std::set<std::string> names;
  for (const auto& spec : c.spec.sensors) {
    if (spec->name.empty()) refuse_sensor(*spec, "needs a name");
    if (!names.insert(spec->name).second)
      throw InvalidInput(spec->origin, "there are two sensors '" + spec->name + "'");
    c.model.sensors.push_back(std::make_shared<const Sensor>(sensor_of(c, *spec)));
  }
}

}  // namespace softkin
