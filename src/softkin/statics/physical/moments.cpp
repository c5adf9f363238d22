#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <softkin/statics/physical/moments.hpp>

namespace softkin::physical {

namespace {

/// The forces of a moment on a few vertices, and how they change where these move.
class Couples {
 public:
  Couples(const std::vector<Index>& vertices, const Points& positions, const Vec3& moment) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : vertices) middle += vertex_at(positions, v) / static_cast<double>(vertices.size());
    Mat3 inertia = Mat3::Zero();
    for (const Index v : vertices) {
      const Vec3 arm = arms_.emplace_back(vertex_at(positions, v) - middle);
      inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
    }
    inverse_ = inertia.inverse();
    spin_ = inverse_ * moment;
  }

  [[nodiscard]] Vec3 force(std::size_t i) const { return spin_.cross(arms_[i]); }

  /// Returns the changes of all forces where one vertex moves.
  [[nodiscard]] std::vector<Vec3> changes(std::size_t moved, const Vec3& by) const {
    const auto count = static_cast<double>(arms_.size());
    std::vector<Vec3> of_arms, changes;
    Vec3 turned = Vec3::Zero();  // change of the inertia, times the spin
    for (std::size_t i = 0; i < arms_.size(); ++i) {
      const Vec3 &arm = arms_[i], motion = of_arms.emplace_back((i == moved ? 1 - 1 / count : -1 / count) * by);
      turned += 2 * arm.dot(motion) * spin_ - motion * arm.dot(spin_) - arm * motion.dot(spin_);
    }
    const Vec3 spin = -inverse_ * turned;
    for (std::size_t i = 0; i < arms_.size(); ++i) changes.emplace_back(spin.cross(arms_[i]) + spin_.cross(of_arms[i]));
    return changes;
  }

 private:
  std::vector<Vec3> arms_;
  Mat3 inverse_;
  Vec3 spin_;
};

}  // namespace

Moments::Moments(const Model& model) : model_(model) {
  for (const RegionMoment& of : model.loads.moments)
    for (int axis = 0; axis < 3; ++axis) components_.push_back({of, axis});
  for (Index a = 0; a < std::ssize(model.actuators); ++a)
    if (const auto* command = model.actuators[a].as<MomentCommand>())
      components_[3 * static_cast<std::size_t>(command->moment) + static_cast<std::size_t>(command->axis)].command = a;
}

bool Moments::loads(Index command) const {
  return model_.actuators[command].is<MomentCommand>();
}

bool Moments::grows() const {
  return std::any_of(model_.loads.moments.begin(), model_.loads.moments.end(),
                     [](const RegionMoment& of) { return !of.moment_Nmm.isZero(0); });
}

double Moments::scale(std::size_t part, const LoadState& load_state) const {
  const Component& component = components_[part];
  return load_state.load_factor * component.of.moment_Nmm[component.axis] +
         (component.command < 0 ? 0 : load_state.actuation[component.command]);
}

void Moments::evaluate(const Iterate& at, const LoadState& load_state, Term::Scratch& scratch, Sum& sum,
                       Team& /*team*/) const {
  static_cast<Scratch&>(scratch).load_state = load_state;
  for (std::size_t r = 0; r < model_.loads.moments.size(); ++r) {
    const Vec3 moment(scale(3 * r, load_state), scale(3 * r + 1, load_state), scale(3 * r + 2, load_state));
    if (moment.isZero(0)) continue;
    const std::vector<Index>& vertices = model_.loads.moments[r].vertices;
    const Couples couples(vertices, at.positions, moment);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      sum.gradient.row(vertices[i]) -= couples.force(i).transpose();
      sum.energy -= couples.force(i).dot(vertex_at(at.positions, vertices[i]) - vertex_at(model_.rest, vertices[i]));
    }
  }
}

Moments::Blocks Moments::slopes(std::size_t part, const Points& positions) const {
  const Component& component = components_[part];
  const std::vector<Index>& vertices = component.of.vertices;
  const Couples couples(vertices, positions, Vec3::Unit(component.axis));
  Blocks blocks;
  for (std::size_t j = 0; j < vertices.size(); ++j)
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<Vec3> changes = couples.changes(j, Vec3::Unit(axis));
      for (std::size_t i = 0; i < vertices.size(); ++i) blocks[i][j].col(axis) = -changes[i];
    }
  return blocks;
}

void Moments::add_change(const LoadState& from, const LoadState& to, const Points& positions,
                         Term::Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  for (std::size_t part = 0; part < components_.size(); ++part) {
    const double change = scale(part, to) - scale(part, from);
    if (change == 0) continue;
    const std::vector<Index>& vertices = nodes_of_part(part);
    const Couples couples(vertices, positions, change * Vec3::Unit(components_[part].axis));
    for (std::size_t i = 0; i < vertices.size(); ++i) force.row(vertices[i]) -= couples.force(i).transpose();
  }
}

void Moments::add_derivative(Index command, const LoadState& /*load_state*/, const Points& positions,
                             Term::Scratch& /*scratch*/, Points& force, Team& /*team*/) const {
  for (const Component& component : components_) {
    if (component.command != command) continue;
    const Couples couples(component.of.vertices, positions, Vec3::Unit(component.axis));
    for (std::size_t i = 0; i < component.of.vertices.size(); ++i)
      force.row(component.of.vertices[i]) -= couples.force(i).transpose();
  }
}

}  // namespace softkin::physical
