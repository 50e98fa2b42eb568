#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "app/commands.hpp"
#include "app/outputs.hpp"
#include "app/terminal.hpp"
#include "report/page.hpp"
#include "report/text.hpp"

namespace extremal::app {
namespace {

std::string text_in(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) throw OptionError(fmt::format("'{}' cannot be read", path));
  return text;
}

/// Beside the result.
std::string page_name(const ViewArguments& a) {
  if (!a.output.empty()) return a.output;
  return std::filesystem::path(a.result).replace_extension(".html").string();
}

}  // namespace

int view(const ViewArguments& a) {
  const std::string path = page_name(a);
  const Outputs outputs({{"--output", path}});
  if (same_file(a.result, path))
    throw OptionError(fmt::format("the page would replace '{}', the result; name another file", a.result));
  if (const std::string refusal = output_refusal(path); !refusal.empty()) throw OptionError(refusal);
  const std::string page = saved_page(text_in(a.result), a.result);
  Outputs::write({{path, page}});
  if (!outputs.on_standard_output()) print(visible(path, false) + "\n");
  return Exit::done;
}

}  // namespace extremal::app
