#include <algorithm>
#include <cmath>
#include <softkin/core/error.hpp>
#include <softkin/core/text.hpp>
#include <softkin/io/plain_text.hpp>
#include <softkin/io/table/tensile_branch.hpp>

namespace softkin {

namespace {

/// Where a loading branch begins and ends, by rows.
struct Branch2 {
  std::size_t from = 0, to = 0;  // the last one of it
};

/// Loading branches between strains that turn by more than noise.
std::vector<Branch2> loading_branches(const std::vector<double>& strain) {
  const auto [least, most] = std::minmax_element(strain.begin(), strain.end());
  const double turn = 0.03 * (*most - *least);
  std::vector<Branch2> branches;
  std::size_t low = 0, high = 0;
  bool is_rising = true;
  for (std::size_t i = 0; i < strain.size(); ++i) {
    if (is_rising) {
      if (strain[i] > strain[high]) high = i;
      if (strain[high] - strain[i] <= turn) continue;
      if (strain[high] - strain[low] > turn) branches.push_back({low, high});
      is_rising = false;
      low = i;
    } else {
      if (strain[i] < strain[low]) low = i;
      if (strain[i] - strain[low] <= turn) continue;
      is_rising = true;
      high = i;
    }
  }
  if (is_rising && strain[high] - strain[low] > turn) branches.push_back({low, high});
  return branches;
}

/// The rows of a branch whose strain exceeds all before.
TensileCurve rising(const TensileCurve& curve, const Branch2& branch) {
  TensileCurve kept{{}, {}, {}, curve.notes};
  for (std::size_t i = branch.from; i <= branch.to; ++i) {
    if (!kept.strain.empty() && !(curve.strain[i] > kept.strain.back())) continue;
    kept.strain.push_back(curve.strain[i]);
    kept.stress.push_back(curve.stress[i]);
    kept.lines.push_back(curve.lines[i]);
  }
  return kept;
}

}  // namespace

TensileCurve branch_of(const TensileCurve& curve, TensileBranch which) {
  Branch2 branch{0, curve.strain.size() - 1};
  const std::vector<Branch2> branches = loading_branches(curve.strain);
  if (which != TensileBranch::envelope && !branches.empty())
    branch = which == TensileBranch::first ? branches.front() : branches.back();
  TensileCurve kept = rising(curve, branch);
  const std::size_t left_out = curve.strain.size() - kept.strain.size();
  if (left_out > 0)
    kept.notes.push_back(counted(left_out, "row") + " of " + std::to_string(curve.strain.size()) +
                         (left_out == 1 ? " is" : " are") +
                         " left out: unloading, other cycles, or strains that do not ascend (option 'branch')");
  return kept;
}

namespace {

/// Strain at which the straight line through the beginning of a curve has no stress.
double toe_of(const TensileCurve& curve) {
  constexpr double beginning = 0.25;  // of strain
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < curve.strain.size(); ++i) {
    const double e = curve.strain[i] - curve.strain.front(), s = curve.stress[i];
    if (e > beginning && n >= 3) break;
    n += 1, x += e, y += s, xx += e * e, xy += e * s;
  }
  const double slope = (xy - x * y / n) / (xx - x * x / n);
  const double offset = y / n - slope * x / n;
  return curve.strain.front() - offset / slope;
}

}  // namespace

void set_zero(TensileCurve& curve, TensileZero zero) {
  if (zero == TensileZero::file || curve.strain.size() < 3) return;
  const double at = zero == TensileZero::first ? curve.strain.front() : toe_of(curve);
  const double stress = zero == TensileZero::first ? curve.stress.front() : 0;
  if (!(std::isfinite(at) && at > -0.5 && at < curve.strain.back()))
    throw InvalidInput("the beginning of the curve gives no strain at which the stress is 0");
  TensileCurve moved{{}, {}, {}, curve.notes};
  for (std::size_t i = 0; i < curve.strain.size(); ++i) {
    const double e = (curve.strain[i] - at) / (1 + at);
    if (e < 0) continue;
    moved.strain.push_back(e);
    moved.stress.push_back(curve.stress[i] - stress);
    moved.lines.push_back(curve.lines[i]);
  }
  moved.notes.push_back("the strain is 0 at " + number(at, 4) + " of the file's" +
                        (stress != 0 ? ", where the stress of " + number(stress, 4) + " MPa is taken off" : ""));
  curve = std::move(moved);
}

}  // namespace softkin
