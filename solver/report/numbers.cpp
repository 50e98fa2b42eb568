#include "report/numbers.hpp"

#include <algorithm>
#include <array>
#include <charconv>
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

/// 0.d₁d₂… times 10^(exponent + 1), without zeros at its end.
struct Decimal {
  std::array<char, 2 * most_digits> padded;  ///< as many characters may be read from any digit
  int count = 0;
  int exponent = 0;

  const char* digits() const { return padded.data(); }
};

/// From "d.dde±xx": the shortest digits that are read as the same number.
void fill(double value, Decimal& decimal) {
  char text[32];
  const char* const end = std::to_chars(text, text + sizeof text, value, std::chars_format::scientific).ptr;
  const char* const mark = std::find<const char*>(text, end, 'e');
  char* digit = decimal.padded.data();
  *digit++ = text[0];
  if (text[1] == '.') digit = std::copy(static_cast<const char*>(text + 2), mark, digit);
  decimal.count = static_cast<int>(digit - decimal.padded.data());
  std::from_chars(mark + (mark[1] == '+' ? 2 : 1), end, decimal.exponent);
}

/// Copies more than is asked for: a copy of fixed size is a few instructions.
char* put_digits(const char* from, int count, char* to) {
  std::memcpy(to, from, most_digits);
  return to + count;
}

char* put(std::string_view text, char* to) { return std::copy(text.begin(), text.end(), to); }

char* scientific(const Decimal& decimal, char* to) {
  *to++ = decimal.digits()[0];
  if (decimal.count > 1) {
    *to++ = '.';
    to = put_digits(decimal.digits() + 1, decimal.count - 1, to);
  }
  *to++ = 'e';
  *to++ = decimal.exponent < 0 ? '-' : '+';
  const auto size = static_cast<std::uint32_t>(std::abs(decimal.exponent));
  if (size >= 100) *to++ = static_cast<char>('0' + size / 100);
  put_pair(size % 100, to);
  return to + 2;
}

/// `whole` ends whole numbers.
char* write(double value, std::string_view whole, char* to) {
  if (std::signbit(value)) {
    *to++ = '-';
    value = -value;
  }
  if (value == 0) return put(whole, put("0", to));
  Decimal decimal;
  fill(value, decimal);
  const int e = decimal.exponent, count = decimal.count;
  if (e < least_exponent || e > most_exponent) return scientific(decimal, to);
  if (e < 0) {
    std::memcpy(to, "0.000", 5);
    return put_digits(decimal.digits(), count, to + 1 - e);
  }
  if (count <= e + 1) {
    to = put_digits(decimal.digits(), count, to);
    return put(whole, std::fill_n(to, e + 1 - count, '0'));
  }
  to = put_digits(decimal.digits(), e + 1, to);
  *to++ = '.';
  return put_digits(decimal.digits() + e + 1, count - e - 1, to);
}

}  // namespace

char* write_number(double value, char* to) { return write(value, "", to); }

char* write_real(double value, char* to) { return write(value, ".0", to); }

}  // namespace extremal
