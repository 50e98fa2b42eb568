#include <fmt/format.h>

#include <algorithm>

#include "app/commands.hpp"
#include "study/inspection.hpp"

namespace extremal::app {
namespace {

void print(const char* title, const std::vector<CatalogueEntry>& entries) {
  std::size_t width = 0;
  for (const CatalogueEntry& e : entries) width = std::max(width, e.name.size());
  fmt::print("{}\n", title);
  for (const CatalogueEntry& e : entries) fmt::print("  {:<{}}  {}\n", e.name, width, e.help);
}

}  // namespace

int list() {
  const Catalogue found = catalogue();
  print("Systems (system.use)", found.systems);
  print("\nSchemes (solve.scheme)", found.schemes);
  print("\nMethods (solve.method)", found.methods);
  return Exit::done;
}

}  // namespace extremal::app
