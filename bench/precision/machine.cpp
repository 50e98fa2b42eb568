#include "machine.hpp"

#include <cstdlib>
#include <fstream>
#include <thread>

#include "machine/simd.hpp"

namespace bench {
namespace {

#ifdef __clang__
constexpr const char* compiler = __VERSION__;
#else
constexpr const char* compiler = "g++ " __VERSION__;
#endif

}  // namespace

Machine this_machine() {
  Machine machine{.processor = "unknown",
                  .cores = static_cast<int>(std::thread::hardware_concurrency()),
                  .compiler = compiler,
                  .simd = extremal::name(extremal::simd_level())};
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.starts_with("model name")) {
      machine.processor = line.substr(line.find(':') + 2);
      break;
    }
  if (getloadavg(&machine.load, 1) != 1) machine.load = 0;
  return machine;
}

}  // namespace bench
