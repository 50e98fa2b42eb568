#include "report/comparison.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <ostream>

#include "report/figure.hpp"
#include "report/text.hpp"

namespace extremal {

namespace {

using Json = nlohmann::ordered_json;

Json reference(const Comparison& comparison) {
  if (!comparison.reference) return nullptr;
  const Comparison::Reference& found = *comparison.reference;
  return {{"method", "extremal"},
          {"tolerance", found.tolerance},
          {"error_estimate", found.error_estimate},
          {"range", found.range},
          {"message", comparison.message}};
}

Json object(const ComparisonRow& row) {
  return {{"method", row.method},
          {"tolerance", row.tolerance},
          {"seconds", row.seconds},
          {"error", row.error ? Json(*row.error) : Json(nullptr)},
          {"status", name(row.status)}};
}

}  // namespace

void write_json(std::ostream& out, const Comparison& comparison) {
  Json rows = Json::array();
  for (const ComparisonRow& row : comparison.rows) rows.push_back(object(row));
  out << Json{{"reference", reference(comparison)}, {"rows", std::move(rows)}}.dump(2) << "\n";
}

std::string summary(const Comparison& comparison) {
  std::string text = comparison.title.empty() ? "" : printable(comparison.title, 200) + "\n";
  text += fmt::format("{:<16}{}\n", "reference", printable(comparison.message, 2000));
  if (comparison.reference)
    text += fmt::format("{:<16}{:.1e}; largest range of q {:.3g}\n", "error estimate",
                        comparison.reference->error_estimate, comparison.reference->range);
  using Align = Table::Align;
  Table table{{{"method", Align::left}, {"tolerance"}, {"error of q"}, {"time"}, {"status", Align::left}},
              {}};
  for (const ComparisonRow& row : comparison.rows)
    table.rows.push_back({row.method, fmt::format("{:.0e}", row.tolerance),
                          row.error ? fmt::format("{:.1e}", *row.error) : "-", duration_text(row.seconds),
                          name(row.status)});
  return text + "\n" + plain_text(table);
}

}  // namespace extremal
