#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>

#include "report/page_data.hpp"
#include "report/solutions.hpp"

namespace extremal {

namespace {

/// Of all columns of a page, times counted twice: about 530 kB of text.
constexpr std::size_t most_values = 100'000;

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < 3; ++i) word = word << 8 | (i < count ? bytes[k + i] : 0u);
    for (std::size_t i = 0; i < 4; ++i) text += i <= count ? digits[word >> (18 - 6 * i) & 63] : '=';
  }
  return text;
}

/// Bytes of numbers, the lowest first.
template <class Bits, class Number>
std::string encoded(const std::vector<Number>& values) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(values.size() * sizeof(Bits));
  for (const Number value : values) {
    const auto bits = std::bit_cast<Bits>(value);
    for (std::size_t i = 0; i < sizeof(Bits); ++i) bytes.push_back(bits >> 8 * i & 255);
  }
  return base64(bytes);
}

/// A column to single precision of its own range: value = centre + reach * number.
PageData column_data(const Column& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double centre = std::midpoint(*low, *high), reach = *high / 2 - *low / 2;
  std::vector<float> numbers;
  numbers.reserve(values.size());
  for (const double value : values)
    numbers.push_back(reach > 0 ? static_cast<float>((value - centre) / reach) : 0.0F);
  return {{"centre", centre}, {"reach", reach}, {"numbers", encoded<std::uint32_t>(numbers)}};
}

/// Every so many samples, and the last.
Column thinned(const Column& values, std::size_t stride) {
  Column kept;
  for (std::size_t k = 0; k + 1 < values.size(); k += stride) kept.push_back(values[k]);
  kept.push_back(values.back());
  return kept;
}

}  // namespace

std::size_t page_stride(const Picture& picture) {
  std::size_t values = 0;
  for (const Samples* samples : solutions_of(picture))
    values += samples->count() * (2 + samples->q.size() + samples->v.size());
  return (values + most_values - 1) / most_values;
}

PageData page_columns(const Samples& samples, const std::vector<const Column*>& forces, std::size_t stride) {
  PageData columns = PageData::array();
  for (const auto* part : {&samples.q, &samples.v})
    for (const Column& values : *part) columns.push_back(column_data(thinned(values, stride)));
  for (const Column* values : forces) columns.push_back(column_data(thinned(*values, stride)));
  return {{"t", encoded<std::uint64_t>(thinned(samples.t, stride))}, {"columns", std::move(columns)}};
}

}  // namespace extremal
