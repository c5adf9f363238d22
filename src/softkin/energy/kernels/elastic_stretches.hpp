#pragma once

#include <softkin/energy/kernels/elastic_law_point.hpp>

namespace softkin::energy::SOFTKIN_TARGET {

/// Principal stretches l_i of a deformation without inversion, with ln bar l_i = ln l_i - ln(l_1 l_2 l_3) / 3.
struct Stretches {
  Pack value[3];
  Pack log_barred[3];
};

/// Of what may also be below 0: stretches that no element survives are taken as 1e-8, so that all stays finite.
inline Stretches stretches_of(const Pack (&l)[3]) {
  Stretches s;
  for (int i = 0; i < 3; ++i) {
    s.value[i] = max(l[i], pack(1e-8));
    s.log_barred[i] = log(s.value[i]);
  }
  const Pack mean = (1.0 / 3) * (s.log_barred[0] + s.log_barred[1] + s.log_barred[2]);
  for (Pack& each : s.log_barred) each -= mean;
  return s;
}

/// One term of Ogden's law at some stretches: mu, alpha, and bar l_i^alpha.
struct OgdenPowers {
  Pack mu, alpha;
  Pack power[3];
  Pack mean;  // of the powers

  OgdenPowers(const LawBlock& law, int term, const Stretches& s)
      : mu(law.*OgdenPlaces<Pack>::mu[term]), alpha(law.*OgdenPlaces<Pack>::alpha[term]) {
    constexpr double largest = 150;  // of an exponent that is still a state of a body
    for (int i = 0; i < 3; ++i)
      power[i] = each_lane(min(max(alpha * s.log_barred[i], pack(-largest)), pack(largest)),
                           [](double x) { return __builtin_exp(x); });
    mean = (1.0 / 3) * (power[0] + power[1] + power[2]);
  }

  [[nodiscard]] Pack energy() const { return 3 * mu * (mean - 1) / select(alpha == 0, pack(1), alpha); }
};

/// Has a lane such a term?
inline bool has_term(const LawBlock& law, int term) {
  return any(~(law.*OgdenPlaces<Pack>::alpha[term] == 0));
}

/// W of the change of shape [MPa] and l_i dW/dl_i.
struct OgdenEnergy {
  Pack energy{};
  Pack pull[3]{};
};

inline OgdenEnergy ogden_energy(const LawBlock& law, const Stretches& s) {
  OgdenEnergy w;
  for (int term = 0; term < max_ogden_terms; ++term) {
    if (!has_term(law, term)) continue;
    const OgdenPowers p(law, term, s);
    w.energy += p.energy();
    for (int i = 0; i < 3; ++i) w.pull[i] += p.mu * (p.power[i] - p.mean);
  }
  return w;
}

/// (a^b - c^b) / (a - c) / (a c)^((b - 1) / 2) = sinh(b h) / sinh(h), h = ln(a / c) / 2: exact to rounding where a and
/// c coincide, since it depends on the square of h alone.
inline double sinh_ratio(double b, double h) {
  if (h * h < 1e-10) return b * (1 + (b * b - 1) * h * h / 6);
  return __builtin_sinh(b * h) / __builtin_sinh(h);
}

/// Divided difference of bar l^alpha / l over two stretches of a term.
inline Pack divided_difference(const OgdenPowers& p, const Stretches& s, int i, int j) {
  constexpr double close = 0.5;  // in ln l: farther apart differences lose no digits, and sinh would grow large
  const Pack half = 0.5 * (s.log_barred[i] - s.log_barred[j]);
  const Pack plain = (p.power[i] / s.value[i] - p.power[j] / s.value[j]) /
                     select(s.value[i] == s.value[j], pack(1), s.value[i] - s.value[j]);
  const Pack scale = sqrt(p.power[i] * p.power[j]) / (s.value[i] * s.value[j]);
  Pack result;
  for (int lane = 0; lane < lanes; ++lane) {
    const double h = half[lane];
    result[lane] = h * h < close * close ? scale[lane] * sinh_ratio(p.alpha[lane] - 1, h) : plain[lane];
  }
  return result;
}

}  // namespace softkin::energy::SOFTKIN_TARGET
