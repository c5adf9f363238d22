#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <softkin/model/mesh/profile_arc.hpp>

namespace softkin {

namespace {

constexpr double profile_radians = std::numbers::pi / 180;

// Of the length of the chord:
constexpr double on_arc = 2e-3;   // distance of a point that lies on an arc
constexpr double distinct = 0.1;  // points that are nearer to each other count once
constexpr double reach = 3;       // points farther from the chord's middle do not suggest an arc

constexpr double widest_arc = 100 * profile_radians;     // that one chord spans
constexpr double smooth_turn = 50 * profile_radians;     // between chords of one smooth curve, at most
constexpr double doubtful_turn = 100 * profile_radians;  // at a larger angle chords meet in a corner
constexpr double tangent_turn = 6 * profile_radians;     // between an arc and what is tangent to it
constexpr double regular_chords = 1.35;                  // longest over shortest
constexpr double alike_chords = 2.5;                     // the same, of neighbours on one smooth curve
constexpr double alike_bends = 2.5;                      // larger over smaller

/// Half the angle that an arc spans over a chord of this half length.
double half_angle(double bend, double half) {
  return std::atan(2 * half * std::abs(bend));
}

/// The points of a patch in coordinates along the chord and across, from its middle.
class ArcSearch {
 public:
  explicit ArcSearch(const ProfilePatch& patch) : patch_(patch) {
    const Vec2 chord = patch.points[1] - patch.points[0], middle = 0.5 * (patch.points[0] + patch.points[1]);
    half_ = 0.5 * chord.norm();
    const Vec2 along = chord.normalized(), across(-along.y(), along.x());
    for (const Vec2& point : patch.points)
      places_.emplace_back((point - middle).dot(along), (point - middle).dot(across));
  }

  ProfileArc find(bool is_aligned) {
    const Support line = support_of(0);
    Support best = line;
    for (const double bend : suggested_bends())
      if (Support other = support_of(bend); other.places.size() > best.places.size()) best = std::move(other);
    if (line.places.size() >= 3 && line.places.size() + 1 >= best.places.size()) return determined(0);
    if (is_arc(best)) return determined(best.bend);
    return by_sides(is_aligned);
  }

 private:
  struct Support {
    double bend = 0;
    std::vector<Vec2> places;  // distinct ones in the order of the arc
    std::vector<int> members;  // points on the arc
  };
  /// What the neighbours beyond one end of the chord suggest.
  struct Beyond {
    double least = HUGE_VAL, most = -HUGE_VAL;  // bends
    double least_turn = HUGE_VAL;               // of those whose distance is like the chord's length
    [[nodiscard]] bool is_empty() const { return least > most; }
  };

  static ProfileArc determined(double bend) { return {bend, true, bend, bend}; }

  /// The bend of the circle through both ends and a place.
  [[nodiscard]] std::optional<double> bend_through(const Vec2& place) const {
    const double power = place.squaredNorm() - half_ * half_;
    if (std::abs(power) < 0.1 * half_ * half_) return std::nullopt;
    return place.y() / power;
  }

  [[nodiscard]] double distance_to(const Vec2& place, double bend) const {
    const double value = bend * (place.squaredNorm() - half_ * half_) - place.y();
    return std::abs(value) / Vec2(2 * bend * place.x(), 2 * bend * place.y() - 1).norm();
  }

  [[nodiscard]] std::vector<double> suggested_bends() const {
    constexpr std::size_t max_count = 24;
    std::vector<std::pair<double, double>> found;  // distance from the middle, bend
    for (std::size_t i = 2; i < places_.size(); ++i) {
      const auto bend = bend_through(places_[i]);
      const double distance = places_[i].norm();
      if (!bend || distance > 2 * reach * half_ || 2 * half_angle(*bend, half_) > widest_arc) continue;
      found.emplace_back(distance, *bend);
    }
    std::sort(found.begin(), found.end());
    std::vector<double> bends;
    for (const auto& [distance, bend] : found) {
      const double value = bend;
      const bool is_known =
          std::any_of(bends.begin(), bends.end(), [&](double other) { return std::abs(other - value) * half_ < 1e-4; });
      if (!is_known && bends.size() < max_count) bends.push_back(bend);
    }
    return bends;
  }

  /// The angle of a place on an arc, from its middle; of a line the distance.
  [[nodiscard]] double parameter(const Vec2& place, double bend) const {
    if (std::abs(bend) * half_ < 1e-6) return place.x();
    const double sign = bend > 0 ? 1 : -1;
    return std::atan2(place.x(), sign * (1 / (2 * bend) - place.y()));
  }

  [[nodiscard]] Support support_of(double bend) const {
    Support support{bend, {}, {0, 1}};
    std::vector<char> is_seen(places_.size(), 0);
    is_seen[0] = is_seen[1] = 1;
    for (std::size_t at = 0; at < support.members.size(); ++at)
      for (const int next : patch_.neighbours[support.members[at]]) {
        if (is_seen[next] || distance_to(places_[next], bend) > 2 * on_arc * half_) continue;
        is_seen[next] = 1;
        support.members.push_back(next);
      }
    for (const int member : support.members) {
      const bool is_new = std::all_of(support.places.begin(), support.places.end(), [&](const Vec2& other) {
        return (other - places_[member]).norm() > 2 * distinct * half_;
      });
      if (is_new) support.places.push_back(places_[member]);
    }
    std::sort(support.places.begin(), support.places.end(),
              [&](const Vec2& a, const Vec2& b) { return parameter(a, bend) < parameter(b, bend); });
    return support;
  }

  [[nodiscard]] bool is_arc(const Support& support) const {
    const std::vector<Vec2>& places = support.places;
    if (places.size() >= 5) return true;
    if (places.size() < 3) return false;
    double shortest = HUGE_VAL, longest = 0;
    for (std::size_t i = 1; i < places.size(); ++i) {
      shortest = std::min(shortest, (places[i] - places[i - 1]).norm());
      longest = std::max(longest, (places[i] - places[i - 1]).norm());
    }
    const double radius =
        std::abs(1 / (2 * support.bend)) * std::sqrt(1 + 4 * support.bend * support.bend * half_ * half_);
    const double turn = 2 * std::asin(std::min(1.0, longest / (2 * radius)));
    if (places.size() == 4 && longest <= regular_chords * shortest && turn <= 65 * profile_radians) return true;
    return is_continued(support, places.front()) && is_continued(support, places.back());
  }

  /// Whether what the mesh has beyond an end of an arc is tangent to it there.
  [[nodiscard]] bool is_continued(const Support& support, const Vec2& end) const {
    const Vec2 normal = Vec2(2 * support.bend * end.x(), 2 * support.bend * end.y() - 1).normalized();
    double least = HUGE_VAL;
    for (const int member : support.members) {
      if ((places_[member] - end).norm() > 2 * distinct * half_) continue;
      for (const int next : patch_.neighbours[member]) {
        const Vec2 step = places_[next] - places_[member];
        if (std::find(support.members.begin(), support.members.end(), next) != support.members.end()) continue;
        if (step.norm() > 2 * distinct * half_) least = std::min(least, std::abs(step.normalized().dot(normal)));
      }
    }
    return least < std::sin(tangent_turn);
  }

  /// What lies beyond point 0 or 1.
  [[nodiscard]] Beyond beyond(int end) const {
    Beyond found;
    const Vec2 outward(end == 0 ? -1 : 1, 0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if ((places_[i] - places_[end]).norm() > 2 * distinct * half_) continue;
      for (const int next : patch_.neighbours[i]) {
        const Vec2 step = places_[next] - places_[end];
        if (step.norm() < 2 * distinct * half_) continue;
        const double turn = std::acos(std::clamp(step.normalized().dot(outward), -1.0, 1.0));
        const auto bend = bend_through(places_[next]);
        if (turn > doubtful_turn || !bend) continue;
        found.least = std::min(found.least, *bend);
        found.most = std::max(found.most, *bend);
        if (step.norm() >= 2 * half_ / alike_chords && step.norm() <= 2 * half_ * alike_chords)
          found.least_turn = std::min(found.least_turn, turn);
      }
    }
    return found;
  }

  [[nodiscard]] bool are_alike(double least, double most) const {
    const double small = 0.02 / half_;  // 2 degrees of turn
    if (std::max(std::abs(least), std::abs(most)) <= small) return true;
    return least * most > 0 &&
           std::max(std::abs(least), std::abs(most)) <= alike_bends * std::min(std::abs(least), std::abs(most)) + small;
  }

  [[nodiscard]] ProfileArc by_sides(bool is_aligned) const {
    const Beyond sides[] = {beyond(0), beyond(1)};
    double least = 0, most = 0;
    std::vector<const Beyond*> smooth;
    for (const Beyond& side : sides) {
      if (side.is_empty()) continue;
      least = std::min(least, side.least);
      most = std::max(most, side.most);
      if (side.least_turn <= smooth_turn) smooth.push_back(&side);
    }
    if (smooth.size() == 2) {
      const double low = std::min(sides[0].least, sides[1].least), high = std::max(sides[0].most, sides[1].most);
      const double bend = 0.25 * (sides[0].least + sides[0].most + sides[1].least + sides[1].most);
      if (are_alike(low, high)) return determined(bend);
    } else if (smooth.size() == 1 && !(least < 0 && most > 0)) {
      const double bend = 0.5 * (smooth[0]->least + smooth[0]->most);
      if (are_alike(smooth[0]->least, smooth[0]->most) && 2 * half_angle(bend, half_) <= 30 * profile_radians)
        return determined(bend);
    }
    if (is_aligned || (sides[0].is_empty() && sides[1].is_empty())) return determined(0);
    const double widest = std::tan(0.5 * widest_arc) / (2 * half_);
    return {0, false, std::max(least, -widest), std::min(most, widest)};
  }

  const ProfilePatch& patch_;
  double half_ = 0;
  std::vector<Vec2> places_;
};

}  // namespace

ProfileArc profile_arc(const ProfilePatch& patch, bool is_aligned) {
  return ArcSearch(patch).find(is_aligned);
}

Vec2 point_of_arc(const Vec2& start, const Vec2& end, double bend, double fraction) {
  const Vec2 chord = end - start, across(-chord.y(), chord.x());
  const double length = chord.norm(), half = 0.5 * length, x = (2 * fraction - 1) * half;
  const double rest = half * half - x * x;
  // b (x^2 + y^2 - h^2) = y, the root that is 0 for b = 0
  const double y = -2 * bend * rest / (1 + std::sqrt(std::max(0.0, 1 + 4 * bend * bend * rest)));
  return start + fraction * chord + (length > 0 ? Vec2(y / length * across) : Vec2(Vec2::Zero()));
}

Vec2 nearest_of_arc(const Vec2& start, const Vec2& end, double bend, const Vec2& place) {
  const Vec2 chord = end - start;
  const double length2 = chord.squaredNorm();
  if (!(length2 > 0)) return start;
  const Vec2 across(-chord.y(), chord.x());
  const Vec2 offset = place - 0.5 * (start + end);
  const double length = std::sqrt(length2);
  double fraction = 0.5 + offset.dot(chord) / length2;
  if (std::abs(bend) * length > 1e-6) {  // on the line to the centre, which is 1 / (2 b) above the chord's middle
    const Vec2 local(offset.dot(chord) / length, offset.dot(across) / length), centre(0, 1 / (2 * bend));
    const double radius = std::hypot(0.5 * length, centre.y());
    const Vec2 to_place = local - centre;
    if (to_place.norm() > 1e-9 * radius) fraction = 0.5 + radius * to_place.x() / to_place.norm() / length;
  }
  return point_of_arc(start, end, bend, std::clamp(fraction, 0.0, 1.0));
}

}  // namespace softkin
