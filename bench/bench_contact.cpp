// Measures the time of contact operations on a torus of 20,000 triangles: distances of pairs with their derivatives,
// collision-free fractions of motions, and the broad phase. Needs the contact library alone.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <softkin/contact/candidates.hpp>
#include <softkin/contact/collision.hpp>

#include "contact/contact_samples.hpp"

namespace {

using namespace softkin;
using namespace softkin::contact;
using namespace softkin::contact::testing;

/// Seconds: the least of several runs.
template <class Work>
double least(int runs, const Work& work) {
  double seconds = 1e9;
  for (int run = 0; run < runs; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    seconds = std::min(seconds, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return seconds;
}

void print_pairs() {
  constexpr std::size_t count = 4096;
  Random random(1);
  std::vector<FourPoints> from(count), to(count);
  double sum = 0;  // of what was computed, so that it is
  std::printf("%-16s %12s %12s %14s %14s %14s\n", "random pairs", "d^2 [ns]", "all [ns]", "step 1% [ns]",
              "step 30% [ns]", "step 200% [ns]");
  for (const Kind kind : kinds) {
    std::vector<double> times;
    const auto time = [&](const auto& work) {
      times.push_back(1e9 / count * least(50, [&] {
                        for (std::size_t i = 0; i < count; ++i) work(i);
                      }));
    };
    for (FourPoints& x : from) x = random.points();
    time([&](std::size_t i) { sum += separation(kind, from[i]).squared; });
    Hessian hessian;
    time([&](std::size_t i) {
      const Separation s = separation(kind, from[i]);
      squared_hessian(s, hessian);
      sum += s.squared + squared_gradient(s)[4] + hessian(4, 7);
    });
    for (const double speed : {0.01, 0.3, 2.0}) {
      for (std::size_t i = 0; i < count; ++i) to[i] = from[i] + speed * random.points();
      time([&](std::size_t i) {
        sum += kind == Kind::vertex_triangle ? safe_vertex_triangle(from[i], to[i]) : safe_edge_edge(from[i], to[i]);
      });
    }
    std::printf("%-16s %12.0f %12.0f %14.0f %14.0f %14.0f\n", name_of(kind), times[0], times[1], times[2], times[3],
                times[4]);
  }
  if (!std::isfinite(sum)) std::printf("not finite\n");
}

struct Torus {
  Points points;
  std::vector<Corners> triangles;
};

Torus make_torus(Index around, double radius, double tube) {
  Torus torus{Points(around * around, 3), {}};
  const auto at = [around](Index i, Index j) { return i % around * around + j % around; };
  for (Index i = 0; i < around; ++i)
    for (Index j = 0; j < around; ++j) {
      const double a = 2 * M_PI * i / around, b = 2 * M_PI * j / around, r = radius + tube * std::cos(b);
      torus.points.row(at(i, j)) << r * std::cos(a), r * std::sin(a), tube * std::sin(b);
      torus.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      torus.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return torus;
}

void print_broad_phase() {
  const Torus torus = make_torus(100, 20, 8);
  const Surface surface = make_surface(torus.triangles, torus.points);
  BroadPhase phase(surface, torus.points);
  Points flat = torus.points, moved = torus.points;
  flat.col(2) *= 0.02;
  moved.col(0).array() += 0.5;
  moved.col(2) *= 0.95;
  std::printf("\n%zu triangles, %zu edges of about 1 mm\n", surface.triangles.size(), surface.edges.size());
  std::printf("%-20s %12s %8s %10s %10s %12s\n", "", "reach [mm]", "threads", "VT", "EE", "find [ms]");
  Candidates found;
  for (const int threads : {1, 2}) {
    Team team(threads);
    const auto print = [&](const char* name, const Points& from, const Points& to, double reach) {
      const double seconds = least(20, [&] { phase.find(from, to, reach, team, found); });
      std::printf("%-20s %12g %8d %10zu %10zu %12.1f\n", name, reach, threads, found.vertex_triangle.size(),
                  found.edge_edge.size(), 1e3 * seconds);
    };
    for (const double reach : {0.01, 0.1, 0.5}) print("torus", torus.points, torus.points, reach);
    for (const double reach : {0.01, 0.1}) print("pressed flat", flat, flat, reach);
    print("moves by 0.5 mm", torus.points, moved, 0.01);
  }
}

}  // namespace

int main() {
  print_pairs();
  print_broad_phase();
  return 0;
}
