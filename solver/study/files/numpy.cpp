#include "study/files/numpy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "study/files/archive.hpp"

namespace extremal {
namespace {

constexpr std::string_view magic = "\x93NUMPY";
constexpr std::string_view suffix = ".npy";
constexpr std::size_t alignment = 64;  ///< of the values in a file

/// What follows "'key':" in the literal that heads a file.
std::string_view entry(std::string_view header, std::string_view key) {
  const std::string quoted = fmt::format("'{}':", key);
  const std::size_t at = header.find(quoted);
  if (at == std::string_view::npos) throw std::runtime_error(fmt::format("its header has no '{}'", key));
  header.remove_prefix(at + quoted.size());
  header.remove_prefix(std::min(header.find_first_not_of(' '), header.size()));
  return header;
}

std::vector<std::size_t> shape_of(std::string_view text) {
  if (!text.starts_with('(')) throw std::runtime_error("its shape is damaged");
  std::vector<std::size_t> shape;
  const std::string_view inside = text.substr(1, text.find(')') - 1);
  for (std::size_t at = 0; at < inside.size();) {
    at = inside.find_first_of("0123456789", at);
    if (at == std::string_view::npos) break;
    std::size_t length = 0;
    const auto [stop, error] = std::from_chars(inside.data() + at, inside.data() + inside.size(), length);
    if (error != std::errc()) throw std::runtime_error("its shape is damaged");
    shape.push_back(length);
    at = stop - inside.data();
  }
  return shape;
}

template <class Number>
void convert(std::string_view bytes, std::vector<double>& values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    Number x;
    std::memcpy(&x, bytes.data() + k * sizeof(Number), sizeof(Number));
    values[k] = static_cast<double>(x);
  }
}

/// Values whose first index runs fastest, with the last running fastest.
void transpose(NumpyArray& array) {
  const std::vector<double> columns = array.values;
  std::vector<std::size_t> index(array.shape.size(), 0);
  for (double& value : array.values) {
    std::size_t at = 0;
    for (std::size_t d = index.size(); d-- > 0;) at = at * array.shape[d] + index[d];
    value = columns[at];
    for (std::size_t d = index.size(); d-- > 0;) {
      if (++index[d] < array.shape[d]) break;
      index[d] = 0;
    }
  }
}

/// What stands before the values: magic, version 1.0, the length of the literal, the literal.
std::string header_of(std::size_t count) {
  std::string literal = fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", count);
  constexpr std::size_t before = magic.size() + 4;
  literal.append(alignment - (before + literal.size() + 1) % alignment, ' ');
  literal += '\n';
  std::string header(magic);
  header += {'\1', '\0', static_cast<char>(literal.size() & 0xff), static_cast<char>(literal.size() >> 8)};
  return header + literal;
}

}  // namespace

NumpyArray read_npy(std::string_view bytes) {
  static_assert(std::endian::native == std::endian::little);
  const auto byte = [&](std::size_t k) {
    return static_cast<std::size_t>(static_cast<unsigned char>(bytes[k]));
  };
  if (!bytes.starts_with(magic) || bytes.size() < 12) throw std::runtime_error("this is no array of NumPy");
  const bool long_header = byte(6) >= 2;
  const std::size_t before = long_header ? 12 : 10;
  std::size_t length = byte(8) | byte(9) << 8;
  if (long_header) length |= byte(10) << 16 | byte(11) << 24;
  if (length > bytes.size() - before) throw std::runtime_error("its header is cut off");
  const std::string_view header = bytes.substr(before, length);
  bytes.remove_prefix(before + length);

  NumpyArray array;
  array.shape = shape_of(entry(header, "shape"));
  const std::string_view quoted = entry(header, "descr");
  if (!quoted.starts_with('\'')) throw std::runtime_error("it has values that are no plain numbers");
  const std::string type(quoted.substr(1, quoted.find('\'', 1) - 1));
  const bool known = type == "<f8" || type == "<f4" || type == "<i8" || type == "<i4";
  if (!known)
    throw std::runtime_error(fmt::format(
        "it has values of type '{}'; save real numbers of 8 bytes, as array.astype('<f8') gives", type));
  const std::size_t size = type[2] - '0';
  std::size_t count = 1;
  for (const std::size_t length_of_axis : array.shape)
    if (__builtin_mul_overflow(count, length_of_axis, &count)) count = bytes.size();
  if (count > bytes.size() / size || count * size != bytes.size())
    throw std::runtime_error(
        fmt::format("it has {} bytes of values, which its shape contradicts", bytes.size()));
  array.values.resize(count);
  if (type == "<f8") convert<double>(bytes, array.values);
  if (type == "<f4") convert<float>(bytes, array.values);
  if (type == "<i8") convert<std::int64_t>(bytes, array.values);
  if (type == "<i4") convert<std::int32_t>(bytes, array.values);
  if (entry(header, "fortran_order").starts_with("True")) transpose(array);
  return array;
}

std::map<std::string, NumpyArray> read_npz(std::string_view bytes, std::size_t most) {
  std::map<std::string, NumpyArray> arrays;
  for (const auto& [name, content] : extract(bytes, most)) {
    if (!name.ends_with(suffix)) continue;
    const std::string key = name.substr(0, name.size() - suffix.size());
    try {
      arrays.emplace(key, read_npy(content));
    } catch (const std::runtime_error& e) {
      throw std::runtime_error(fmt::format("'{}': {}", key, e.what()));
    }
  }
  return arrays;
}

std::string npz(const std::vector<std::pair<std::string, std::span<const double>>>& arrays) {
  std::vector<ArchiveMember> members;
  for (const auto& [name, values] : arrays)
    members.push_back({name + std::string(suffix),
                       header_of(values.size()),
                       {reinterpret_cast<const char*>(values.data()), values.size_bytes()}});
  return archive(members);
}

}  // namespace extremal
