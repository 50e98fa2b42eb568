#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/branch.hpp"
#include "report/comparison.hpp"
#include "report/figure.hpp"
#include "report/layout.hpp"

/// \file Pictures as data of a page.

namespace extremal {

using PageData = nlohmann::ordered_json;

/// The text of every page around its title and its data, made by build.mjs. Empty in a build without pages.
struct PageTemplate {
  const char *head, *middle, *tail;
  const char* absence;  ///< why there is none; empty where there is
};
PageTemplate page_template();

/// "#0072b2".
std::string css_colour(Colour colour);

/// Name and unit of an axis.
PageData page_axis(const AxisName& name);

/// Panels with axes, curves, marks and legends; without maps and keys.
PageData page_figure(const Figure& figure);

/// Every so many samples of a picture are kept, so that all of its columns make a page of moderate size.
std::size_t page_stride(const Picture& picture);
/// t, then all coordinates and velocities of one solution, as text: every `stride`th sample and the last.
PageData page_columns(const Samples& samples, const std::vector<const Column*>& forces, std::size_t stride);

/// How the solutions of a picture are told apart.
struct PageSolutions {
  std::vector<std::string> labels;
  std::vector<Colour> colours;
  bool family = false;  ///< solutions on branches, neighbours of each other
};

/// What a page draws of solutions: columns of numbers, views of the motion, panels against time.
PageData page_picture(const Picture& picture, const PageSolutions& solutions);

/// The data of a result, of a search, a spectrum or a fit. `result` is what write_json() writes, samples left
/// out; `actions` are those of all solutions.
PageData solution_data(PageData result, const Picture& picture);
/// Of a branch with the orbits of its points, or without any.
PageData branch_data(const BranchPicture& picture, PageData result, std::vector<Samples> orbits);
/// What a page draws of each point: fewer samples of many, but some in each element.
std::vector<Samples> orbits_of(const FollowedBranch& branch);
PageData comparison_data(const Comparison& comparison, PageData result);

/// The page of such data.
std::string filled_page(const PageData& data);

}  // namespace extremal
