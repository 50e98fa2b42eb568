#include "app/terminal.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "report/text.hpp"

namespace extremal::app {
namespace {

constexpr std::size_t longest_error = 4000;  // characters
constexpr const char* erase_line = "\r\x1b[K";

void put(std::FILE* stream, const std::string& text) { std::fwrite(text.data(), 1, text.size(), stream); }

/// The text up to so many characters.
std::string shortened(const std::string& text, std::size_t characters) {
  std::size_t count = 0, k = 0;
  for (; k < text.size(); ++k)
    if ((static_cast<unsigned char>(text[k]) & 0xC0) != 0x80 && count++ == characters) break;
  return k < text.size() ? text.substr(0, k) + "…" : text;
}

}  // namespace

void print(const std::string& text) { put(stdout, visible(text, true)); }

void print_error(const std::string& message) {
  put(stderr, "error: " + shortened(visible(message, false), longest_error) + "\n");
}

void print_help(const std::string& text) { put(stderr, visible(text, true) + "\n"); }

ProgressLine::ProgressLine(bool wanted) : shown_(wanted && ::isatty(STDERR_FILENO)) {}

ProgressLine::~ProgressLine() {
  if (shown_) put(stderr, erase_line);
}

void ProgressLine::show(const std::string& text) {
  put(stderr, erase_line + visible(text, false));
  std::fflush(stderr);
}

}  // namespace extremal::app
