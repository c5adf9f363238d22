#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/friction.hpp>

namespace softkin::physical {

namespace {

/// Elastic displacement of a sticking contact up to the friction limit, over the contact distance.
constexpr double creep_fraction = 0.02;

/// Compares by the order of anchors.
template <class A, class B>
bool before(const A& a, const B& b) {
  return a.vertex != b.vertex ? a.vertex < b.vertex : a.part < b.part;
}

}  // namespace

Friction::Friction(const ContactSurfaces& surfaces)
    : surfaces_(surfaces), creep_mm_(creep_fraction * surfaces.reach_mm) {
  any_ = surfaces.rules != nullptr && surfaces.rules->has_friction();
}

/// The contact of a vertex with a part.
struct Friction::Touch {
  Index vertex, part;  // the vertex by its place in the surface
  Vec3 force = Vec3::Zero();
  double nearest = HUGE_VAL;                     // squared [mm^2]
  const ContactPotential::Term* term = nullptr;  // the nearest one
};

/// Returns the contacts in the order of anchors; terms are ordered by vertices.
std::vector<Friction::Touch> Friction::touches(const Terms& terms) const {
  std::vector<Touch> all;
  std::size_t first = 0;  // of the vertex at hand
  for (const ContactPotential::Term& term : terms) {
    if (term.threshold > 0) continue;
    const Index vertex = term.pair.first, part = surfaces_.triangle_part[term.pair.second];
    const Index own = surfaces_.vertex_part[vertex];
    if (surfaces_.rules->pair(own, part).friction == 0) continue;
    if (first < all.size() && all[first].vertex != vertex) first = all.size();
    auto found = std::find_if(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(),
                              [part](const Touch& touch) { return touch.part == part; });
    if (found == all.end()) found = all.insert(found, Touch{vertex, part});
    const double gap = std::sqrt(term.separation.squared);
    found->force -= term.weight * term.law.slope / gap * term.separation.vector;
    if (term.weight > 0 && term.separation.squared < found->nearest) {
      found->nearest = term.separation.squared;
      found->term = &term;
    }
  }
  std::erase_if(all, [](const Touch& touch) { return touch.term == nullptr || !(touch.force.squaredNorm() > 0); });
  std::sort(all.begin(), all.end(), before<Touch, Touch>);
  return all;
}

void Friction::hold(const Terms& terms, const std::vector<Anchor>& anchors, Holds& holds) const {
  holds.clear();
  const std::vector<Touch> all = touches(terms);
  auto touch = all.begin();
  for (const Anchor& anchor : anchors) {
    while (touch != all.end() && before(*touch, anchor)) ++touch;
    if (touch == all.end() || before(anchor, *touch)) continue;
    Hold hold;
    hold.pair = {anchor.vertex, anchor.triangle};
    hold.part = anchor.part;
    hold.nodes = nodes_of_vertex_triangle(surfaces_.surface, hold.pair);
    hold.weights << 1, -anchor.weights;
    const double pressed = touch->force.norm();
    hold.normal = touch->force / pressed;
    const Index own = surfaces_.vertex_part[anchor.vertex];
    hold.limit = surfaces_.rules->pair(own, anchor.part).friction * pressed;
    holds.push_back(hold);
  }
}

namespace {

/// Returns the weights of the corners of a triangle, columns 1 to 3, after their point has moved along its plane.
Vec3 shifted(const contact::FourPoints& x, const Vec3& weights, const Vec3& motion) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << x.col(2) - x.col(1), x.col(3) - x.col(1);
  const Eigen::Vector2d change = (sides.transpose() * sides).inverse() * (sides.transpose() * motion);
  return change.allFinite() ? Vec3(weights + Vec3(-change.sum(), change[0], change[1])) : weights;
}

/// Returns the first fraction s of a motion at which a + b s + c s^2 is 0; 0 if a is not positive, 1 if there is none.
double first_zero(double a, double b, double c) {
  if (!(a > 0)) return 0;
  const double under_root = b * b - 4 * a * c;
  if (!(under_root >= 0)) return 1;
  const double root = 2 * a / (-b + std::sqrt(under_root));
  return root >= 0 && root <= 1 ? root : 1;
}

}  // namespace

/// Returns the anchor of a contact that came into reach during a motion. The anchor is where that would have happened
/// without contact forces: once they act, the gap hardly changes any more.
Anchor Friction::fresh_anchor(const Points& from, const Points& to, const FreeMotion& free, const Touch& touch) const {
  const contact::Nodes nodes = nodes_of_vertex_triangle(surfaces_.surface, touch.term->pair);
  const auto apart = [&](const Points& shape) -> Vec3 {
    return contact::points_of(shape, nodes) * touch.term->separation.weights;
  };
  const Vec3 normal = touch.force.normalized(), now = apart(to), then = apart(from);
  Vec3 turned = apart(free.turned), straight = apart(free.straight);
  if (!(turned.dot(normal) < now.dot(normal))) turned = straight = now;
  const Vec3 move = straight - then, bend = turned - straight;
  const double fraction = first_zero(then.dot(normal) - surfaces_.reach_mm, move.dot(normal), bend.dot(normal));
  Vec3 motion = now - then - fraction * move - fraction * fraction * bend;
  motion -= motion.dot(normal) * normal;
  return {touch.vertex, touch.part, touch.term->pair.second,
          shifted(contact::points_of(to, nodes), -touch.term->separation.weights.tail<3>(), -motion)};
}

void Friction::renew(const Points& from, const Points& to, const FreeMotion& free, const Terms& terms,
                     std::vector<Anchor>& anchors) const {
  std::vector<Anchor> now;
  for (const Touch& touch : touches(terms)) {
    const auto old = std::lower_bound(anchors.begin(), anchors.end(), touch, before<Anchor, Touch>);
    const bool known = old != anchors.end() && !before(touch, *old);
    now.push_back(known ? *old : fresh_anchor(from, to, free, touch));
  }
  anchors = std::move(now);
}

Vec3 Friction::slip(const Points& positions, const Hold& hold) {
  const Vec3 motion = contact::points_of(positions, hold.nodes) * hold.weights;
  return motion - motion.dot(hold.normal) * hold.normal;
}

void Friction::slide(const Points& positions, const Terms& terms, const Holds& holds,
                     std::vector<Anchor>& anchors) const {
  const std::vector<Touch> all = touches(terms);
  for (const Hold& hold : holds) {
    const Vec3 motion = slip(positions, hold);
    const double length = motion.norm();
    if (!(length > creep_mm_)) continue;
    const Index part = surfaces_.triangle_part[hold.pair.second];
    const auto anchor = std::find_if(anchors.begin(), anchors.end(),
                                     [&](const Anchor& a) { return a.vertex == hold.pair.first && a.part == part; });
    const auto touch = std::find_if(all.begin(), all.end(),
                                    [&](const Touch& t) { return t.vertex == hold.pair.first && t.part == part; });
    if (anchor == anchors.end() || touch == all.end()) continue;
    anchor->slipped_mm += length - creep_mm_;
    anchor->triangle = touch->term->pair.second;
    const contact::FourPoints x =
        contact::points_of(positions, nodes_of_vertex_triangle(surfaces_.surface, {hold.pair.first, anchor->triangle}));
    anchor->weights = shifted(x, -touch->term->separation.weights.tail<3>(), -creep_mm_ / length * motion);
  }
}

Vec3 Friction::force(const Points& positions, const Hold& hold) const {
  const Vec3 motion = slip(positions, hold);
  const double length = motion.norm();
  return length > 0 ? Vec3(-hold.limit * energy::friction(length, creep_mm_).slope / length * motion) : Vec3::Zero();
}

double Friction::slipping_fraction(const Points& positions, const Holds& holds) const {
  constexpr double nearly = 0.75;  // of the creep: friction is within 6 % of its limit
  double all = 0, slipping = 0;
  for (const Hold& hold : holds) {
    all += hold.limit;
    if (slip(positions, hold).norm() > nearly * creep_mm_) slipping += hold.limit;
  }
  return all > 0 ? slipping / all : 0;
}

double Friction::disagreement(const Points& positions, const Holds& before, const Holds& after) const {
  double largest = 0, change = 0;
  const auto compare = [&](const Vec3& then, const Vec3& now) {
    largest = std::max({largest, then.norm(), now.norm()});
    change = std::max(change, (now - then).norm());
  };
  const auto key = [](const Hold& hold) { return std::pair(hold.pair.first, hold.part); };
  auto old = before.begin();
  for (const Hold& hold : after) {
    for (; old != before.end() && key(*old) < key(hold); ++old) compare(force(positions, *old), Vec3::Zero());
    const bool same = old != before.end() && key(*old) == key(hold);
    compare(same ? force(positions, *old++) : Vec3::Zero(), force(positions, hold));
  }
  for (; old != before.end(); ++old) compare(force(positions, *old), Vec3::Zero());
  return largest > 0 ? change / largest : 0;
}

double Friction::energy(const Points& positions, const Holds& holds) const {
  double sum = 0;
  for (const Hold& hold : holds) sum += hold.limit * energy::friction(slip(positions, hold).norm(), creep_mm_).value;
  return sum;
}

void Friction::add_gradient(const Points& positions, const Holds& holds, Points& gradient) const {
  for (const Hold& hold : holds) {
    const Vec3 push = force(positions, hold);
    for (int i = 0; i < 4; ++i) gradient.row(hold.nodes[i]) -= hold.weights[i] * push.transpose();
  }
}

void Friction::stiffness(const Points& positions, const Hold& hold, contact::Hessian& out) const {
  const Vec3 motion = slip(positions, hold);
  const double length = motion.norm();
  const energy::LengthLaw law = energy::friction(length, creep_mm_);
  Mat3 across = Mat3::Identity() - hold.normal * hold.normal.transpose();
  Mat3 block = hold.limit * (length > 0 ? law.slope / length : law.curvature) * across;
  if (length > 0) {
    const Vec3 along = motion / length;
    block += hold.limit * (law.curvature - law.slope / length) * along * along.transpose();
  }
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) out.block<3, 3>(3 * i, 3 * j) = hold.weights[i] * hold.weights[j] * block;
}

namespace {

/// Returns the change of the friction force when the normal force on a vertex changes.
///
/// motion  of the vertex from its anchor
Vec3 change_of_force(double coefficient, double creep, const Vec3& motion, const Vec3& pressed, const Vec3& change) {
  const double size = pressed.norm();
  const Vec3 normal = pressed / size;
  const double more = normal.dot(change);
  const Vec3 turned = (change - more * normal) / size;
  const Vec3 slip = motion - motion.dot(normal) * normal,
             slip_change = -motion.dot(turned) * normal - motion.dot(normal) * turned;
  const double length = slip.norm();
  if (!(length > 0)) return -coefficient * size * energy::friction(0, creep).curvature * slip_change;
  const energy::LengthLaw law = energy::friction(length, creep);
  const double fraction = law.slope / length, bend = (law.curvature - fraction) / (length * length);
  return -coefficient *
         (more * fraction * slip + size * (fraction * slip_change + bend * slip.dot(slip_change) * slip));
}

}  // namespace

void Friction::add_response(const ContactPotential& potential, const Points& positions, const Terms& terms,
                            const Holds& holds, const Points& moves, Points& gradient) const {
  const auto end = std::find_if(terms.begin(), terms.end(), [](const auto& term) { return term.threshold > 0; });
  contact::Hessian block;
  for (const Hold& hold : holds) {
    Vec3 pressed = Vec3::Zero(), change = Vec3::Zero();
    auto term = std::lower_bound(terms.begin(), end, hold.pair.first,
                                 [](const auto& of, Index vertex) { return of.pair.first < vertex; });
    for (; term != end && term->pair.first == hold.pair.first; ++term) {
      if (surfaces_.triangle_part[term->pair.second] != hold.part) continue;
      const double gap = std::sqrt(term->separation.squared);
      pressed -= term->weight * term->law.slope / gap * term->separation.vector;
      potential.stiffness(positions, *term, false, block);
      for (int i = 0; i < 4; ++i) change -= block.block<3, 3>(0, 3 * i) * moves.row(term->nodes[i]).transpose();
    }
    const double size = pressed.norm();
    if (!(size > 0)) continue;
    const Vec3 motion = contact::points_of(positions, hold.nodes) * hold.weights;
    const Vec3 more = change_of_force(hold.limit / size, creep_mm_, motion, pressed, change);
    for (int i = 0; i < 4; ++i) gradient.row(hold.nodes[i]) -= hold.weights[i] * more.transpose();
  }
}

}  // namespace softkin::physical
