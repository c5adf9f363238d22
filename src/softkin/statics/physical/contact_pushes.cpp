#include <algorithm>
#include <cmath>
#include <softkin/statics/physical/contact_potential.hpp>
#include <tuple>

// Contact forces as unknowns of their own.

namespace softkin::physical {

using contact::points_of;

namespace {

/// Returns the gap at which the barrier has this contact force.
double gap_of_push(double push, double reach, double modulus) {
  double nearer = 0, farther = reach;
  const double wanted = push / modulus;
  double gap = reach * (1 - std::sqrt(std::min(wanted, 0.5) / 3));
  constexpr int most = 60;
  for (int i = 0; i < most && farther - nearer > 1e-12 * reach; ++i) {
    const energy::LengthLaw law = energy::barrier(gap, reach);
    const double miss = -law.slope - wanted;
    (miss > 0 ? nearer : farther) = gap;
    const double next = law.curvature > 0 ? gap + miss / law.curvature : farther;
    if (std::abs(next - gap) <= 1e-12 * reach) break;
    gap = next > nearer && next < farther ? next : 0.5 * (nearer + farther);
  }
  return gap;
}

bool push_before(const ContactPush& a, const ContactPush& b) {
  return std::tie(a.edges, a.first, a.second) < std::tie(b.edges, b.first, b.second);
}

/// Orders by vertex and part, or by edges, and contacts of the same by decreasing force.
bool strongest_first(const ContactPush& a, const ContactPush& b) {
  if (push_before(a, b) || push_before(b, a)) return push_before(a, b);
  return a.push > b.push;
}

/// Returns the contact force of the same vertex and part, or edges; null: there is none.
ContactPush* same_push(std::vector<ContactPush>& sorted, const ContactPush& as) {
  const auto found = std::lower_bound(sorted.begin(), sorted.end(), as, push_before);
  return found == sorted.end() || push_before(as, *found) ? nullptr : &*found;
}

}  // namespace

ContactPush ContactPotential::push_of(const Term& term) const {
  const bool edges = term.threshold > 0;
  const Index part = edges || surfaces_.triangle_part.empty() ? 0 : surfaces_.triangle_part[term.pair.second];
  return {term.pair.first, edges ? term.pair.second : part, edges, -term.law.slope};
}

std::vector<ContactPush> ContactPotential::pushes(const std::vector<Term>& terms) const {
  std::vector<ContactPush> all, nearest;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!(terms[i].weight > 0)) continue;
    all.push_back(push_of(terms[i]));
    all.back().term = i;
  }
  std::sort(all.begin(), all.end(), strongest_first);
  for (const ContactPush& push : all) {
    if (!nearest.empty() && !push_before(nearest.back(), push)) continue;
    nearest.push_back(push);
    nearest.back().stiffness = terms[push.term].law.curvature;
  }
  std::erase_if(nearest, [](const ContactPush& push) { return !(push.push > 0); });
  return nearest;
}

/// Linearises the barrier laws. When the shape changes, either the contact force or the gap of a contact stays right:
/// the force if the contact persists, the gap if it opens. The line has the slope of the law at the known force. If the
/// gap for that force is far below the current gap, it has the slope with which the force vanishes at the current gap.
void ContactPotential::straighten(std::vector<Term>& terms, std::vector<ContactPush>& known_pushes) const {
  double most = 0;
  for (ContactPush& push : known_pushes) {
    push.term = -1;
    most = std::max(most, push.push);
  }
  std::vector<ContactPush> fresh;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!(terms[i].weight > 0)) continue;
    ContactPush as = push_of(terms[i]);
    ContactPush* known = same_push(known_pushes, as);
    as.term = i;
    if (known == nullptr && as.push > 0)
      fresh.push_back(as);
    else if (known != nullptr &&
             (known->term < 0 || terms[i].separation.squared < terms[known->term].separation.squared))
      known->term = as.term;
  }
  std::sort(fresh.begin(), fresh.end(), strongest_first);
  fresh.erase(std::unique(fresh.begin(), fresh.end(),
                          [](const ContactPush& a, const ContactPush& b) { return !push_before(a, b); }),
              fresh.end());
  for (ContactPush& push : fresh)  // its depth depends on the step
    if (most > 0) push.push = std::min(push.push, most);
  known_pushes.insert(known_pushes.end(), fresh.begin(), fresh.end());
  std::erase_if(known_pushes, [](const ContactPush& push) { return push.term < 0; });
  std::sort(known_pushes.begin(), known_pushes.end(), push_before);
  for (ContactPush& push : known_pushes) {
    const Term& term = terms[push.term];
    push.shift = gap_of_push(push.push, surfaces_.reach_mm, 1) - std::sqrt(term.separation.squared);
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    ContactPush* push = same_push(known_pushes, push_of(terms[i]));
    if (push == nullptr) continue;
    energy::LengthLaw& law = terms[i].law;
    law = energy::barrier(std::sqrt(terms[i].separation.squared) + push->shift, surfaces_.reach_mm);
    if (push->shift < 0) law.curvature = std::min(law.curvature, law.slope / push->shift);
    law.slope -= law.curvature * push->shift;
    if (push->term == static_cast<Index>(i)) push->stiffness = law.curvature;
  }
}

void ContactPotential::follow(const std::vector<Term>& terms, const Points& moves, double fraction,
                              std::vector<ContactPush>& known_pushes) const {
  constexpr double least = 0.1;  // minimum fraction of a contact force that remains after a step
  for (ContactPush& push : known_pushes) {
    const Term& term = terms[push.term];
    const Vec3 normal = term.separation.vector / std::sqrt(term.separation.squared);
    const double wider = normal.dot(points_of(moves, term.nodes) * term.separation.weights);
    const double next = push.push + fraction * push.stiffness * (push.shift - wider);
    push.push = std::max(next, least * push.push);
  }
}

}  // namespace softkin::physical
