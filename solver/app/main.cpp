#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

#include "app/command_line.hpp"
#include "app/commands.hpp"

int main(int argc, char** argv) {
  using namespace extremal::app;
  try {
    const int code = run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw OptionError("standard output cannot be written");
    return code;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "error: there is not enough memory\n");
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
  }
  return Exit::refused;
}
