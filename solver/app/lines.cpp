#include "app/lines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "app/terminal.hpp"
#include "report/text.hpp"

namespace extremal::app {

void line(const std::string& label, const std::string& text) {
  print(fmt::format("{:<14} {}\n", label, visible(text, false)));
}

void lines(const std::string& label, const std::vector<std::string>& texts) {
  for (std::size_t k = 0; k < texts.size(); ++k) line(k == 0 ? label : "", texts[k]);
}

std::string parameter_text(const std::string& name, const std::vector<std::string>& values, bool list) {
  constexpr std::size_t most = 12;
  if (!list) return fmt::format("{} = {}", name, values.front());
  const auto end = values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), most));
  return fmt::format("{} = [{}{}]", name, fmt::join(values.begin(), end, ", "),
                     values.size() > most ? fmt::format(", … {} values", values.size()) : "");
}

std::string assignment_text(const Assignment& assignment) {
  std::vector<std::string> values;
  for (const Quantity& q : assignment.values)
    values.push_back(q.formula() ? std::get<std::string>(q.value)
                                 : fmt::format("{}", std::get<double>(q.value)));
  return parameter_text(assignment.name, values, assignment.list);
}

}  // namespace extremal::app
