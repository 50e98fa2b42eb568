#include "chart.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace bench {
namespace {

/// Scenes drawn, and what they are called.
const std::vector<std::pair<std::string, std::string>> panels{
    {"pendulum-short", "Pendulum"},           {"kepler-arc", "Kepler arc"},
    {"double-pendulum-1", "Double pendulum"}, {"henon-heiles-60", "Hénon–Heiles, T = 60"},
    {"halo-half", "Halo orbit, half"},        {"nrho-half", "Near-rectilinear halo, half"}};

constexpr int columns = 3;
constexpr double width = 960, header = 74, panel_height = 245, footer = 14;
constexpr double left_margin = 62, right_margin = 24, gap = 48, above = 30, below = 40;
constexpr int loosest = -2, tightest = -16;  ///< ends of the error axis, powers of ten
constexpr int error_step = 4;                ///< decades between its numbers

struct Points {
  std::vector<std::pair<double, double>> error_time;  ///< error, microseconds
};

/// Marks whose errors differ by less than this factor would cover each other: the faster one is drawn.
constexpr double distinct = 0.7;

/// Runs that no other run beats in both error and time, by falling error.
template <class Runs>
Points front(const Runs& runs) {
  Points all, best;
  for (const Run& run : runs)
    if (run.converged()) all.error_time.emplace_back(run.error, 1e6 * run.seconds);
  std::sort(all.error_time.begin(), all.error_time.end());
  double least = INFINITY;
  for (const auto& point : all.error_time)
    if (point.second < least) best.error_time.push_back(point), least = point.second;
  Points seen;
  for (auto point = best.error_time.rbegin(); point != best.error_time.rend(); ++point)
    if (seen.error_time.empty() || point->first < distinct * seen.error_time.back().first)
      seen.error_time.push_back(*point);
  return seen;
}

/// Inline data of gnuplot; a point that cannot be seen where there is none.
std::string block(const std::string& name, const Points& points) {
  std::string text = fmt::format("${} << END\n", name);
  for (const auto& [error, time] : points.error_time) text += fmt::format("{:.6g} {:.6g}\n", error, time);
  if (points.error_time.empty()) text += "NaN NaN\n";
  return text + "END\n";
}

struct Look {
  const char* colour;
  int mark;  ///< of gnuplot
  double size, line;
};
constexpr Look ours_look{"#1F5FA8", 7, 0.5, 2.2};
constexpr Look by_hand_look{"#C06A2B", 5, 0.42, 1.2};
/// In the order of the peers' table, repeated if there are more.
constexpr Look peer_looks[] = {{"#6B8E4E", 9, 0.55, 1.2}, {"#8A7AA8", 13, 0.6, 1.2}};

/// Of the curves: this library, shooting by hand, the peers.
const Look& look(std::size_t curve) {
  if (curve < 2) return curve == 0 ? ours_look : by_hand_look;
  return peer_looks[(curve - 2) % std::size(peer_looks)];
}

std::string plot_item(const std::string& data, const Look& look) {
  return fmt::format("${} using 1:2 with linespoints lc rgb '{}' lw {} pt {} ps {}", data, look.colour,
                     look.line, look.mark, look.size);
}

/// A sample of the line and its name, at x pixels from the left, above the panels.
std::string legend_entry(int& object, double x, double height, const Look& look, const std::string& name) {
  const double y = height - 53;
  object += 2;
  return fmt::format(
      "set arrow {} from screen {:.5f},{:.5f} to screen {:.5f},{:.5f} nohead lc rgb '{}' lw {}\n"
      "set label {} '' at screen {:.5f},{:.5f} point lc rgb '{}' pt {} ps {}\n"
      "set label {} \"{}\" at screen {:.5f},{:.5f} left tc rgb '#3A3F48' font ',12'\n",
      object, x / width, y / height, (x + 28) / width, y / height, look.colour, look.line, object,
      (x + 14) / width, y / height, look.colour, look.mark, look.size, object + 1, name, (x + 35) / width,
      y / height);
}

std::string legend(const Peers& peers, double height) {
  int object = 10;
  std::string text = fmt::format(
      "set label 1 \"Time to reach an error\" at screen {:.5f},{:.5f} left font ',17' tc rgb '#23272F'\n",
      left_margin / width, (height - 25) / height);
  text += fmt::format(
      "set label 3 \"others at their best setting in hindsight; {} measured apart\" at screen "
      "{:.5f},{:.5f} right font ',11' tc rgb '#5A606B'\n",
      fmt::join(peers.names, " and "), (width - right_margin) / width, (height - 53) / height);
  double x = left_margin;
  std::vector<std::string> names{"Extremal", "shooting by hand, DOP853"};
  names.insert(names.end(), peers.names.begin(), peers.names.end());
  for (std::size_t k = 0; k < names.size(); ++k) {
    text += legend_entry(object, x, height, look(k), names[k]);
    x += k == 1 ? 205 : 110;
  }
  return text;
}

/// Powers of ten that hold all times.
std::pair<double, double> decades(const std::vector<Points>& curves) {
  double low = INFINITY, high = 0;
  for (const Points& curve : curves)
    for (const auto& [error, time] : curve.error_time) low = std::min(low, time), high = std::max(high, time);
  return {std::pow(10, std::floor(std::log10(low))), std::pow(10, std::ceil(std::log10(high)))};
}

std::string panel(int index, int rows, const std::string& title, const SceneRecord& scene,
                  const Peers& peers) {
  const double height = header + rows * panel_height + footer;
  const double panel_width = (width - left_margin - right_margin - (columns - 1) * gap) / columns;
  const double left = left_margin + (index % columns) * (panel_width + gap);
  const double top = height - header - (index / columns) * panel_height - above;
  const double bottom = top - panel_height + above + below;
  std::vector<Run> by_hand = scene.single_by_hand.runs;
  by_hand.insert(by_hand.end(), scene.multiple_by_hand.runs.begin(), scene.multiple_by_hand.runs.end());
  std::vector<Points> curves{front(scene.cells), front(by_hand)};
  for (std::size_t k = 0; k < peers.names.size(); ++k) {
    curves.emplace_back();
    for (double error : peer_errors)
      if (const auto time = peer_time(peers, scene.name, k, error))
        curves.back().error_time.emplace_back(error, 1e6 * *time);
  }
  const auto [low, high] = decades(curves);
  std::string text, items;
  for (std::size_t k = 0; k < curves.size(); ++k) text += block(fmt::format("d{}", k), curves[k]);
  for (std::size_t k = curves.size(); k-- > 0;)  // ours last, on top
    items += (items.empty() ? "" : ", ") + plot_item(fmt::format("d{}", k), look(k));
  text += fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n"
      "set bmargin at screen {:.5f}\nset label 2 \"{}\" at graph 0,1.07 left tc rgb '#23272F' font ',13'\n"
      "set xlabel {}\nset ylabel {}\nset yrange [{:g}:{:g}]\nplot {}\n",
      left / width, (left + panel_width) / width, top / height, bottom / height, title,
      index / columns == rows - 1 ? "\"largest error of q(t)\" offset 0,0.3 tc rgb '#3A3F48'" : "''",
      index % columns == 0 ? "\"microseconds\" offset 1.2,0 tc rgb '#3A3F48'" : "''", low, high, items);
  if (index == 0) text += "unset label\nunset arrow\n";
  return text;
}

/// Numbers below the error axis: gnuplot finds none by itself on an axis that falls.
std::string error_tics() {
  std::string text;
  for (int power = -4; power >= tightest; power -= error_step)
    text += fmt::format("{}'10^{{{}}}' 1e{}", text.empty() ? "" : ", ", power, power);
  return text;
}

/// A literal of gnuplot in which nothing is substituted.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

std::string settings(const std::string& path, int rows) {
  return fmt::format(
      "set terminal svg size {},{} dynamic enhanced font 'Helvetica,12' background rgb 'white'\n"
      "set output {}\nset encoding utf8\nset key off\nset logscale xy\nset format y '10^{{%T}}'\n"
      "set xrange [1e{}:1e{}]\nset xtics ({}) nomirror scale 0.4\nset ytics 10 nomirror scale 0.4\n"
      "set mytics 1\nset tics textcolor rgb '#5A606B' font ',11'\n"
      "set border 3 lc rgb '#8C929C' lw 0.8\nset grid xtics ytics lt 1 lc rgb '#E8EAED' lw 0.8\n"
      "set multiplot\n",
      width, header + rows * panel_height + footer, quoted(path), loosest, tightest, error_tics());
}

}  // namespace

void draw_chart(const std::string& path, const std::vector<SceneRecord>& scenes, const Peers& peers) {
  std::vector<std::pair<std::string, const SceneRecord*>> drawn;
  for (const auto& [name, title] : panels)
    for (const SceneRecord& scene : scenes)
      if (scene.name == name && !front(scene.cells).error_time.empty()) drawn.emplace_back(title, &scene);
  if (drawn.empty()) throw std::runtime_error("none of the scenes of the chart was measured");
  const int rows = (static_cast<int>(drawn.size()) + columns - 1) / columns;
  std::string text = settings(path, rows);
  text += legend(peers, header + rows * panel_height + footer);
  for (std::size_t k = 0; k < drawn.size(); ++k)
    text += panel(static_cast<int>(k), rows, drawn[k].first, *drawn[k].second, peers);
  std::FILE* gnuplot = popen("gnuplot", "w");
  if (!gnuplot) throw std::runtime_error("gnuplot cannot be started");
  std::fputs((text + "unset multiplot\nunset output\n").c_str(), gnuplot);
  if (pclose(gnuplot) != 0) throw std::runtime_error("gnuplot failed");
}

}  // namespace bench
