#include "command.hpp"

#include <cstdio>

namespace bench {

std::string quoted(const std::string& word) {
  std::string result = "'";
  for (char c : word) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string output_of(const std::string& command, int& exit) {
  std::string text;
  exit = -1;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return text;
  char block[4096];
  for (std::size_t count; (count = std::fread(block, 1, sizeof block, pipe)) > 0;) text.append(block, count);
  exit = pclose(pipe);
  return text;
}

}  // namespace bench
