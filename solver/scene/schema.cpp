#include "scene/schema.hpp"

#include <algorithm>
#include <iterator>

namespace extremal {
namespace {

constexpr MethodRecord methods[] = {
    {"newton", "damped Newton method; elements and degree rise until the tolerance is met"},
    {"ceres", "least squares of the residual by Ceres, then Newton's method"},
    {"ipopt", "interior point method of Ipopt with the equations as constraints, then Newton's method"},
};
constexpr std::string_view method_names[] = {methods[0].name, methods[1].name, methods[2].name};
constexpr std::string_view durations[] = {"free", "infinite"}, times[] = {"free"},
                           losses[] = {"squared", "huber", "cauchy"};

constexpr KeyRecord keys[] = {
    {"", "title", Kind::text, "empty", "Text above tables and plots.", R"(title = "Planar transfer")"},
    {"", "system", Kind::table, "required",
     "The Lagrangian or Hamiltonian: coordinates, parameters and formulas.", R"(system.use = "kepler")"},
    {"", "boundary", Kind::table, "required", "Conditions at the ends, and the duration.",
     "boundary.duration = 2.5"},
    {"", "waypoints", Kind::tables, "none", "Points in between, in order of their times.",
     "waypoints = [{ at = 1.5, x = 0.2 }]"},
    {"", "guess", Kind::table, "the default guess", "The path from which the search begins.",
     "guess.x = \"cos(pi*t/T)\""},
    {"", "solve", Kind::table, "none", "Tolerance, scheme and method.", "solve.tolerance = 1e-12"},
    {"", "search", Kind::table, "none", "Several extremals of one problem.", "search.solutions = 5"},
    {"", "continuation", Kind::table, "none", "A family of extremals, for `extremal continue`.",
     R"(continuation = { parameter = "mu", to = 0.1 })"},
    {"", "spectrum", Kind::table, "none", "Frequencies and amplitudes of each coordinate.",
     "spectrum.lines = 6"},
    {"", "units", Kind::table, "none", "Lengths and times in space, for an ephemeris (`--oem`).",
     "units.length = 384400.0"},
    {"", "fit", Kind::table, "none", "Parameters and open ends by observations, for `extremal solve`.",
     R"(fit = { data = "observed.csv", parameters = ["mu"] })"},
    {"", "path", Kind::table, "none", "Inequalities along the whole path.",
     "path.constraints = [\"x^2 + y^2 >= 1\"]"},

    {"system", "use", Kind::text, "none",
     "Name of a system file. The parameters and definitions of the scene add to those of the file or replace "
     "them.",
     R"(use = "kepler")"},
    {"system", "coordinates", Kind::texts, "required without `use`",
     "Names of the coordinates. `q[n]` declares `q[1]` to `q[n]`; n is a number or a formula of parameters.",
     R"(coordinates = ["r", "q[3]"])"},
    {"system", "parameters", Kind::quantities, "none",
     "Constants for the formulas: numbers, or formulas of other parameters. One that nothing uses is an "
     "error.",
     "parameters = { mu = 0.1, m = [\"1 - mu\", \"mu\"] }", true},
    {"system", "definitions", Kind::text, "none",
     "Named parts of formulas, in any order. `X'` is the velocity of a definition `X`, `X(0)` its value at "
     "an end. One that is not used costs nothing; a cycle is an error.",
     "definitions = { r = \"sqrt(x^2 + y^2)\" }", true},
    {"system", "lagrangian", Kind::text, "required without `use`",
     "Formula of L in coordinates, velocities (`x'`), `t`, parameters and definitions.",
     R"(lagrangian = "(x'^2 + y'^2)/2 + mu/r")"},
    {"system", "hamiltonian", Kind::text, "none",
     "Instead of `lagrangian`: formula of H in coordinates, momenta (`p_x`, `p_x[i]`), `t`, parameters and "
     "definitions.",
     R"(hamiltonian = "(p_x^2 + p_y^2)/2 - mu/r")"},
    {"system", "force", Kind::quantities, "none",
     "Forces F that no Lagrangian has: d/dt ∂L/∂q' − ∂L/∂q = F. A formula of coordinates, velocities, `t`, "
     "parameters and definitions; for an array a list or one formula in the index `i`.",
     R"(force = { x = "-0.1*x'" })", true},
    {"system", "curvature", Kind::number, "none",
     "Bound of M⁻¹V'' for all positions. With it the windows of L = q'ᵀMq'/2 − V have the certificate "
     "`global`.",
     "curvature = 4.0"},
    {"system", "constraints", Kind::texts, "none",
     "Holonomic constraints: equations of coordinates, `t`, parameters and definitions that hold at every t. "
     "The motion has the forces λ ∂(left − right)/∂q that keep them.",
     "constraints = [\"x^2 + y^2 = l^2\"]"},

    {"boundary", "start", Kind::quantities, "none",
     "Coordinates at t = 0: numbers, formulas, for an array a list or one formula in the index `i`; or "
     "momenta ∂L/∂x', as `p_x`. A coordinate of which neither is given has zero momentum there: the natural "
     "condition. Every coordinate and every momentum, with no `end`, are initial data: the motion is marched "
     "from them.",
     R"(start = { x = 1.0, p_y = 0.3, q = "0.1*i" })", true},
    {"boundary", "end", Kind::quantities, "none", "The same at t = T.",
     R"(end = { x = "-mu", "q[2]" = 0.5 })", true},
    {"boundary", "duration", Kind::quantity, "required",
     R"(T > 0, or `"free"` with `energy` or `where`; a free period with forces needs neither. )"
     R"(Or `"infinite"`: an end at which every coordinate is fixed at an equilibrium of L is approached )"
     "exponentially; both ends such are (−∞, ∞), one is [0, ∞) or (−∞, 0].",
     "duration = \"2*pi/sqrt(mu)\"", false, durations},
    {"boundary", "energy", Kind::quantity, "none",
     "Energy p·q' − L of the extremal; it determines a free duration.", "energy = -0.4"},
    {"boundary", "where", Kind::note, "none",
     "Equation between end values; it determines a free duration. The duration is varied until the extremal "
     "satisfies it. With `unknowns` a list: as many as there are unknowns, and one more for a free duration "
     "without `energy`.",
     R"(where = "x(0) = 0.777413")"},
    {"boundary", "periodic", Kind::boolean, "false",
     "Periodic orbit: q(T) = q(0), and the momenta agree; without other conditions at the ends.",
     "periodic = true"},
    {"boundary", "map", Kind::quantities, "none",
     "Orbit closed up to a symmetry of L: each formula of q(0) gives a coordinate at T. The formulas are "
     "affine.",
     R"(map = { theta = "theta + 2*pi" })", true},
    {"boundary", "conditions", Kind::texts, "none",
     "Equations between end values, instead of `start` and `end`, linear or not. The directions that they "
     "leave free get the natural condition.",
     "conditions = [\"x(0) = 1\", \"x(T)^2 + y(T)^2 = 4\"]"},
    {"boundary", "integrals", Kind::texts, "none",
     "Integrals that are given: the left side, a formula of coordinates, velocities, `t`, parameters and "
     "definitions, is integrated from 0 to T.",
     "integrals = [\"sqrt(1 + y'^2) = 4\"]"},
    {"boundary", "unknowns", Kind::number, "none",
     "Parameters that are to be found, with guesses; `where` has as many equations.",
     "unknowns = { k = 1.0 }", true},

    {"path", "constraints", Kind::texts, "required",
     "Inequalities `left >= right` or `left <= right` between coordinates, `t`, parameters and definitions. "
     "They hold at all times; sought is a local minimiser of the action among the paths that keep them.",
     "constraints = [\"x^2 + y^2 >= 1\"]"},

    {"waypoints", "at", Kind::quantity, "no default",
     R"(Time between 0 and T, or `"free"`: the action is stationary in the time too.)", "at = 1.5", false,
     times},
    {"waypoints", "*", Kind::quantities, "none",
     "Coordinate that is fixed there; its momentum may jump. At least one.", "x = 0.2"},

    {"guess", "file", Kind::text, "none",
     "Result with samples, CSV or `.npz` with `t` and coordinates; or a file of another program, see below. "
     "Its times are scaled to [0, T].",
     R"(file = "earlier.json")"},
    {"guess", "orbit", Kind::integer, "the only one",
     "Which orbit of a `file` with several: the row, from 1, or AUTO's label.", "orbit = 12"},
    {"guess", "state", Kind::quantities, "none",
     "Initial positions and velocities; the motion from there is the guess. A name that is left out is zero.",
     R"(state = { x = 1.0, "y'" = 0.9 })", true},
    {"guess", "duration", Kind::quantity, "that of `file`",
     "Guess of a free duration; required unless `file` is given. With an infinite duration, the time T over "
     "which the guess is given, from t = 0; without it that in which the guess comes near its equilibria.",
     "duration = 2.4"},
    {"guess", "*", Kind::quantities, "the line between the ends",
     "Formula of `t`, `T` and parameters; for an array one for each element, or one in the index `i`. With a "
     "`hamiltonian` also of a momentum `p_x`.",
     "x = \"cos(2*pi*(t/T + i/3))\""},

    {"solve", "tolerance", Kind::number, "1e-9",
     "Largest error of q(t), relative to the largest range of a coordinate.", "tolerance = 1e-12"},
    {"solve", "scheme", Kind::text, "chosen",
     "Scheme of every element. The number of elements is adapted to the tolerance.",
     R"(scheme = "midpoint")"},
    {"solve", "elements", Kind::integer, "chosen",
     "Number of equal elements; with `scheme`, without `tolerance`.", "elements = 64"},
    {"solve", "steps", Kind::text, "equal",
     "`\"free\"`: with `elements`, the times of the nodes are unknowns in which the action is stationary "
     "too. All elements then have the same discrete energy.",
     R"(steps = "free")"},
    {"solve", "budget", Kind::number, "60",
     "Seconds after which nothing further is tried, and an attempt that does not converge is given up.",
     "budget = 600.0"},
    {"solve", "method", Kind::text, R"("newton")",
     R"(Method for the first approach from each guess: `"newton"`, `"ceres"` or `"ipopt"`.)",
     R"(method = "ceres")", false, method_names},

    {"search", "solutions", Kind::integer, "required", "Number of distinct extremals wanted, 1 to 1000.",
     "solutions = 5"},

    {"continuation", "parameter", Kind::text, "required",
     R"(Quantity that varies: `"duration"`, `"energy"`, or a parameter of the system.)",
     R"(parameter = "mu")"},
    {"continuation", "to", Kind::number, "required", "Its last value. The first is that of the scene.",
     "to = 0.1"},
    {"continuation", "points", Kind::integer, "50", "Largest number of points of a branch, 2 to 100000.",
     "points = 100"},
    {"continuation", "switch", Kind::boolean, "false",
     "Follow also the branches that bifurcate, but not what bifurcates from these in turn.", "switch = true"},

    {"spectrum", "lines", Kind::integer, "as many as the tolerance asks for, 32 at most",
     "Number of lines of each coordinate, 1 to 1000. Fewer are found where the motion has no more.",
     "lines = 6"},
    {"spectrum", "against", Kind::text, "none",
     "Result that has a spectrum. `flat_norm` is the distance from it, in the flat norm.",
     R"(against = "other.json")"},

    {"units", "length", Kind::number, "required", "Unit of length in km.", "length = 384400.0"},
    {"units", "time", Kind::number, "required", "Unit of time in s.", "time = 375190.26"},
    {"units", "frame", Kind::text, "required", "Name of the frame of reference.", R"(frame = "ICRF")"},
    {"units", "centre", Kind::text, "required", "Name of the origin.", R"(centre = "EARTH")"},
    {"units", "epoch", Kind::text, "required", "Date of t = 0 in TDB, from 1700 to 2200.",
     R"(epoch = "2025-01-31T12:00:00")"},
    {"fit", "data", Kind::text, "required",
     "CSV with a column `t`, times from 0 to the duration, and columns of observations: named like "
     "coordinates, velocities (`x'`) or formulas of `observe`. A column `sigma x` has the standard "
     "deviations of column "
     "`x`; without it they are 1. An empty cell was not observed.",
     R"(data = "observed.csv")"},
    {"fit", "observe", Kind::text, "none",
     "Observations as formulas of coordinates, velocities, `t`, parameters and definitions. One that is "
     "`atan2`, or a number times it, is an angle: whole turns do not count.",
     "observe = { angle = \"atan2(y, x)\" }", true},
    {"fit", "parameters", Kind::texts, "none",
     "Parameters to be found, beside the end coordinates that `[boundary]` leaves open. Their values in the "
     "scene are the first guess.",
     R"(parameters = ["l", "g"])"},
    {"fit", "loss", Kind::text, R"("squared")",
     R"(ρ of the least sum Σ ρ((observed − computed)²/σ²): `"squared"`; `"huber"` or `"cauchy"`, which )"
     "count outliers less.",
     R"(loss = "huber")", false, losses},

    {"system file", "about", Kind::note, "none",
     "Texts about the system. The first is shown by `extremal list`; pictures use `axes` and `centres`.",
     R"(about = { summary = "Plane pendulum", units = "kg, m, s" })", true},
    {"system file", "system", Kind::table, "required", "The table `[system]` of a scene, without `use`.",
     R"(system = { coordinates = ["x"], lagrangian = "x'^2/2" })"},
};

constexpr Exclusion pairs[] = {
    {"solve.tolerance", "solve.elements", "'elements' fixes the discretisation and with it the error"},
    {"system.use", "system.coordinates", "the system file declares the coordinates"},
    {"system.lagrangian", "system.hamiltonian", "either of them is the law of the system; leave one out"},
    {"boundary.periodic", "boundary.start", "a periodic orbit has no fixed ends; 'where' selects it"},
    {"boundary.periodic", "boundary.end", "a periodic orbit has no fixed ends; 'where' selects it"},
    {"boundary.periodic", "boundary.conditions", "both relate the ends"},
    {"boundary.conditions", "boundary.start", "write the fixed ends as conditions too"},
    {"boundary.conditions", "boundary.end", "write the fixed ends as conditions too"},
    {"system.force", "system.curvature", "with forces there are no windows to certify"},
    {"boundary.energy", "boundary.where", "exactly one of them closes a free duration", "boundary.unknowns"},
    {"boundary.integrals", "system.force", "with forces there is no action that could be stationary"},
    {"boundary.integrals", "system.hamiltonian",
     "integrals join a Lagrangian; write the 'lagrangian' instead, or leave 'integrals' out"},
    {"boundary.unknowns", "system.hamiltonian",
     "unknowns join a Lagrangian; write the 'lagrangian' instead, or give the constants as 'parameters'"},
    {"system.constraints", "system.curvature",
     "a bound along all positions says nothing of constrained ones"},
    {"system.constraints", "system.hamiltonian", "constraints hold a system that a Lagrangian describes"},
    {"fit.data", "search.solutions", "a fit follows one extremal"},
    {"fit.data", "solve.steps", "a fit keeps the times of the nodes"},
    {"guess.file", "guess.state", "a guess has one source"},
    {"guess.file", "guess.*", "a guess has one source"},
    {"guess.state", "guess.*", "a guess has one source"},
};

constexpr Requirement needs[] = {
    {"solve.elements", "solve.scheme", "the number of elements alone does not fix a discretisation"},
    {"solve.steps", "solve.elements", "the times of the nodes are found for a given number of elements"},
    {"guess.orbit", "guess.file", "it chooses an orbit of a file"},
    {"boundary.map", "boundary.periodic", "a map relates the ends of a periodic orbit"},
};

}  // namespace

const char* description(Kind kind) {
  switch (kind) {
    case Kind::text:
      return "a string";
    case Kind::number:
      return "a number";
    case Kind::integer:
      return "an integer";
    case Kind::boolean:
      return "true or false";
    case Kind::quantity:
      return "a number or a formula";
    case Kind::texts:
      return "a list of strings";
    case Kind::quantities:
      return "a number, a formula or a list of them";
    case Kind::note:
      return "a string or a list of strings";
    case Kind::tables:
      return "a list of tables";
    case Kind::table:
      break;
  }
  return "a table";
}

std::span<const KeyRecord> key_records() { return keys; }
std::span<const Exclusion> exclusions() { return pairs; }
std::span<const Requirement> requirements() { return needs; }
std::span<const MethodRecord> method_records() { return methods; }

const KeyRecord* find_key(std::string_view table, std::string_view key) {
  const auto is = [&](std::string_view wanted) {
    return std::find_if(std::begin(keys), std::end(keys),
                        [&](const KeyRecord& k) { return k.table == table && k.key == wanted; });
  };
  const KeyRecord* found = is(key);
  if (found == std::end(keys)) found = is("*");
  return found == std::end(keys) ? nullptr : found;
}

std::vector<std::string> keys_of(std::string_view table) {
  std::vector<std::string> names;
  for (const KeyRecord& k : keys)
    if (k.table == table && k.key != "*") names.emplace_back(k.key);
  return names;
}

std::vector<std::string> choices_of(std::string_view table, std::string_view key) {
  const std::span<const std::string_view> choices = find_key(table, key)->choices;
  return {choices.begin(), choices.end()};
}

}  // namespace extremal
