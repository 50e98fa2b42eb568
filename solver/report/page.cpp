#include "report/page.hpp"

#include <stdexcept>

#include "report/json.hpp"
#include "report/page_data.hpp"
#include "report/solutions.hpp"

namespace extremal {

namespace {

constexpr std::size_t longest_title = 200;

/// A text between tags.
std::string html_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else
      escaped += c;
  }
  return escaped;
}

/// JSON that no tag can end: "<" stands in its strings alone, and may be written as an escape there.
std::string script_text(const PageData& data) {
  std::string escaped;
  for (const char c : data.dump(-1, ' ', false, PageData::error_handler_t::replace)) {
    if (c == '<')
      escaped += "\\u003c";
    else
      escaped += c;
  }
  return escaped;
}

template <class Subject>
PageData written(const Subject& subject) {
  return PageData::parse(text_of([&](std::ostream& out) { write_json(out, subject); }));
}

/// The picture stands for samples and for what is drawn beside them.
Result without_samples(Result result) {
  result.samples.reset();
  result.annotation = {};
  result.boundaries.clear();
  if (result.solutions)
    for (Result& each : *result.solutions) each.samples.reset();
  return result;
}

}  // namespace

bool is_page(const std::string& path) { return path.ends_with(".html"); }

void require_pages() {
  const std::string absence = page_template().absence;
  if (!absence.empty()) throw std::invalid_argument("cannot make a page: " + absence);
}

std::string filled_page(const PageData& data) {
  require_pages();
  const PageTemplate text = page_template();
  const std::string title = printable(data.at("title").get<std::string>(), longest_title);
  std::string page = text.head;
  page += html_text(title.empty() ? "Extremal" : title);
  page += text.middle;
  page += script_text(data);
  page += text.tail;
  return page;
}

std::string page(const Result& result, const Picture& picture) {
  require_pages();
  check_picture(picture);
  PageData data = solution_data(written(without_samples(result)), picture);
  if (result.spectrum) data["figures"].push_back(page_figure(spectrum_layout(result)));
  if (result.fit)
    data["figures"].push_back(page_figure(fit_layout(result, picture.samples, picture.annotation)));
  return filled_page(data);
}

std::string page(const BranchPicture& picture) {
  require_pages();
  return filled_page(branch_data(picture, written(picture.branch), orbits_of(picture.branch)));
}

std::string page(const Comparison& comparison) {
  require_pages();
  return filled_page(comparison_data(comparison, written(comparison)));
}

PageData solution_data(PageData result, const Picture& picture) {
  const SolutionColours colours = solution_colours(picture);
  const std::size_t count = picture.others.size() + 1;
  const std::vector<std::string> labels =
      count > 1 ? action_texts(picture.actions) : std::vector<std::string>{""};
  PageData drawn = page_picture(picture, {labels, colours.colours, false});
  return {{"kind", "solution"},
          {"title", picture.title},
          {"result", std::move(result)},
          {"picture", std::move(drawn)},
          {"figures", PageData::array()}};
}

PageData comparison_data(const Comparison& comparison, PageData result) {
  return {{"kind", "comparison"},
          {"title", comparison.title},
          {"result", std::move(result)},
          {"picture", nullptr},
          {"figures", PageData::array({page_figure(layout(comparison))})}};
}

}  // namespace extremal
