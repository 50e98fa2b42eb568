#include "app/outputs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "app/commands.hpp"
#include "report/file.hpp"
#include "report/gnuplot.hpp"
#include "report/plot.hpp"

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
  if (!fs::exists(place, error)) {
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
    require_gnuplot();
  } catch (const std::exception& e) {
    return e.what();
  }
  return output_refusal(path);
}

bool on_standard_output(const std::string& output, const std::string& csv) {
  if (output == standard_output && csv == standard_output)
    throw OptionError("--output - and --csv - exclude each other: there is one standard output");
  return output == standard_output || csv == standard_output;
}

void write_output(const std::string& path, const std::function<void(std::ostream&)>& write) {
  if (path != standard_output) return write_file(path, write);
  write(std::cout);
  if (!std::cout.flush()) throw std::runtime_error("standard output cannot be written");
}

}  // namespace extremal::app
