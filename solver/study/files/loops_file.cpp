#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "study/files/formats.hpp"
#include "study/files/numpy.hpp"

namespace extremal {
namespace {

using Json = nlohmann::json;

/// How a body moves along a loop: R loop(direction·(t − shift)).
struct Body {
  std::size_t loop = 0;
  std::vector<std::vector<double>> rotation{};  ///< empty: none
  int direction = 1;
  double shift = 0;
};

/// The part of a shift beside whole turns.
double turns(double shift) {
  if (!std::isfinite(shift)) throw std::invalid_argument("a shift in time is not finite");
  return shift - std::floor(shift);
}

/// A loop for each body, or as choreo's description of the loops says.
std::vector<Body> bodies_of(const std::filesystem::path& description, std::size_t loops) {
  std::vector<Body> bodies;
  if (!std::filesystem::exists(description)) {
    for (std::size_t l = 0; l < loops; ++l) bodies.push_back({l});
    return bodies;
  }
  const auto source = read_source(description.string());
  try {
    const Json root = Json::parse(source->text);
    bodies.resize(root.at("nbody").get<std::size_t>());
    const Json& targets = root.at("Targets");
    for (std::size_t l = 0; l < loops; ++l)
      for (std::size_t k = 0; k < targets.at(l).size(); ++k) {
        const double numerator = root.at("TimeShiftNumUn").at(l).at(k),
                     denominator = root.at("TimeShiftDenUn").at(l).at(k);
        bodies.at(targets[l][k].get<std::size_t>()) = {
            l, root.at("SpaceRotsUn").at(l).at(k).get<std::vector<std::vector<double>>>(),
            root.at("TimeRevsUn").at(l).at(k).get<int>(), turns(numerator / denominator)};
      }
  } catch (const std::exception& e) {
    throw SceneError({source, 0, 0}, fmt::format("this does not describe loops of bodies: {}", e.what()));
  }
  return bodies;
}

/// The index of the first element of each array of coordinates, one array a dimension, each with `bodies`
/// elements.
std::vector<std::size_t> arrays_of(const std::vector<std::string>& names, std::size_t bodies,
                                   const Location& at) {
  std::vector<std::size_t> first;
  for (std::size_t a = 0; a < names.size(); ++a)
    if (names[a].ends_with("[1]")) first.push_back(a);
  if (first.size() * bodies != names.size())
    throw SceneError(at,
                     fmt::format("the file has {} bodies; coordinates for it are arrays, one a dimension, as "
                                 "\"x[{}]\" and \"y[{}]\"",
                                 bodies, bodies, bodies));
  return first;
}

}  // namespace

GuessFile read_loops(const std::string& path, const std::vector<std::string>& names) {
  const auto source = read_binary(path);
  const Location whole{source, 0, 0};
  NumpyArray loops;
  try {
    loops = read_npy(source->text);
  } catch (const std::runtime_error& e) {
    throw SceneError(whole, e.what());
  }
  if (loops.shape.size() != 3 || loops.values.empty())
    throw SceneError(
        whole, fmt::format("the array has {} dimensions; loops have the shape (bodies, dimension, samples)",
                           loops.shape.size()));
  const std::size_t dimension = loops.shape[1], count = loops.shape[2], n = names.size();
  const std::vector<Body> bodies =
      bodies_of(std::filesystem::path(path).replace_extension(".json"), loops.shape[0]);
  const std::vector<std::size_t> first = arrays_of(names, bodies.size(), whole);
  if (dimension > first.size())
    throw SceneError(whole, fmt::format("the file has {} dimensions, the scene {}", dimension, first.size()));
  GuessFile guess;
  guess.q.assign((count + 1) * n, 0);
  guess.duration = 1;
  for (std::size_t k = 0; k <= count; ++k) guess.t.push_back(double(k) / count);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    const double* loop = loops.values.data() + body.loop * dimension * count;
    const auto shift = std::lround(body.shift * count);
    for (std::size_t k = 0; k <= count; ++k) {
      const long turned = body.direction * (static_cast<long>(k) - shift), samples = static_cast<long>(count);
      const std::size_t at = ((turned % samples) + samples) % samples;
      for (std::size_t d = 0; d < dimension; ++d) {
        double x = body.rotation.empty() ? loop[d * count + at] : 0;
        for (std::size_t e = 0; e < dimension && !body.rotation.empty(); ++e)
          x += body.rotation.at(d).at(e) * loop[e * count + at];
        guess.q[k * n + first[d] + b] = x;
      }
    }
  }
  return guess;
}

}  // namespace extremal
