#include "tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <map>

#include "geometric_mean.hpp"

namespace bench {
namespace {

/// Marks what is outside the factor promised, and what is far outside.
std::string honesty_text(const Cell& cell) {
  const double decades = std::abs(std::log10(cell.honesty()));
  const char* mark = decades <= 1 ? "  " : decades <= 2 ? " !" : "!!";
  return fmt::format("{:>8.3g}{}", cell.honesty(), mark);
}

/// Of the peers measured apart; nothing where none has a time.
std::optional<double> best_peer(const Peers& peers, const std::string& scene, double error) {
  std::optional<double> best;
  for (std::size_t k = 0; k < peers.names.size(); ++k)
    if (const auto time = peer_time(peers, scene, k, error)) best = std::min(*time, best.value_or(*time));
  return best;
}

/// What the programs need for one error.
struct Times {
  Times(const SceneRecord& scene, const Peers& peers, double error)
      : ours(time_at_error(scene.cells, error)),
        best(best_rival(scene, error)),
        peer(best_peer(peers, scene.name, error)) {
    for (const Rival* rival : scene.rivals()) rivals.push_back(time_at_error(rival->runs, error));
  }

  std::optional<double> ours, best, peer;
  std::vector<std::optional<double>> rivals;  ///< of this run, as SceneRecord::rivals() names them
};

void print_error(const std::vector<SceneRecord>& scenes, const Peers& peers, double error) {
  fmt::print("\nTime at error {:.0e}, microseconds\n{:<18}{:>9} |{:>18} |{:>18}\n", error, "", "",
             "shooting by hand", "general shooting");
  fmt::print("{:<18}{:>9} |{:>9}{:>9} |{:>9}{:>9}{:>9} |", "", "extremal", "single", "multiple", "single",
             "multiple", "scipy");
  for (const std::string& name : peers.names) fmt::print("{:>10}", name);
  fmt::print(" |{:>11}{:>10}\n", "best rival", "best peer");
  int reached = 0, solved = 0;
  for (const SceneRecord& scene : scenes) {
    if (!scene.refusal.empty()) continue;
    const Times times(scene, peers, error);
    ++solved;
    reached += times.ours.has_value();
    fmt::print("{:<18}{:>9} |", scene.name, microseconds(times.ours));
    for (std::size_t k = 0; k < times.rivals.size(); ++k)
      fmt::print("{}{:>9}", k == 2 ? " |" : "", microseconds(times.rivals[k]));
    fmt::print(" |");
    for (std::size_t k = 0; k < peers.names.size(); ++k)
      fmt::print("{:>10}", microseconds(peer_time(peers, scene.name, k, error)));
    fmt::print(" |{:>11}{:>10}\n", ratio(times.best, times.ours), ratio(times.peer, times.ours));
  }
  fmt::print("reached in {} of {} scenes\n", reached, solved);
}

/// Runs of a rival, the fastest for each tolerance.
void print_runs(const Rival& rival) {
  if (!rival.absence.empty()) fmt::print("{}: {}\n", rival.name, rival.absence);
  if (rival.runs.empty()) return;
  fmt::print("{} (µs at true error):", rival.name);
  std::map<double, const Run*, std::greater<>> fastest;
  for (const Run& run : rival.runs) {
    const Run*& best = fastest[run.tolerance];
    if (!best || !best->converged() || (run.converged() && run.seconds < best->seconds)) best = &run;
  }
  for (const auto& [tolerance, run] : fastest)
    fmt::print("  {}", run->converged() ? fmt::format("{} at {:.0e}", microseconds(run->seconds), run->error)
                                        : fmt::format("failed at tolerance {:.0e}", tolerance));
  fmt::print("\n");
}

}  // namespace

std::string microseconds(std::optional<double> seconds) {
  if (!seconds) return "-";
  const double us = 1e6 * *seconds;
  return fmt::format("{:.{}f}", us, us < 100 ? 1 : 0);
}

std::string ratio(std::optional<double> other, std::optional<double> ours) {
  return other && ours ? fmt::format("{:.2f}", *other / *ours) : "-";
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
  for (const Rival* rival : scene.rivals()) print_runs(*rival);
}

void print_summary(const std::vector<SceneRecord>& scenes, const Peers& peers) {
  fmt::print(
      "\nTime at error E: the fastest of all runs whose true error is at most E.\n"
      "Rivals in this run: shooting with equations coded by hand, general shooting on the tapes of this "
      "library,\n"
      "and scipy's solve_bvp, each with the setting that is best in hindsight. Peers were measured "
      "separately.\n"
      "Last two columns: the time of the best rival of this run, and of the best peer, over ours.\n");
  for (double error : compared_errors) print_error(scenes, peers, error);
}

void print_means(const std::vector<SceneRecord>& scenes, const Peers& peers) {
  GeometricMean best, peer;
  const SceneRecord names;
  std::vector<GeometricMean> rivals(names.rivals().size());
  int problems = 0, cells = 0, reached = 0;
  for (const SceneRecord& scene : scenes) {
    if (!scene.boundary || !scene.refusal.empty()) continue;
    ++problems;
    for (double error : mean_errors) {
      const Times times(scene, peers, error);
      ++cells;
      reached += times.ours.has_value();
      best.add(times.best, times.ours);
      peer.add(times.peer, times.ours);
      for (std::size_t k = 0; k < rivals.size(); ++k) rivals[k].add(times.rivals[k], times.ours);
    }
  }
  fmt::print("\nErrors 1e-08 and 1e-11, {} boundary problems: {} of {} cells reached\n", problems, reached,
             cells);
  fmt::print("Geometric means of another's time over ours\n");
  const auto line = [](const std::string& name, const GeometricMean& mean) {
    fmt::print("  {:<28} {}\n", name, mean.text());
  };
  line("best rival of this run", best);
  for (std::size_t k = 0; k < rivals.size(); ++k) line(names.rivals()[k]->name, rivals[k]);
  line("best peer measured apart", peer);
}

void print_honesty(const std::vector<SceneRecord>& scenes) {
  int converged = 0, within = 0, below = 0, above = 0, cells = 0, met = 0;
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
      within += std::abs(std::log10(cell.honesty())) <= 1;
      below += cell.honesty() < 0.01;
      above += cell.honesty() > 100;
    }
    fmt::print("\n");
  }
  const double share = converged > 0 ? 100.0 * within / converged : 0;
  fmt::print(
      "{} of {} runs converged; of these {} meet the tolerance, {} ({:.0f} %) estimates are within a factor "
      "10 "
      "of the true error,\n{} below a hundredth of it, {} above a hundred times\n",
      converged, cells, met, within, share, below, above);
}

}  // namespace bench
