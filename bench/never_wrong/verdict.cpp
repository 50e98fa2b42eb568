#include "verdict.hpp"

#include <nlohmann/json.hpp>

namespace bench {
namespace {

using Json = nlohmann::ordered_json;

template <class Value>
void put(Json& json, const char* key, const std::optional<Value>& value) {
  if (value) json[key] = *value;
}

void get(const Json& json, const char* key, std::optional<double>& value) {
  if (json.contains(key) && json[key].is_number()) value = json[key].get<double>();
}

}  // namespace

std::string to_line(const Verdict& v) {
  Json json{{"seed", v.seed},         {"index", v.index},       {"system", v.scene.system},
            {"kind", v.scene.kind},   {"known", v.scene.known}, {"text", v.scene.text},
            {"status", v.status},     {"message", v.message},   {"tolerance", v.tolerance},
            {"seconds", v.seconds},   {"residual", v.residual}, {"referred", v.referred},
            {"faults", Json::array()}};
  for (const Fault& fault : v.faults) json["faults"].push_back({fault.kind, fault.detail});
  put(json, "error", v.error);
  put(json, "estimate_over", v.estimate_over);
  put(json, "velocity", v.velocity);
  put(json, "momentum", v.momentum);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Verdict from_line(const std::string& line) {
  const Json json = Json::parse(line);
  Verdict v{.seed = json.at("seed"),
            .index = json.at("index"),
            .scene = {json.at("system"), json.at("kind"), json.at("known"), json.at("text")},
            .status = json.at("status"),
            .message = json.at("message"),
            .tolerance = json.at("tolerance"),
            .residual = json.at("residual").is_number() ? json.at("residual").get<double>() : -1,
            .seconds = json.at("seconds"),
            .referred = json.at("referred")};
  for (const Json& fault : json.at("faults")) v.faults.push_back({fault.at(0), fault.at(1)});
  get(json, "error", v.error);
  get(json, "estimate_over", v.estimate_over);
  get(json, "velocity", v.velocity);
  get(json, "momentum", v.momentum);
  return v;
}

}  // namespace bench
