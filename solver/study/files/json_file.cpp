#include "study/files/json_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace extremal {
namespace {

/// Of the byte, counted from 1.
Location place_of(const std::shared_ptr<const Source>& source, std::size_t byte) {
  const std::string_view before =
      std::string_view(source->text)
          .substr(0, std::min(std::max<std::size_t>(byte, 1) - 1, source->text.size()));
  const auto begins_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
  const std::size_t line = before.rfind('\n') + 1;  // 0 where there is none
  return {source, 1 + static_cast<int>(std::ranges::count(before, '\n')),
          1 + static_cast<int>(std::ranges::count_if(before.substr(line), begins_character))};
}

}  // namespace

nlohmann::json parse_json(const std::shared_ptr<const Source>& source, std::string_view mend) {
  try {
    return nlohmann::json::parse(source->text);
  } catch (const nlohmann::json::parse_error& e) {
    throw SceneError(place_of(source, e.byte), fmt::format("from here on this is not JSON; {}", mend));
  }
}

}  // namespace extremal
