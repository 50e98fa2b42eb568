#pragma once

#include <string>
#include <vector>

#include "report/file.hpp"

/// \file Where results go: a file, or standard output for the path "-".

namespace extremal::app {

/// Why a path cannot be written; "" where nothing speaks against it. Missing folders are made when the file
/// is written, so the nearest folder that exists counts.
std::string output_refusal(const std::string& path);

/// The same for a plot: a page, or one whose suffix gnuplot can draw, and gnuplot must be there.
std::string plot_refusal(const std::string& path);

/// An option that names a file, and the path; empty where it is not wanted.
struct OutputOption {
  const char* name;
  std::string path;
};

/// The outputs of a command.
class Outputs {
 public:
  /// Throws OptionError where two name one file, or both standard output.
  explicit Outputs(std::vector<OutputOption> options);

  /// Whether one of them is standard output: nothing else is printed there then.
  bool on_standard_output() const;
  /// Throws OptionError where one of them is one of these files.
  void keep(const std::vector<std::string>& files) const;

  /// Writes all of these or none. Throws std::runtime_error if one cannot be written.
  static void write(std::vector<FileContent> files);

 private:
  std::vector<OutputOption> options_;
};

}  // namespace extremal::app
