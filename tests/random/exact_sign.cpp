#include "random/exact_sign.hpp"

#include <cmath>
#include <cstdint>

namespace softkin::random_robots {

namespace {

__extension__ using Wide = unsigned __int128;

/// value = whole 2^exponent
struct Parts {
  std::int64_t whole;
  int exponent;
};

Parts parts_of(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return {static_cast<std::int64_t>(std::ldexp(fraction, 53)), exponent - 53};
}

}  // namespace

void ExactSum::add(int factor, double a, double b, double c) {
  if (a == 0 || b == 0 || c == 0) return;
  const Parts x = parts_of(a), y = parts_of(b), z = parts_of(c);
  const bool negative = (factor < 0) != ((x.whole < 0) != ((y.whole < 0) != (z.whole < 0)));
  const auto size = [](std::int64_t whole) { return static_cast<std::uint64_t>(whole < 0 ? -whole : whole); };
  const Wide two = static_cast<Wide>(size(x.whole)) * size(y.whole);
  const std::uint64_t third = size(z.whole) * static_cast<std::uint64_t>(factor < 0 ? -factor : factor);  // < 2^56
  const int place = x.exponent + y.exponent + z.exponent - lowest;
  const int shift = place % word_bits;
  auto word = static_cast<std::size_t>(place / word_bits);
  // the product's words, lowest first, shifted by less than a word
  Wide carry = 0;
  std::uint64_t pending = 0;
  const auto put = [&](std::uint64_t bits) {
    const std::uint64_t shifted = (bits << shift) | pending;
    pending = shifted >> word_bits;
    const auto low = static_cast<std::int64_t>(shifted & 0xFFFFFFFFu);
    words_[word++] += negative ? -low : low;
  };
  for (int i = 0; i < 4; ++i) {
    carry += static_cast<Wide>(static_cast<std::uint32_t>(two >> (32 * i))) * third;
    put(static_cast<std::uint32_t>(carry));
    carry >>= 32;
  }
  for (int i = 0; i < 3; ++i, carry >>= 32) put(static_cast<std::uint32_t>(carry));
}

int ExactSum::sign() {
  std::int64_t carry = 0;
  bool any = false;
  for (std::int64_t& word : words_) {
    const std::int64_t sum = word + carry;
    const std::int64_t low = sum & 0xFFFFFFFF;
    carry = (sum - low) >> word_bits;
    word = low;
    any = any || low != 0;
  }
  words_.back() += carry << word_bits;
  return carry < 0 ? -1 : any || carry > 0 ? 1 : 0;
}

namespace {

/// Adds factor times a . (b x c).
void add_triple(ExactSum& sum, int factor, const Points& p, Index a, Index b, Index c) {
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum.add(factor, p(a, i), p(b, j), p(c, k));
    sum.add(-factor, p(a, i), p(b, k), p(c, j));
  }
}

}  // namespace

int exact_orientation(const Points& positions, const Tetrahedron& t) {
  // the sum over the faces, whose normals point outwards
  ExactSum sum;
  add_triple(sum, 1, positions, t[0], t[2], t[1]);
  add_triple(sum, 1, positions, t[0], t[1], t[3]);
  add_triple(sum, 1, positions, t[1], t[2], t[3]);
  add_triple(sum, 1, positions, t[0], t[3], t[2]);
  return sum.sign();
}

int exact_orientation(const Points& positions, const Prism& p) {
  ExactSum sum;
  add_triple(sum, 2, positions, p[0], p[2], p[1]);
  add_triple(sum, 2, positions, p[3], p[4], p[5]);
  for (int i = 0; i < 3; ++i) {
    // a bilinear side encloses the mean of its two triangulations
    const int j = (i + 1) % 3;
    const Index a = p[i], b = p[j], c = p[j + 3], d = p[i + 3];
    add_triple(sum, 1, positions, a, b, c);
    add_triple(sum, 1, positions, a, c, d);
    add_triple(sum, 1, positions, a, b, d);
    add_triple(sum, 1, positions, b, c, d);
  }
  return sum.sign();
}

}  // namespace softkin::random_robots
