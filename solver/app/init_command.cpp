#include <fmt/format.h>

#include <filesystem>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/terminal.hpp"
#include "report/outline.hpp"
#include "report/text.hpp"

namespace extremal::app {

int init(const InitArguments& a) {
  const SystemDescription system = describe(a.system, "extremal init");
  const std::string path = a.output.empty() ? system.name + ".toml" : a.output;
  std::error_code error;
  if (path != "-" && std::filesystem::exists(path, error))
    throw OptionError(fmt::format("'{}' is there already; name another file with --output", path));
  if (const std::string refusal = output_refusal(path); !refusal.empty()) throw OptionError(refusal);
  Outputs::write({{path, commented_scene(system)}});
  if (path != "-") print(fmt::format("{}\n", visible(path, false)));
  return Exit::done;
}

}  // namespace extremal::app
