#pragma once

#include <string>
#include <vector>

#include "catalogue.hpp"
#include "motion.hpp"
#include "random.hpp"
#include "scene_text.hpp"

/// \file A scene as it is drawn, table by table.

namespace bench {

struct Draft {
  const Recipe& recipe;
  Random& random;
  std::vector<std::string> names = {};  ///< of the coordinates: "x", "x[1]"
  Motion motion = {};                   ///< what is drawn about
  bool real = false;                    ///< the motion is one of the system; else only its ends are drawn
  std::string kind = {};
  bool known = false;
  Entries system = {}, boundary = {}, guess = {}, solve = {}, search = {}, continuation = {};
  Entries varied = {};  ///< parameters that are numbers, with their values

  double duration() const { return motion.duration; }
};

/// The system with random parameters and size, the coordinates' names, and a random start.
void draw_system(Draft& draft);
/// A state within the recipe's box.
State random_state(Draft& draft);

/// [boundary], its kind and what the guess must hold of it.
void draw_boundary(Draft& draft);
void draw_guess(Draft& draft);
void draw_solve(Draft& draft);
/// Now and then several extremals of the problem, or a family; the kind is then "search" or "family".
void draw_more(Draft& draft);

std::string text_of(const Draft& draft, const std::string& title);

}  // namespace bench
