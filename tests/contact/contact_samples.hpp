#pragma once

#include <Eigen/Geometry>
#include <random>
#include <softkin/contact/distance.hpp>

namespace softkin::contact::testing {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  double normal() { return normal_(engine_); }
  Vec3 vector() { return {normal(), normal(), normal()}; }
  FourPoints points() {
    FourPoints x;
    for (int i = 0; i < 4; ++i) x.col(i) = vector();
    return x;
  }
  Mat3 rotation() { return Eigen::Quaterniond(normal(), normal(), normal(), normal()).normalized().toRotationMatrix(); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

/// One of the two kinds of pairs.
enum class Kind { vertex_triangle, edge_edge };
inline constexpr Kind kinds[] = {Kind::vertex_triangle, Kind::edge_edge};

inline Separation separation(Kind kind, const FourPoints& x) {
  return kind == Kind::vertex_triangle ? vertex_triangle(x) : edge_edge(x);
}

inline const char* name_of(Kind kind) {
  return kind == Kind::vertex_triangle ? "vertex-triangle" : "edge-edge";
}

}  // namespace softkin::contact::testing
