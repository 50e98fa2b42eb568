#include "report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "report/gnuplot.hpp"
#include "report/layout.hpp"
#include "report/page.hpp"

namespace extremal {

namespace {

Format format_of(const std::string& path) {
  if (path.ends_with(".svg")) return Format::svg;
  if (path.ends_with(".png")) return Format::png;
  if (path.ends_with(".pdf")) return Format::pdf;
  throw std::invalid_argument(
      fmt::format("cannot plot into {}: the name must end in .svg, .png, .pdf or .html", path));
}

void check_finite(const std::string& key, const Column& column) {
  const auto bad = std::find_if_not(column.begin(), column.end(), [](double x) { return std::isfinite(x); });
  if (bad != column.end()) {
    throw std::invalid_argument(
        fmt::format("cannot plot {}: {} at sample {}", key, *bad, bad - column.begin() + 1));
  }
}

void check(const Picture& picture, const Samples& samples) {
  if (picture.names.empty()) throw std::invalid_argument("cannot plot 0 coordinates");
  if (samples.count() < 2) {
    throw std::invalid_argument(fmt::format("cannot plot {} samples; need at least 2", samples.count()));
  }
  // Velocities and momenta may be absent as a whole.
  const std::vector<Column> absent(picture.names.size(), Column(samples.count()));
  check_shape({.t = samples.t,
               .q = samples.q,
               .v = samples.v.empty() ? absent : samples.v,
               .p = samples.p.empty() ? absent : samples.p},
              picture.names);
  check_finite("t", samples.t);
  for (std::size_t k = 1; k < samples.count(); ++k) {
    if (!(samples.t[k - 1] < samples.t[k])) {
      throw std::invalid_argument(
          fmt::format("cannot plot: times {} and {} do not increase", samples.t[k - 1], samples.t[k]));
    }
  }
  for (std::size_t a = 0; a < samples.q.size(); ++a) check_finite(picture.names[a], samples.q[a]);
  for (std::size_t a = 0; a < samples.v.size(); ++a)
    check_finite(velocity_key(picture.names[a]), samples.v[a]);
}

}  // namespace

void check_plot_path(const std::string& path) {
  if (is_page(path))
    require_pages();
  else
    format_of(path);
}

void check_picture(const Picture& picture) {
  check(picture, picture.samples);
  for (const Samples& other : picture.others) check(picture, other);
  if (!picture.others.empty() && picture.actions.size() != picture.others.size() + 1)
    throw std::invalid_argument(fmt::format("cannot plot {} solutions with {} actions",
                                            picture.others.size() + 1, picture.actions.size()));
}

std::string plot_image(const std::string& path, const Figure& figure) {
  return draw(figure, format_of(path));
}

std::string plot_image(const std::string& path, const Picture& picture) {
  format_of(path);
  check_picture(picture);
  return plot_image(path, layout(picture));
}

}  // namespace extremal
