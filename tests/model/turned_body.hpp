#pragma once

#include <functional>

#include "model/round_mesh.hpp"

namespace softkin::testing {

/// A piece of the profile of a turned body: (z, r) for t from 0 to 1; a line, or an arc around a centre.
struct ProfilePiece {
  std::function<Eigen::Vector2d(double)> at;
  int elements = 1;
};

inline ProfilePiece profile_line(Eigen::Vector2d from, Eigen::Vector2d to, int elements) {
  return {[=](double t) { return Eigen::Vector2d(from + t * (to - from)); }, elements};
}

/// From one angle to another [rad], from the direction of z.
inline ProfilePiece profile_arc_piece(Eigen::Vector2d center, double radius, double from, double to, int elements) {
  return {[=](double t) {
            const double angle = from + t * (to - from);
            return Eigen::Vector2d(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
          },
          elements};
}

/// A body of revolution about x: pieces one after another, with z growing; where the next one begins at a smaller or a
/// larger radius there is a shoulder.
struct TurnedBody {
  std::vector<ProfilePiece> pieces;
  int corners = 9;
  double slide = 0;  // how far vertices within pieces slide along the profile, over the length of an element
  double bore = 0;   // radius of a hole through all, 0: none

  [[nodiscard]] double volume() const {
    double volume = 0;
    for (const ProfilePiece& piece : pieces) {
      constexpr int steps = 4000;
      for (int i = 0; i < steps; ++i) {
        const Eigen::Vector2d a = piece.at(static_cast<double>(i) / steps), b = piece.at((i + 1.0) / steps);
        const double cone = (a.y() * a.y() + a.y() * b.y() + b.y() * b.y()) / 3;
        volume += std::numbers::pi * (b.x() - a.x()) * (cone - bore * bore);
      }
    }
    return volume;
  }

  /// finer  number of elements along and around into which every element is cut
  [[nodiscard]] Mesh mesh(unsigned seed, int finer = 1) const;
};

inline Mesh TurnedBody::mesh(unsigned seed, int finer) const {
  struct Ring {
    double inner = 0, outer = 0;  // radii; inner: of the smaller one at a shoulder
    std::size_t piece = 0;
    double t = 0;
    bool slides = false;
  };
  double smallest = HUGE_VAL;
  for (const ProfilePiece& piece : pieces)
    for (int i = 0; i <= 20; ++i) smallest = std::min(smallest, piece.at(i / 20.0).y());
  std::vector<Ring> rings;
  std::vector<bool> is_thick;  // of layers: whether the outer ring of elements is there
  double largest = 0;
  for (const ProfilePiece& piece : pieces) largest = std::max({largest, piece.at(0).y(), piece.at(1).y()});
  const auto jumps = [&](std::size_t p) {
    return p + 1 < pieces.size() && std::abs(pieces[p].at(1).y() - pieces[p + 1].at(0).y()) > 1e-9;
  };
  bool stepped = false;
  for (std::size_t p = 0; p < pieces.size(); ++p) stepped = stepped || jumps(p);
  bool thick = true;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const int count = pieces[p].elements * finer;
    if (p > 0 && jumps(p - 1))
      thick = pieces[p].at(0).y() > pieces[p - 1].at(1).y();
    else if (p == 0 && stepped)
      for (std::size_t q = 0; q < pieces.size(); ++q)
        if (jumps(q)) {
          thick = pieces[q].at(1).y() > pieces[q + 1].at(0).y();
          break;
        }
    for (int i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / count, radius = pieces[p].at(t).y();
      Ring ring{0.55 * smallest + 0.45 * bore, radius, p, t, i > 0};
      if (!thick) ring.inner = radius;
      if (i == 0 && p > 0 && jumps(p - 1)) {
        const double before = pieces[p - 1].at(1).y();
        ring.inner = std::min(before, radius);
        ring.outer = std::max(before, radius);
      }
      rings.push_back(ring);
      is_thick.push_back(thick);
    }
  }
  Ring last{0.55 * smallest + 0.45 * bore, pieces.back().at(1).y(), pieces.size() - 1, 1, false};
  if (!thick) last.inner = last.outer;
  rings.push_back(last);
  const double hole = bore > 0 ? 0.25 : 0;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> real(-1, 1);
  Mesh mesh = layered(disc(corners * finer, 2, hole), static_cast<int>(is_thick.size()), [&](const Vec3& p, double s) {
    const Ring& ring = rings[static_cast<std::size_t>(std::lround(s * static_cast<double>(is_thick.size())))];
    const double place = p.norm(), middle = bore > 0 ? 0.625 : 0.5;
    const bool is_middle = std::abs(place - middle)<1e-6, is_outer = place> 0.99;
    double radius = is_outer ? ring.outer : is_middle ? ring.inner : place > 1e-9 ? bore : 0;
    double z = pieces[ring.piece].at(ring.t).x();
    if (ring.slides && slide > 0 && (is_outer || (is_middle && ring.inner == ring.outer))) {
      const double t = ring.t + slide * real(random) / (pieces[ring.piece].elements * finer);
      z = pieces[ring.piece].at(t).x();
      radius = pieces[ring.piece].at(t).y();
    }
    const double turn = ring.slides ? slide * real(random) / corners : 0;
    const Vec3 direction = place > 1e-9 ? Vec3(p / place) : Vec3(Vec3::Zero());
    return Vec3(z, radius * (std::cos(turn) * direction.x() - std::sin(turn) * direction.y()),
                radius * (std::sin(turn) * direction.x() + std::cos(turn) * direction.y()));
  });
  if (stepped) {  // without the outer ring of elements where the body is thin
    const std::size_t per_layer = mesh.tetrahedra.size() / is_thick.size();
    const Index per_ring = mesh.vertices.rows() / static_cast<Index>(rings.size());
    std::vector<Tetrahedron> kept;
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      const bool outside = std::any_of(mesh.tetrahedra[e].begin(), mesh.tetrahedra[e].end(),
                                       [&](Index v) { return v % per_ring >= per_ring - corners * finer; });
      if (is_thick[e / per_layer] || !outside) kept.push_back(mesh.tetrahedra[e]);
    }
    mesh.tetrahedra = kept;
    mesh.regions[0].tetrahedra.clear();
    for (std::size_t e = 0; e < kept.size(); ++e) mesh.regions[0].tetrahedra.push_back(static_cast<Index>(e));
  }
  return mesh;
}

/// Draws shafts with grooves, beads, notches, fillets and shoulders, hollow and full.
class RandomTurned {
 public:
  explicit RandomTurned(unsigned seed) : random_(seed) {}

  TurnedBody draw() {
    TurnedBody body;
    body.corners = whole(8, 14);
    body.slide = whole(0, 1) * real(0.1, 0.35);
    z_ = 0;
    r_ = 10;
    const int features = whole(1, 2);
    line(body, real(6, 18));
    for (int i = 0; i < features; ++i) {
      feature(body);
      line(body, real(6, 18));
    }
    if (whole(0, 2) == 0) rounded_end(body);
    if (whole(0, 3) == 0) body.bore = real(1, 2);
    return body;
  }

 private:
  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  void line(TurnedBody& body, double length) {
    body.pieces.push_back(profile_line({z_, r_}, {z_ + length, r_}, std::max(1, static_cast<int>(length / 5))));
    z_ += length;
  }

  void feature(TurnedBody& body) {
    switch (stepped_ ? whole(0, 3) : whole(0, 5)) {
      case 0:
        return groove(body, real(3, 5), real(0, 1.5));
      case 1:
        return bead(body);
      case 2:
        return notch(body);
      case 3:
        return bellow(body);
      default:
        return shoulder(body);
    }
  }

  /// An arc around a centre above the surface.
  void groove(TurnedBody& body, double radius, double above) {
    const double angle = std::asin(above / radius);
    const double half = radius * std::cos(angle);
    body.pieces.push_back(profile_arc_piece({z_ + half, r_ + above}, radius, std::numbers::pi + angle,
                                            2 * std::numbers::pi - angle, whole(2, 6)));
    z_ += 2 * half;
  }

  void bead(TurnedBody& body) {
    const double radius = real(3, 6), below = real(0.2, 0.8) * radius,
                 half = std::sqrt(radius * radius - below * below);
    const double angle = std::asin(below / radius);
    body.pieces.push_back(
        profile_arc_piece({z_ + half, r_ - below}, radius, std::numbers::pi - angle, angle, whole(2, 5)));
    z_ += 2 * half;
  }

  void notch(TurnedBody& body) {
    const double width = real(3, 6), depth = real(2, 5);
    const int elements = whole(1, 2);
    body.pieces.push_back(profile_line({z_, r_}, {z_ + width, r_ - depth}, elements));
    body.pieces.push_back(profile_line({z_ + width, r_ - depth}, {z_ + 2 * width, r_}, elements));
    z_ += 2 * width;
  }

  /// Hollow and full arcs in turn, tangent to each other.
  void bellow(TurnedBody& body) {
    const double radius = real(2.5, 4), angle = real(0.5, 0.9);
    const int elements = whole(1, 3), waves = whole(1, 2);
    const double across = radius * std::sin(angle), down = radius * (1 - std::cos(angle));
    const double right = 0.5 * std::numbers::pi;
    for (int i = 0; i < waves; ++i) {
      body.pieces.push_back(profile_arc_piece({z_, r_ - radius}, radius, right, right - angle, elements));
      body.pieces.push_back(profile_arc_piece({z_ + 2 * across, r_ - 2 * down + radius}, radius, 3 * right - angle,
                                              3 * right + angle, 2 * elements));
      body.pieces.push_back(profile_arc_piece({z_ + 4 * across, r_ - radius}, radius, right + angle, right, elements));
      z_ += 4 * across;
    }
  }

  /// A step to a smaller radius, with a hollow fillet.
  void shoulder(TurnedBody& body) {
    stepped_ = true;
    const double fillet = real(1, 2.5), small = real(4.5, 6);
    body.pieces.push_back(profile_arc_piece({z_ + fillet, small + fillet}, fillet, std::numbers::pi,
                                            1.5 * std::numbers::pi, whole(1, 4)));
    z_ += fillet;
    r_ = small;
  }

  void rounded_end(TurnedBody& body) {
    const double fillet = real(1, 3);
    body.pieces.push_back(
        profile_arc_piece({z_, r_ - fillet}, fillet, 0.5 * std::numbers::pi, 0.1 * std::numbers::pi, whole(1, 4)));
  }

  std::mt19937 random_;
  double z_ = 0, r_ = 0;
  bool stepped_ = false;
};

}  // namespace softkin::testing
