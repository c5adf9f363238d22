#pragma once

#include <softkin/contact/candidates.hpp>

namespace softkin::contact {

/// Returns the fraction t in [0, 1] of a motion x(t) = from + t (to - from) along which four points are safe: at every
/// instant up to t, in exact arithmetic and with positions rounded to doubles, the distance stays above `keep` times
/// that of the start. Conservative: never too long. 0 for pairs that touch at the start, `until` for pairs without a
/// relative motion.
///
/// keep       in (0, 1)
/// until      larger fractions are of no interest: returned where the motion is safe up to it
/// algorithm  additive advancement (Li, Kaufman, Jiang 2021, "Codimensional incremental potential contact", ACCD)
/// deviation  advances by the largest of three safe times: distance over the largest relative speed of two points; how
///            long the planes across the shortest vector stay apart, in which motion along them costs nothing; and,
///            from the third advance on, how long the planes that the features span do, in which turning costs little.
///            At most 100 advances
[[nodiscard]] double safe_vertex_triangle(const FourPoints& from, const FourPoints& to, double keep = 0.1,
                                          double until = 1);
[[nodiscard]] double safe_edge_edge(const FourPoints& from, const FourPoints& to, double keep = 0.1, double until = 1);

/// Returns the fraction in [0, 1] of a motion along which every candidate is safe: the minimum over the candidates, the
/// same on any team.
///
/// candidates  of the whole motion (BroadPhase::find with both ends)
[[nodiscard]] double safe_motion(const Surface& surface, const Candidates& candidates, const Points& from,
                                 const Points& to, double keep, Team& team);

/// The least squared distance of the candidates [mm^2]; infinite without any.
[[nodiscard]] double min_squared_distance(const Surface& surface, const Candidates& candidates, const Points& positions,
                                          Team& team);

}  // namespace softkin::contact
