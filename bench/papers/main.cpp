#include <fmt/format.h>

#include <exception>
#include <filesystem>

#include "common.hpp"
#include "report/plot.hpp"

/// \file Figures of what Müller and Ortiz prove and of times as Chen, Guo and Wu have them, written to
/// bench/papers or the folder that is named.

int main(int argc, char** argv) {
  using namespace extremal;
  const std::filesystem::path folder =
      argc > 1 ? argv[1] : std::filesystem::path(EXTREMAL_SOURCE_DIR) / "bench/papers";
  try {
    std::filesystem::create_directories(folder);
    const std::pair<const char*, Figure (*)()> figures[] = {{"lines", papers::frequencies_and_amplitudes},
                                                            {"spectra", papers::convergence_of_spectra},
                                                            {"velocities", papers::convergence_of_velocities},
                                                            {"windows", papers::windows},
                                                            {"free_times", papers::free_times},
                                                            {"wave_trains", papers::wave_trains}};
    for (const auto& [name, figure] : figures) {
      const std::string path = (folder / name).string() + ".svg";
      write_plot(path, figure());
      fmt::print("{}\n", path);
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
