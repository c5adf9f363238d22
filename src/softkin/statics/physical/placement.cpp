#include <softkin/statics/physical/placement.hpp>

namespace softkin::physical {

namespace {

/// Moves shorter than this fraction of the robot's diagonal cause no significant rotation.
constexpr double min_turning = 1e-4;
/// The correction of moves for rotations grows with their square. With contact, a correction is rejected if it exceeds
/// this multiple of the square over the diagonal.
constexpr double max_turning = 30;

}  // namespace

Placement::Placement(const Model& model, const Body& body, const supports::Freedoms& freedoms, const Placement* like)
    : model_(model),
      body_(body),
      freedoms_(freedoms),
      contact_(model.contact.any()),
      supports_(model),
      turning_(like ? like->turning_
                    : std::make_shared<const supports::GlobalStep>(model, body.laplacian(), freedoms.vertex_order())) {
  for (const Actuator& actuator : model.actuators) {
    const auto* motion = actuator.as<MotionCommand>();
    moved_.push_back(motion ? Moved{model.vertices_of_part(motion->part), motion->axis} : Moved{});
  }
}

void Placement::hold(const LoadState& load_state, Points& positions) const {
  freedoms_.hold(load_state.load_factor, positions);
  supports_.place(load_state.actuation, load_state.load_factor, positions);
  for (std::size_t a = 0; a < moved_.size(); ++a)
    for (Index v = moved_[a].vertices[0]; v < moved_[a].vertices[1]; ++v)
      positions(v, moved_[a].axis) += load_state.actuation[a];
}

bool Placement::changes(const LoadState& from, const LoadState& to) const {
  if (from.load_factor != to.load_factor) return true;
  for (std::size_t a = 0; a < model_.actuators.size(); ++a) {
    const Actuator& command = model_.actuators[a];
    const Index i = a;
    if ((command.is<MotionCommand>() || command.is<TurnCommand>()) && from.actuation[i] != to.actuation[i]) return true;
  }
  return false;
}

void Placement::velocity(Index actuator, const LoadState& load_state, Points& moves) const {
  moves.setZero(model_.rest.rows(), 3);
  const Moved& moved = moved_[actuator];
  const auto& [first, end] = moved.vertices;
  if (end > first) moves.col(moved.axis).segment(first, end - first).setOnes();
  supports_.add_velocity(actuator, load_state.actuation, load_state.load_factor, moves);
}

double Placement::command_of(Index actuator, const Points& positions) const {
  if (model_.actuators[actuator].is<TurnCommand>()) return supports_.angle(actuator, positions);
  const Moved& moved = moved_[actuator];
  const Index first = moved.vertices[0];
  return positions(first, moved.axis) - model_.rest(first, moved.axis);
}

void Placement::advance(const Eigen::VectorXd& step, double scale, Scratch& scratch, Body::Scratch& elastic,
                        Points& positions, Team& team, const LoadState* held) const {
  freedoms_.expand(scale * step, positions, scratch.moves);
  if (held && !contact_) {  // with contact, rotations from moving supports would cause more contacts
    Points there = positions;
    hold(*held, there);
    scratch.moves += there - positions;
  }
  const auto move = [&] {
    freedoms_.move(step, scale, positions);
    if (held) hold(*held, positions);
  };
  const double length = scratch.moves.cwiseAbs().maxCoeff();
  if (length < min_turning * model_.diagonal_mm) return move();
  body_.turning(positions, scratch.moves, elastic, scratch.lacking, team);
  move();
  const Points straight = contact_ ? positions : Points();
  std::vector<supports::Pose> poses = turning_->poses(positions);
  turning_->step(scratch.lacking, positions, poses, team);
  // a body held by contact alone has no resistance to rotation, and its correction may be far too large
  if (contact_ && largest_move(straight, positions) > max_turning * length * length / model_.diagonal_mm)
    positions = straight;
}

}  // namespace softkin::physical
