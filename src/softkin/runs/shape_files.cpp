#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <softkin/runs/body_surface.hpp>
#include <softkin/runs/obstacle_picture.hpp>
#include <softkin/runs/shape_files.hpp>
#include <utility>

#include <softkin/core/error.hpp>
#include <softkin/io/mesh/vtk.hpp>
#include <softkin/io/picture/picture.hpp>
#include <softkin/model/layer.hpp>
#include <softkin/model/names.hpp>

namespace softkin::runs {

namespace fs = std::filesystem;

namespace {

std::vector<ElementRole> all_roles(const Model& model) {
  std::vector<ElementRole> roles = model.elements.tetrahedron_roles;
  roles.insert(roles.end(), model.elements.prism_roles.begin(), model.elements.prism_roles.end());
  return roles;
}

constexpr std::array<double, 3> cable_color{0.80, 0.33, 0.10}, marker_color{0.13, 0.13, 0.15},
    target_color{0.80, 0.10, 0.35};

/// A line to where a goal wants its marker, with a cross at its end; nothing of a direction.
void add_target(const Goal& goal, const Model& model, const Points& positions, std::vector<PictureMark>& marks) {
  Vec3 from, to;
  if (const auto* at = std::get_if<PositionGoal>(&goal.what)) {
    from = to = model.markers[at->marker].at(positions);
    for (int axis = 0; axis < 3; ++axis)
      if (at->axes[axis]) to[axis] = at->target[axis];
  } else if (const auto* plane = std::get_if<PlaneGoal>(&goal.what)) {
    const Vec3 normal = plane->normal.stableNormalized();
    from = model.markers[plane->marker].at(positions);
    to = from - normal.dot(from - plane->point) * normal;
  } else {
    return;
  }
  Points line(2, 3);
  line << from.transpose(), to.transpose();
  marks.push_back({line, "", target_color});
  marks.push_back({to.transpose(), "", target_color, PictureMark::Sign::cross});
}

std::vector<PictureMark> marks_of(const Model& model, const Points& positions, const std::vector<Goal>& goals) {
  std::vector<PictureMark> marks;
  for (const Actuator& actuator : model.actuators) {
    const auto* cable = actuator.as<CableDrive>();
    if (!cable) continue;
    Points line(cable->points.size(), 3);
    for (Index i = 0; i < line.rows(); ++i) line.row(i) = cable->points[i].at(positions).transpose();
    marks.push_back({line, "", cable_color});
  }
  for (const Goal& goal : goals) add_target(goal, model, positions, marks);
  for (const Marker& marker : model.markers)
    marks.push_back({marker.at(positions).transpose(), marker.name, marker_color});
  return marks;
}

/// Adds the stresses of the cells; to the points, the reactions and the supports that exert them.
void add_forces(const Model& model, const ElementDeformation& deformation, VtuContent& content) {
  const ElementStress& stress = deformation.stress;
  if (stress.von_mises.empty()) return;
  Field principal{"principal_stress_MPa", 3, {}}, support{"support", 1, {}};
  for (const auto& values : stress.principal)
    principal.values.insert(principal.values.end(), values.begin(), values.end());
  for (const auto& axes : model.held.support_of) support.values.push_back(*std::max_element(axes.begin(), axes.end()));
  const Points& forces = deformation.reactions;
  content.cell_fields.push_back({"von_mises_MPa", 1, stress.von_mises});
  content.cell_fields.push_back(std::move(principal));
  content.point_fields.push_back({"reaction_N", 3, {forces.data(), forces.data() + forces.size()}});
  content.point_fields.push_back(std::move(support));
  if (deformation.contacts)
    content.point_fields.push_back({"contact_pressure_kPa", 1, deformation.contacts->pressure_kPa});
  if (deformation.contacts && !deformation.contacts->slip_mm.empty())
    content.point_fields.push_back({"slip_mm", 1, deformation.contacts->slip_mm});
  for (std::size_t s = 0; s < model.held.supports.size(); ++s)
    content.constants.emplace_back("support_" + model.held.supports[s].name, static_cast<double>(s));
  for (std::size_t a = 0; a < model.actuators.size(); ++a)
    if (const std::string key = multiplier_key(model.actuators[a]); !key.empty())
      content.constants.emplace_back(key + "_" + model.actuators[a].name, deformation.multipliers[a]);
}

/// Adds the bodies and obstacles, each as a region, after all fields: whatever is known of elements is 0 in them.
/// Half-spaces stay without cells: their triangles would dwarf the robot.
void add_surroundings(const Model& model, VtuContent& content) {
  const ContactModel& contact = model.contact;
  std::vector<Index> regions(contact.parts.size(), -1);
  for (std::size_t p = 0; p < contact.parts.size(); ++p) {
    const ContactPart& part = contact.parts[p];
    if (part.rank == ContactRank::robot || part.halfspace) continue;
    regions[p] = content.region_names.size();
    content.region_names.push_back(part.name);
  }
  for (std::size_t t = 0; t < contact.triangles.size(); ++t) {
    const Index region = regions[contact.part_of[t]];
    if (region < 0) continue;
    content.triangles.push_back(contact.triangles[t]);
    content.cell_regions.push_back(region);
  }
  for (Field& field : content.cell_fields)
    field.values.resize(content.cell_regions.size() * static_cast<std::size_t>(field.components),
                        field.name == "actuator" ? -1 : 0);
}

/// Adds the faces of layers, each layer a region: whatever is known of elements is 0 in them.
void add_layers(const Model& model, VtuContent& content) {
  for (const auto& layer : model.reinforcement.layers) {
    if (layer->faces.empty()) continue;
    const Index region = content.region_names.size();
    content.region_names.push_back("layer_" + layer->name);
    for (const CavityFace& face : layer->faces) {
      content.triangles.push_back(face.corners);
      content.cell_regions.push_back(region);
    }
  }
}

// What read_state() reads.
constexpr const char *state_fraction = "state_share", *state_elapsed = "state_elapsed_s",
                     *state_anchors = "state_anchors", *state_history = "state_history",
                     *state_eyelets = "state_eyelets";
const std::string state_command = "state_command_", state_multiplier = "state_multiplier_";
constexpr int anchor_values = 7;
constexpr double same_mesh = 1e-9;  // of the diagonal

void add_state(const Model& model, const State& state, VtuContent& content) {
  const Index actuators = model.actuators.size();
  const bool known = state.knows(actuators) && state.multipliers.size() == actuators && state.actuation.allFinite() &&
                     state.multipliers.allFinite() && std::isfinite(state.load_factor);
  content.constants.emplace_back(state_fraction, known ? state.load_factor : -1);
  if (!known) return;
  for (Index a = 0; a < actuators; ++a) {
    const std::string& name = model.actuators[a].name;
    content.constants.emplace_back(state_command + name, state.actuation[a]);
    content.constants.emplace_back(state_multiplier + name, state.multipliers[a]);
  }
  if (std::isfinite(state.elapsed_s)) content.constants.emplace_back(state_elapsed, state.elapsed_s);
  if (state.history) content.arrays.push_back({state_history, 6, state.history->strains});
  if (!state.eyelets.empty()) content.arrays.push_back({state_eyelets, 1, state.eyelets});
  if (state.anchors.empty()) return;
  Field anchors{state_anchors, anchor_values, {}};
  for (const Anchor& anchor : state.anchors)
    anchors.values.insert(anchors.values.end(), {static_cast<double>(anchor.vertex), static_cast<double>(anchor.part),
                                                 static_cast<double>(anchor.triangle), anchor.weights[0],
                                                 anchor.weights[1], anchor.weights[2], anchor.slipped_mm});
  content.arrays.push_back(std::move(anchors));
}

}  // namespace

VtuContent shape_content(const Model& model, const State& state, const ElementDeformation& deformation,
                         bool converged) {
  VtuContent content;
  const Points& positions = state.positions;
  content.points = positions;
  content.tetrahedra = model.elements.tetrahedra;
  content.edge_nodes = model.elements.edge_nodes;
  content.prisms = model.elements.prisms;
  const Points moved = positions - model.rest;
  content.point_fields.push_back({"displacement_mm", 3, {moved.data(), moved.data() + moved.size()}});

  Field greatest{"principal_strain_max", 1, {}}, least{"principal_strain_min", 1, {}}, actuator{"actuator", 1, {}};
  for (const auto& strain : deformation.strain) {
    greatest.values.push_back(strain[0]);
    least.values.push_back(strain[2]);
  }
  for (const ElementRole& role : all_roles(model)) {
    content.cell_regions.push_back(role.region);
    actuator.values.push_back(role.actuator);
  }
  const Field mark{"converged", 1, std::vector<double>(deformation.strain.size(), converged ? 1 : 0)};
  content.cell_fields = {{"volume_ratio", 1, deformation.volume_ratio}, greatest, least, actuator, mark};
  content.region_names = model.elements.region_names;
  add_forces(model, deformation, content);
  add_layers(model, content);
  add_surroundings(model, content);
  add_state(model, state, content);
  return content;
}

void write_shape(const fs::path& path, const Model& model, const State& state, const ElementDeformation& deformation,
                 bool converged) {
  write_vtu(path, shape_content(model, state, deformation, converged));
}

State read_state(const fs::path& path, const Model& model) {
  State state;
  state.positions = read_vtu_points(path);
  if (state.positions.rows() != model.rest.rows())
    throw InvalidInput({path.string()}, "the shape has " + std::to_string(state.positions.rows()) +
                                            " vertices, the robot " + std::to_string(model.rest.rows()));
  const Points rest = state.positions - read_vtu_point_vectors(path, "displacement_mm");
  if (largest_move(rest, model.rest) > same_mesh * model.diagonal_mm)
    throw InvalidInput({path.string()}, "the shape is of another mesh: its vertices rest elsewhere");
  const std::map<std::string, std::vector<double>> arrays = read_vtu_arrays(path);
  const auto number_of = [&](const std::string& name) -> std::optional<double> {
    const auto found = arrays.find(name);
    return found != arrays.end() && found->second.size() == 1 ? std::optional(found->second[0]) : std::nullopt;
  };
  const std::optional<double> fraction = number_of(state_fraction);
  if (!fraction)
    throw InvalidInput({path.string()}, "it does not contain its load state: no array '" + std::string(state_fraction) +
                                            "', which softkin writes");
  state.load_factor = *fraction;
  if (state.load_factor < 0) return state;
  const Index actuators = model.actuators.size();
  state.actuation = state.multipliers = Eigen::VectorXd::Zero(actuators);
  for (Index a = 0; a < actuators; ++a) {
    const std::string& name = model.actuators[a].name;
    const std::optional<double> command = number_of(state_command + name),
                                multiplier = number_of(state_multiplier + name);
    if (!command || !multiplier) throw InvalidInput({path.string()}, "it has no actuator '" + name + "'");
    state.actuation[a] = *command;
    state.multipliers[a] = *multiplier;
  }
  state.elapsed_s = number_of(state_elapsed).value_or(state.elapsed_s);
  if (const auto history = arrays.find(state_history); history != arrays.end())
    state.history = std::make_shared<const ViscousHistory>(ViscousHistory{history->second});
  if (const auto eyelets = arrays.find(state_eyelets); eyelets != arrays.end()) state.eyelets = eyelets->second;
  if (const auto anchors = arrays.find(state_anchors); anchors != arrays.end())
    for (std::size_t i = 0; i + anchor_values <= anchors->second.size(); i += anchor_values) {
      const double* v = &anchors->second[i];
      state.anchors.push_back(
          {static_cast<Index>(v[0]), static_cast<Index>(v[1]), static_cast<Index>(v[2]), Vec3(v[3], v[4], v[5]), v[6]});
    }
  return state;
}

namespace {

struct Image {
  std::vector<PictureLayer> layers;
  PictureOptions options;
  std::vector<PictureMark> marks;
};

Image image_of(const Model& model, const Points& positions, const std::vector<double>& view, const std::string& title,
               const std::vector<Goal>& goals) {
  const std::vector<Triangle> surface = body_surface(model).triangles;
  PictureLayer shape, ghost;
  shape.points = positions;
  shape.triangles = surface;
  const Eigen::VectorXd moved = (positions - model.rest).rowwise().norm();
  shape.values.assign(moved.data(), moved.data() + moved.size());
  ghost.points = model.rest;
  ghost.triangles = surface;
  ghost.opacity = 0.15;
  ghost.behind = true;
  ghost.edges = false;
  PictureOptions options;
  if (!view.empty()) options.view = Vec3(view[0], view[1], view[2]).stableNormalized();
  if (options.view.head<2>().norm() < 1e-6) options.up = Vec3::UnitY();  // from above or below
  options.title = title;
  options.value_label = "displacement [mm]";
  Image image{{shape, ghost}, options, marks_of(model, positions, goals)};
  Bounds drawn;
  for (const Triangle& t : surface)
    for (const Index v : t) drawn.extend(vertex_at(positions, v)).extend(vertex_at(model.rest, v));
  for (const FreeBody& body : model.bodies)
    for (const Index v : body.vertices) drawn.extend(vertex_at(positions, v));
  if (const auto bodies = body_layer(model, positions)) image.layers.push_back(*bodies);
  if (const auto obstacles = obstacle_layer(model, positions, drawn)) image.layers.push_back(*obstacles);
  return image;
}

}  // namespace

void write_image(const fs::path& path, const Model& model, const Points& positions, const std::vector<double>& view,
                 const std::string& title, const std::vector<Goal>& goals) {
  const Image image = image_of(model, positions, view, title, goals);
  write_picture(path, image.layers, image.options, image.marks);
}

std::string image_png(const Model& model, const Points& positions, const std::vector<double>& view,
                      const std::string& title, const std::vector<Goal>& goals) {
  const Image image = image_of(model, positions, view, title, goals);
  return picture_png("the picture", image.layers, image.options, image.marks);
}

}  // namespace softkin::runs
