#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>

#include "report/csv.hpp"
#include "report/file.hpp"
#include "report/json.hpp"
#include "report/oem.hpp"
#include "report/sampling.hpp"
#include "study/phase.hpp"
#include "study/study.hpp"

// A million samples of two coordinates, their velocities and momenta: evaluated, and written as NPZ, CSV,
// JSON and, without momenta, OEM. Seconds that passed and of the processor, in this process and for it, the
// least of several runs.

namespace bench {
namespace {

using namespace extremal;
namespace fs = std::filesystem;

constexpr int count = 1'000'000, runs = 5;

struct Seconds {
  double passed, processor;
};

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Seconds timed(const std::function<void()>& work) {
  using Clock = std::chrono::steady_clock;
  Seconds least{INFINITY, INFINITY};
  for (int run = 0; run < runs; ++run) {
    const double before = processor_seconds();
    const Clock::time_point begin = Clock::now();
    work();
    least.passed = std::min(least.passed, std::chrono::duration<double>(Clock::now() - begin).count());
    least.processor = std::min(least.processor, processor_seconds() - before);
  }
  return least;
}

void report(const char* name, const Seconds& seconds, std::uintmax_t size) {
  fmt::print("{:8} {:6.3f} s passed, {:6.3f} s of the processor, {:5.1f} MB\n", name, seconds.passed,
             seconds.processor, static_cast<double>(size) / 1e6);
}

void measure() {
  const std::string scene = std::string(EXTREMAL_SOURCE_DIR) + "/problems/scenes/kepler.toml";
  const Study study = load(scene, {}, Purpose::solution);
  Solver solver;
  Result result{study.title, coordinate_names(study.problem), solver.solve(study.problem, study.options)};
  const std::vector<double> times = equal_times(count, result.solution.duration());
  report("samples", timed([&] { result.samples = sample(study.problem, result.solution, times); }), 0);
  const fs::path folder = fs::temp_directory_path() / fmt::format("extremal-files-{}", getpid());
  const auto write = [&](const char* name, const std::string& path, const std::function<void()>& work) {
    const Seconds seconds = timed(work);
    report(name, seconds, fs::file_size(path));
  };
  const std::string npz = folder / "r.npz", csv = folder / "r.csv", json = folder / "r.json",
                    oem = folder / "r.oem";
  write("NPZ", npz, [&] { write_files({{npz, npz_text(*result.samples, result.names)}}); });
  write("CSV", csv, [&] { write_csv(csv, *result.samples, result.names); });
  write("JSON", json, [&] { write_json(json, result); });
  const Units units{
      .length = 149'597'870.7, .time = 5'022'642.9, .frame = "ICRF", .centre = "SUN", .epoch = {}};
  write("OEM", oem, [&] {
    write_file(
        oem, [&](std::ostream& out) { write_oem(out, units, result.title, result.names, *result.samples); });
  });
  fs::remove_all(folder);
}

}  // namespace
}  // namespace bench

int main() {
  try {
    bench::measure();
  } catch (const std::exception& e) {
    fmt::print(stderr, "bench_files: {}\n", e.what());
    return 1;
  }
}
