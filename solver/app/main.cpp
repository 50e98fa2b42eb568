#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "app/command_line.hpp"
#include "app/commands.hpp"
#include "app/terminal.hpp"
#include "study/checks/memory.hpp"

int main(int argc, char** argv) {
  using namespace extremal::app;
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its limit of size is an error of writing, told with the file
  try {
    const int code = run(argc, argv);
    if (std::fflush(stdout) != 0 || std::ferror(stdout))
      throw OptionError("standard output cannot be written");
    return code;
  } catch (const UsageError& e) {
    print_error(e.what());
    print_help(e.help);
  } catch (const extremal::OutOfMemory& e) {
    print_error(e.what());
  } catch (const std::bad_alloc&) {
    print_error("there is not enough memory");
  } catch (const std::exception& e) {
    print_error(e.what());
  }
  return Exit::refused;
}
