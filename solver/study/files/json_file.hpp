#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "scene/source.hpp"

/// \file Results and other files in JSON.

namespace extremal {

/// Throws SceneError with the place from which on the text is no JSON, and with `mend`.
nlohmann::json parse_json(const std::shared_ptr<const Source>& source, std::string_view mend);

}  // namespace extremal
