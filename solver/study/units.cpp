#include "study/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

namespace extremal {
namespace {

namespace chrono = std::chrono;

constexpr int first_year = 1700, last_year = 2200;  // nanoseconds of 64 bits reach a little further

/// So many digits at the front, which are taken off.
std::optional<int> digits(std::string_view& text, std::size_t count) {
  if (text.size() < count) return std::nullopt;
  int value = 0;
  for (const char c : text.substr(0, count)) {
    if (!std::isdigit(static_cast<unsigned char>(c))) return std::nullopt;
    value = 10 * value + (c - '0');
  }
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, char c) {
  if (!text.starts_with(c)) return false;
  text.remove_prefix(1);
  return true;
}

/// The digits behind the point of a second; nine are kept.
std::optional<chrono::nanoseconds> fraction(std::string_view& text) {
  long long value = 0;
  std::size_t count = 0;
  for (; count < text.size() && std::isdigit(static_cast<unsigned char>(text[count])); ++count)
    if (count < 9) value = 10 * value + (text[count] - '0');
  if (count == 0) return std::nullopt;
  text.remove_prefix(count);
  for (; count < 9; ++count) value *= 10;
  return chrono::nanoseconds(value);
}

std::optional<Epoch> parse(std::string_view text) {
  const auto y = digits(text, 4);
  if (!y || !take(text, '-')) return std::nullopt;
  const auto m = digits(text, 2);
  if (!m || !take(text, '-')) return std::nullopt;
  const auto d = digits(text, 2);
  const chrono::year_month_day date{chrono::year(*y), chrono::month(m.value_or(0)),
                                    chrono::day(d.value_or(0))};
  if (!d || !date.ok() || *y < first_year || *y > last_year) return std::nullopt;
  Epoch epoch = chrono::sys_days(date);
  if (text.empty()) return epoch;
  if (!take(text, 'T')) return std::nullopt;
  const auto h = digits(text, 2);
  if (!h || *h > 23 || !take(text, ':')) return std::nullopt;
  const auto min = digits(text, 2);
  if (!min || *min > 59 || !take(text, ':')) return std::nullopt;
  const auto s = digits(text, 2);
  if (!s || *s > 59) return std::nullopt;
  epoch += chrono::hours(*h) + chrono::minutes(*min) + chrono::seconds(*s);
  if (take(text, '.')) {
    const auto part = fraction(text);
    if (!part) return std::nullopt;
    epoch += *part;
  }
  return text.empty() ? std::optional(epoch) : std::nullopt;
}

template <class Entry>
const Entry& needed(const std::optional<Entry>& entry, const UnitsTable& table, const char* key,
                    const char* what) {
  if (!entry) throw SceneError(table.at, fmt::format("[units] has no '{}'; give {}", key, what));
  return *entry;
}

double positive(const Number& number, const char* key) {
  if (!(number.value > 0))
    throw SceneError(number.at, fmt::format("{} = {}; need more than 0", key, number.value));
  return number.value;
}

std::string one_line(const Text& text, const char* key) {
  const bool printable =
      std::all_of(text.value.begin(), text.value.end(), [](char c) { return c >= ' ' && c <= '~'; });
  if (text.value.empty() || !printable)
    throw SceneError(position(text, 0), fmt::format("'{}' must be one line of ASCII characters", key));
  return text.value;
}

}  // namespace

Units read_units(const UnitsTable& table) {
  Units units;
  units.length = positive(needed(table.length, table, "length", "the unit of length in km"), "length");
  units.time = positive(needed(table.time, table, "time", "the unit of time in s"), "time");
  units.frame = one_line(needed(table.frame, table, "frame", "the frame of reference, as \"ICRF\""), "frame");
  units.centre = one_line(needed(table.centre, table, "centre", "the origin, as \"EARTH\""), "centre");
  const Text& text = needed(table.epoch, table, "epoch", "the date of t = 0, as \"2025-01-31T12:00:00\"");
  const std::optional<Epoch> epoch = parse(text.value);
  if (!epoch)
    throw SceneError(position(text, 0),
                     fmt::format("'{}' is no date from {} to {}; write it as \"2025-01-31T12:00:00\"",
                                 text.value, first_year, last_year));
  units.epoch = *epoch;
  return units;
}

char* write_epoch(Epoch epoch, char* to) {
  const auto put = [&to](long long value, int count, char behind) {
    for (int k = count; k-- > 0; value /= 10) to[k] = static_cast<char>('0' + value % 10);
    to[count] = behind;
    to += count + 1;
  };
  const auto date = chrono::floor<chrono::days>(epoch);
  const chrono::year_month_day day(date);
  const chrono::hh_mm_ss time(epoch - date);
  put(static_cast<int>(day.year()), 4, '-');
  put(static_cast<unsigned>(day.month()), 2, '-');
  put(static_cast<unsigned>(day.day()), 2, 'T');
  put(time.hours().count(), 2, ':');
  put(time.minutes().count(), 2, ':');
  put(time.seconds().count(), 2, '.');
  put(time.subseconds().count(), 9, ' ');
  return to - 1;
}

std::string epoch_text(Epoch epoch) {
  char text[epoch_size];
  return {text, write_epoch(epoch, text)};
}

}  // namespace extremal
