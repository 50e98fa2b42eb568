#include "app/outputs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "app/commands.hpp"
#include "report/gnuplot.hpp"
#include "report/page.hpp"
#include "report/plot.hpp"
#include "report/text.hpp"

namespace extremal::app {
namespace fs = std::filesystem;
namespace {

constexpr const char* standard_output = "-";

}  // namespace

std::string output_refusal(const std::string& path) {
  if (path == standard_output) return "";
  if (path.empty()) return "the name of the file is empty";
  std::error_code error;
  fs::path place = path;
  if (fs::is_directory(place, error)) return fmt::format("'{}' is a folder; a file is needed", path);
  if (!place.has_filename()) return fmt::format("'{}' names a folder; a file is needed", path);
  const bool there = fs::exists(place, error);
  if (error && error != std::errc::no_such_file_or_directory && error != std::errc::not_a_directory)
    return fmt::format("'{}' cannot be written: {}", path, error.message());
  if (!there) {
    do place = place.has_parent_path() ? place.parent_path() : fs::path(".");
    while (!fs::exists(place, error));
    if (!fs::is_directory(place, error)) return fmt::format("'{}' is not a folder", place.string());
  }
  if (::access(place.c_str(), W_OK) == 0) return "";
  return fmt::format("'{}' cannot be written: {}", place.string(), std::strerror(errno));
}

std::string plot_refusal(const std::string& path) {
  try {
    check_plot_path(path);
    if (!is_page(path)) require_gnuplot();
  } catch (const std::exception& e) {
    return e.what();
  }
  return output_refusal(path);
}

Outputs::Outputs(std::vector<OutputOption> options) : options_(std::move(options)) {
  std::erase_if(options_, [](const OutputOption& option) { return option.path.empty(); });
  for (auto b = options_.begin(); b != options_.end(); ++b)
    for (auto a = options_.begin(); a != b; ++a) {
      if (a->path == standard_output && b->path == standard_output)
        throw OptionError(
            fmt::format("{} - and {} - exclude each other: there is one standard output", a->name, b->name));
      if (same_file(a->path, b->path))
        throw OptionError(
            fmt::format("{} and {} name one file, '{}'; each needs its own", a->name, b->name, b->path));
    }
}

bool Outputs::on_standard_output() const {
  return std::any_of(options_.begin(), options_.end(),
                     [](const OutputOption& option) { return option.path == standard_output; });
}

void Outputs::keep(const std::vector<std::string>& files) const {
  for (const OutputOption& option : options_)
    for (const std::string& file : files)
      if (same_file(option.path, file))
        throw OptionError(
            fmt::format("{} '{}' would replace '{}', from which the scene is read; name another file",
                        option.name, option.path, file));
}

void Outputs::write(std::vector<FileContent> files) {
  for (FileContent& file : files)
    if (file.path == standard_output) {
      if (file.write) file.content += text_of(std::exchange(file.write, {}));
      file.content = visible(file.content, true);
    }
  write_files(files);
}

}  // namespace extremal::app
