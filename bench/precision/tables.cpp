#include "tables.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bench {
namespace {

std::string microseconds(std::optional<double> seconds) {
  if (!seconds) return "-";
  const double us = 1e6 * *seconds;
  return fmt::format("{:.{}f}", us, us < 100 ? 1 : 0);
}

/// Marks what is outside the factor promised, and what is far outside.
std::string honesty_text(const Cell& cell) {
  const double decades = std::abs(std::log10(cell.honesty()));
  const char* mark = decades <= 1 ? "  " : decades <= 2 ? " !" : "!!";
  return fmt::format("{:>8.3g}{}", cell.honesty(), mark);
}

class GeometricMean {
 public:
  void add(double x) { sum_ += std::log(x), ++count_, better_ += x > 1; }
  std::string text() const {
    if (count_ == 0) return "none";
    return fmt::format("{:.2f} over {} cells, above 1 in {}", std::exp(sum_ / count_), count_, better_);
  }

 private:
  double sum_ = 0;
  int count_ = 0, better_ = 0;
};

/// Another program's time over ours; adds it to the means.
std::string ratio(std::optional<double> other, std::optional<double> ours,
                  std::initializer_list<GeometricMean*> means) {
  if (!other || !ours) return "-";
  for (GeometricMean* mean : means) mean->add(*other / *ours);
  return fmt::format("{:.2f}", *other / *ours);
}

/// Of one comparison: for one error, and for all.
struct Means {
  GeometricMean peers, shooting, scipy;
};

void print_error(const std::vector<SceneRecord>& scenes, const Peers& peers, double error, Means& all) {
  fmt::print("\nTime at error {:.0e}, microseconds\n{:<20}{:>9} |{:>9}{:>9} |", error, "", "extremal",
             "shooting", "scipy");
  for (const std::string& name : peers.names) fmt::print("{:>10}", name);
  fmt::print(" |{:>10}{:>10}\n", "best peer", "shooting");
  Means here;
  int reached = 0, solved = 0;
  for (const SceneRecord& scene : scenes) {
    if (!scene.refusal.empty()) continue;
    const auto ours = time_at_error(scene.cells, error), shot = time_at_error(scene.shooting.runs, error),
               scipy = time_at_error(scene.scipy.runs, error), best = best_peer(peers, scene.name, error);
    ++solved;
    reached += ours.has_value();
    fmt::print("{:<20}{:>9} |{:>9}{:>9} |", scene.name, microseconds(ours), microseconds(shot),
               microseconds(scipy));
    for (std::size_t k = 0; k < peers.names.size(); ++k)
      fmt::print("{:>10}", microseconds(peer_time(peers, scene.name, k, error)));
    fmt::print(" |{:>10}{:>10}\n", ratio(best, ours, {&here.peers, &all.peers}),
               ratio(shot, ours, {&here.shooting, &all.shooting}));
    ratio(scipy, ours, {&here.scipy, &all.scipy});
  }
  fmt::print("reached in {} of {} scenes; best peer / extremal, geometric mean: {}\n", reached, solved,
             here.peers.text());
}

}  // namespace

std::optional<double> best_peer(const Peers& peers, const std::string& scene, double error) {
  std::optional<double> best;
  for (std::size_t k = 0; k < peers.names.size(); ++k)
    if (const auto time = peer_time(peers, scene, k, error)) best = std::min(*time, best.value_or(*time));
  return best;
}

void print_scene(const SceneRecord& scene) {
  fmt::print("\n{}\n", scene.name);
  if (!scene.refusal.empty()) {
    fmt::print("  skipped: {}\n", scene.refusal);
    return;
  }
  fmt::print("{:>9}{:>9}{:>7}{:>11}{:>11}{:>12}{:>9}{:>12}{:>10}{:>12}\n", "tolerance", "elements", "degree",
             "iterations", "median µs", "true error", "allowed", "estimate", "est/err", "velocity");
  for (const Cell& cell : scene.cells) {
    if (!cell.converged()) {
      fmt::print("{:>9.0e}{:>27}{:>11}  failed: {}\n", cell.tolerance, cell.iterations,
                 microseconds(cell.seconds), cell.failure);
      continue;
    }
    fmt::print("{:>9.0e}{:>9}{:>7}{:>11}{:>11}{:>12.2e}{:>9.2g}{:>12.2e}{}{:>10.1e}\n", cell.tolerance,
               cell.elements, cell.degree, cell.iterations, microseconds(cell.seconds), cell.error,
               cell.error / cell.allowed, cell.estimate, honesty_text(cell), cell.velocity_error);
  }
  for (const auto& [name, rival] : {std::pair("shooting", &scene.shooting), {"scipy", &scene.scipy}}) {
    if (!rival->absence.empty()) fmt::print("{}: {}\n", name, rival->absence);
    if (rival->runs.empty()) continue;
    fmt::print("{} (µs at true error):", name);
    for (const Run& run : rival->runs)
      fmt::print("  {}", run.converged() ? fmt::format("{} at {:.0e}", microseconds(run.seconds), run.error)
                                         : fmt::format("failed at tolerance {:.0e}", run.tolerance));
    fmt::print("\n");
  }
}

void print_summary(const std::vector<SceneRecord>& scenes, const Peers& peers) {
  fmt::print(
      "\nTime at error E: the fastest of all runs whose true error is at most E.\n"
      "Left, in this run: single shooting, general, that plays the same tapes point by point, and scipy's "
      "solve_bvp.\nRight: programs with equations coded by hand, measured separately on the same kind of "
      "machine,\neach with the setting that is best in hindsight (bench/data/README.md).\n"
      "Last two columns: their time over ours.\n");
  Means all;
  for (double error : compared_errors) print_error(scenes, peers, error, all);
  fmt::print("\nAll errors, geometric means of another's time over ours\n");
  fmt::print("  best peer measured apart: {}\n  single shooting in this run: {}\n", all.peers.text(),
             all.shooting.text());
  fmt::print("  scipy in this run: {}\n", all.scipy.text());
}

void print_honesty(const std::vector<SceneRecord>& scenes) {
  int converged = 0, within[2] = {0, 0}, cells = 0, met = 0;
  fmt::print("\nError estimate / true error, from the loosest tolerance on; x: not converged\n");
  for (const SceneRecord& scene : scenes) {
    if (scene.cells.empty()) continue;
    fmt::print("{:<20}", scene.name);
    for (const Cell& cell : scene.cells) {
      ++cells;
      fmt::print("{:>8}", cell.converged() ? fmt::format("{:.2g}", cell.honesty()) : "x");
      if (!cell.converged()) continue;
      ++converged;
      met += cell.error <= cell.allowed;
      const double decades = std::abs(std::log10(cell.honesty()));
      within[0] += decades <= 1;
      within[1] += decades <= 2;
    }
    fmt::print("\n");
  }
  fmt::print(
      "{} of {} runs converged; of these {} meet the tolerance, {} estimates are within [0.1, 10] and "
      "{} within [0.01, 100]\nof the true error\n",
      converged, cells, met, within[0], within[1]);
}

}  // namespace bench
