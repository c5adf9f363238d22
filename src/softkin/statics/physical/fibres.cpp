#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <softkin/statics/physical/fibres.hpp>

namespace softkin::physical {

namespace {

constexpr double taut = -1e-9;  // strain above which a tension-only fibre is stiff; it is stiff at rest

/// Response of a fibre to its stretch, per length at rest.
struct FibrePull {
  double energy_N = 0, tension_N = 0, slope_N = 0;
};

FibrePull pull_of(double stiffness_N, bool tension_only, double stretch) {
  const double e = stretch - 1;
  if (tension_only && e <= 0) return {0, 0, e > taut ? stiffness_N : 0};
  return {stiffness_N * e * e / 2, stiffness_N * e, stiffness_N};
}

Vec3 tangent(const std::vector<Index>& vertices, const std::vector<double>& slopes, const Points& positions) {
  Vec3 along = Vec3::Zero();
  for (std::size_t i = 0; i < vertices.size(); ++i) along += slopes[i] * vertex_at(positions, vertices[i]);
  return along;
}

}  // namespace

Fibres::Fibres(const Model& model) : fibres_(model.reinforcement.fibres) {
  std::map<std::vector<Index>, std::size_t> known;
  for (const Fibre& fibre : fibres_)
    for (const FibrePlace& place : fibre.places) {
      std::vector<std::size_t> order(place.vertices.size());
      std::iota(order.begin(), order.end(), 0);
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return place.vertices[a] < place.vertices[b]; });
      std::vector<Index> vertices;
      Place own{{}, place.length_mm, fibre.stiffness_N, fibre.tension_only};
      for (const std::size_t i : order) {
        vertices.push_back(place.vertices[i]);
        own.slopes.push_back(place.slopes[i]);
      }
      const auto [at, fresh] = known.emplace(vertices, groups_.size());
      if (fresh) groups_.push_back({std::move(vertices), {}});
      groups_[at->second].places.push_back(std::move(own));
    }
}

void Fibres::evaluate(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& /*scratch*/, Sum& sum,
                      Team& /*team*/) const {
  for (const Group& group : groups_)
    for (const Place& place : group.places) {
      const Vec3 along = tangent(group.vertices, place.slopes, at.positions);
      const double stretch = along.norm();
      const FibrePull pull = pull_of(place.stiffness_N, place.tension_only, stretch);
      sum.energy += place.length_mm * pull.energy_N;
      if (pull.tension_N == 0) continue;
      if (stretch == 0) {  // pressed to a point: it has no direction
        sum.forbidden = true;
        continue;
      }
      const Vec3 force = place.length_mm * pull.tension_N / stretch * along;
      for (std::size_t i = 0; i < group.vertices.size(); ++i)
        sum.gradient.row(group.vertices[i]) += place.slopes[i] * force.transpose();
    }
}

void Fibres::add_cliques(linear::Cliques& cliques) {
  for (Group& group : groups_) {
    group.slot = cliques.slots.back();
    cliques.add(group.vertices);
  }
}

void Fibres::stiffness(const Iterate& at, const LoadState& /*load_state*/, bool projected, Term::Scratch& /*scratch*/,
                       LargeVector<double>& slots, Team& team) const {
  using Block = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
  team.pieces(groups_.size(), [&](Index begin, Index end) {
    for (Index g = begin; g < end; ++g) {
      const Group& group = groups_[g];
      const std::size_t count = group.vertices.size();
      double* const first = slots.data() + 9 * group.slot;
      std::fill_n(first, 9 * count * (count + 1) / 2, 0.0);
      for (const Place& place : group.places) {
        const Vec3 along = tangent(group.vertices, place.slopes, at.positions);
        const double stretch = along.norm();
        const FibrePull pull = pull_of(place.stiffness_N, place.tension_only, stretch);
        if (pull.slope_N == 0 || stretch == 0) continue;
        const Vec3 t = along / stretch;
        const double across = projected ? std::max(0.0, pull.tension_N / stretch) : pull.tension_N / stretch;
        const Mat3 change = place.length_mm * (across * Mat3::Identity() + (pull.slope_N - across) * t * t.transpose());
        double* out = first;
        for (std::size_t i = 0; i < count; ++i)
          for (std::size_t j = 0; j <= i; ++j, out += 9) Block(out, 3, 3) += place.slopes[i] * place.slopes[j] * change;
      }
    }
  });
}

bool Fibres::kinked() const {
  return std::any_of(fibres_.begin(), fibres_.end(), [](const Fibre& fibre) { return fibre.tension_only; });
}

void Fibres::describe(const Iterate& at, const LoadState& /*load_state*/, Term::Scratch& /*scratch*/,
                      ElementDeformation& out, Team& /*team*/) const {
  for (const Fibre& fibre : fibres_) {
    FibreForces reported;
    double rest = 0, now = 0, work = 0, slack = 0;
    for (const FibrePlace& place : fibre.places) {
      const double stretch = tangent(place.vertices, place.slopes, at.positions).norm();
      const double tension = pull_of(fibre.stiffness_N, fibre.tension_only, stretch).tension_N;
      if (rest == 0 || tension > reported.largest_N) {
        reported.largest_N = tension;
        reported.where = Vec3::Zero();
        for (std::size_t i = 0; i < place.vertices.size(); ++i)
          reported.where += place.weights[i] * vertex_at(at.positions, place.vertices[i]);
      }
      reported.min_N = rest == 0 ? tension : std::min(reported.min_N, tension);
      rest += place.length_mm;
      now += place.length_mm * stretch;
      work += place.length_mm * tension;
      if (fibre.tension_only && tension == 0) slack += place.length_mm;
    }
    reported.mean_N = work / rest;
    reported.stretch = now / rest;
    reported.slack = slack / rest;
    out.fibres.push_back(reported);
  }
}

}  // namespace softkin::physical
