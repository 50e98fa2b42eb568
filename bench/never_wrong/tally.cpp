#include "tally.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace bench {
namespace {

double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

void Tally::count(Row& row, const Verdict& v) {
  const bool converged = v.status == "converged";
  ++row.scenes;
  row.converged += converged;
  row.known += v.scene.known;
  row.known_converged += v.scene.known && converged;
  row.refused += v.status == "refused";
  row.wrong += !v.faults.empty();
  row.too_far += v.error.value_or(0) > 1;
  row.too_fast += std::max(v.velocity.value_or(0), v.momentum.value_or(0)) > 1;
  if (v.estimate_over) row.estimates.push_back(*v.estimate_over);
  if (v.seconds <= row.slowest) return;
  row.slowest = v.seconds;
  row.slowest_seed = v.seed;
  row.slowest_index = v.index;
}

void Tally::add(const Verdict& v) {
  for (Row* row : {&systems_[v.scene.system], &kinds_[v.scene.kind], &all_["all"]}) count(*row, v);
  ++statuses_[v.status];
  for (const Fault& fault : v.faults) ++faults_[fault.kind];
}

void Tally::print_rows(const std::map<std::string, Row>& rows) {
  for (const auto& [name, r] : rows)
    fmt::print(
        "| {} | {} | {} | {} of {} | {} | {} | {} | {} | {} | {:.2g} … {:.2g} … {:.2g} | {:.2f} ({}:{}) |\n",
        name, r.scenes, r.converged, r.known_converged, r.known, r.scenes - r.converged - r.refused,
        r.refused, r.wrong, r.too_far, r.too_fast, quantile(r.estimates, 0), quantile(r.estimates, 0.5),
        quantile(r.estimates, 0.95), r.slowest, r.slowest_seed, r.slowest_index);
}

void Tally::print() const {
  fmt::print(
      "\n| scenes of | scenes | converged | with a known solution | failed | refused | wrong | error > "
      "tolerance | "
      "q', p > 10 tolerances | estimate/error: least … median … 95 % | slowest, s (seed:scene) |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const auto* rows : {&systems_, &kinds_, &all_}) print_rows(*rows);
  fmt::print("\n");
  for (const auto& [name, count] : statuses_) fmt::print("{}: {}\n", name, count);
  for (const auto& [kind, count] : faults_) fmt::print("wrong, {}: {}\n", kind, count);
  if (faultless()) fmt::print("nothing was wrong\n");
}

}  // namespace bench
