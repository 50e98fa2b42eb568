#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include "scene/source.hpp"
#include "study/inspection.hpp"
#include "study/study.hpp"

/// \file Any bytes as a scene: read, checked, and solved within bounds. An exception that is no refusal of
/// the scene, a number that is not finite, and what the sanitizers find is an error.

namespace {

using namespace extremal;

constexpr int most_steps = 200, most_points = 3, most_solutions = 2;
constexpr double budget = 0.1;  // s
/// Coordinates whose problem is solved, and whose derivatives are checked.
constexpr int most_coordinates = 12;

/// The bytes as a file without a name.
class FileInMemory {
 public:
  FileInMemory(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("scene", 0)) {
    if (descriptor_ < 0 || ::write(descriptor_, data, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~FileInMemory() { ::close(descriptor_); }
  FileInMemory(const FileInMemory&) = delete;
  FileInMemory& operator=(const FileInMemory&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "error: %s\n", what);
  std::abort();
}

void check(const Solution& solution) {
  require(!solution.message.empty(), "a solution without a message");
  require(solution.message.find("inf") != 0, "a message that begins with inf");
  if (!solution.converged()) return;
  require(std::isfinite(solution.action), "the action is not finite");
  require(std::isfinite(solution.error_estimate), "the error estimate is not finite");
  require(solution.duration() > 0, "the duration is not positive");
  require(std::ranges::all_of(solution.trajectory.nodes, [](double q) { return std::isfinite(q); }),
          "a node is not finite");
}

void solve(Study study) {
  study.options.max_iterations = std::min(study.options.max_iterations, most_steps);
  study.solutions = std::min(study.solutions, most_solutions);
  if (study.continuation) {
    study.continuation->points = std::min(study.continuation->points, most_points);
    for (const BranchPoint& point : follow(study).points)
      require(std::isfinite(point.parameter), "a point of a branch is not finite");
  } else if (study.solutions > 0) {
    for (const Solution& solution : run_all(study)) check(solution);
  } else {
    check(run(study));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const FileInMemory file(data, size);
  try {
    Study study = load(file.path(), {"solve.budget=" + std::to_string(budget)});
    if (study.problem.coordinates() > most_coordinates) return 0;
    inspect(study);
    solve(std::move(study));
  } catch (const SceneError&) {      // refused
  } catch (const std::bad_alloc&) {  // more memory than this process may take
  }
  return 0;
}
