#include "report/numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace extremal {
namespace {

constexpr int most_digits = 17;
constexpr int least_exponent = -4, most_exponent = 15;  ///< of numbers without an exponent

/// "00", "01", … "99".
constexpr std::array<char, 200> make_pairs() {
  std::array<char, 200> pairs{};
  for (int k = 0; k < 100; ++k) {
    pairs[2 * k] = static_cast<char>('0' + k / 10);
    pairs[2 * k + 1] = static_cast<char>('0' + k % 10);
  }
  return pairs;
}
constexpr std::array<char, 200> pairs = make_pairs();

void put_pair(std::uint32_t value, char* to) { std::memcpy(to, &pairs[2 * value], 2); }

/// 1, 10, … 10¹⁶.
constexpr std::array<std::uint64_t, most_digits> make_powers() {
  std::array<std::uint64_t, most_digits> powers{1};
  for (int k = 1; k < most_digits; ++k) powers[k] = 10 * powers[k - 1];
  return powers;
}
constexpr std::array<std::uint64_t, most_digits> powers = make_powers();

/// Of a number from 1 on: log₁₀ 2 from below, times its bits, is that or one less.
int digits_of(std::uint64_t value) {
  const int least = std::bit_width(value) * 1233 >> 12;
  return least + (least < most_digits && value >= powers[least] ? 1 : 0);
}

void put_eight(std::uint32_t value, char* to) {
  const std::uint32_t first = value / 10'000, last = value % 10'000;
  put_pair(first / 100, to);
  put_pair(first % 100, to + 2);
  put_pair(last / 100, to + 4);
  put_pair(last % 100, to + 6);
}

/// d₁.d₂d₃… times 10^exponent, `count` digits of which are written and zeros follow.
struct Decimal {
  std::uint64_t digits;  ///< most_digits of them, whatever the number: no branch depends on how many count
  int count, exponent;
};

/// The fewest digits that are read as the same number: those that fmt finds before it writes them.
Decimal shortest(double value) {
  const auto [whole, exponent] = fmt::detail::dragonbox::to_decimal(value);
  const int count = digits_of(whole);
  return {whole * powers[most_digits - count], count, exponent + count - 1};
}

/// All digits.
void put(const Decimal& decimal, char* to) {
  constexpr std::uint64_t eight = 100'000'000;
  const std::uint64_t front = decimal.digits / eight;
  *to = static_cast<char>('0' + front / eight);
  put_eight(static_cast<std::uint32_t>(front % eight), to + 1);
  put_eight(static_cast<std::uint32_t>(decimal.digits % eight), to + 9);
}

/// With a point behind so many digits.
char* put_fraction(const Decimal& decimal, int before, char* to) {
  put(decimal, to + 1);
  for (int k = 0; k < before; ++k) to[k] = to[k + 1];
  to[before] = '.';
  return to + decimal.count + 1;
}

char* put(std::string_view text, char* to) { return std::copy(text.begin(), text.end(), to); }

char* scientific(const Decimal& decimal, char* to) {
  char* const end = put_fraction(decimal, 1, to);
  to = decimal.count > 1 ? end : to + 1;
  *to++ = 'e';
  *to++ = decimal.exponent < 0 ? '-' : '+';
  const auto size = static_cast<std::uint32_t>(std::abs(decimal.exponent));
  if (size >= 100) *to++ = static_cast<char>('0' + size / 100);
  put_pair(size % 100, to);
  return to + 2;
}

/// `whole` ends whole numbers.
char* write(double value, std::string_view whole, char* to) {
  *to = '-';
  to += std::signbit(value);
  value = std::abs(value);
  if (value == 0) return put(whole, put("0", to));
  const Decimal decimal = shortest(value);
  const int e = decimal.exponent;
  if (e < least_exponent || e > most_exponent) return scientific(decimal, to);
  if (e < 0) {
    std::memcpy(to, "0.000", 5);
    put(decimal, to + 1 - e);
    return to + 1 - e + decimal.count;
  }
  if (decimal.count > e + 1) return put_fraction(decimal, e + 1, to);
  put(decimal, to);
  return put(whole, to + e + 1);
}

}  // namespace

char* write_number(double value, char* to) { return write(value, "", to); }

char* write_real(double value, char* to) { return write(value, ".0", to); }

}  // namespace extremal
