#include "python/files.hpp"

#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "python/arrays.hpp"
#include "python/solution.hpp"
#include "python/study.hpp"
#include "report/csv.hpp"
#include "report/file.hpp"
#include "report/json.hpp"
#include "report/oem.hpp"
#include "report/sampling.hpp"
#include "study/phase.hpp"

namespace extremal::python {
namespace {

/// Solutions of one study, the times of the samples of each, and whether they are those of a search.
struct Written {
  std::vector<std::shared_ptr<Solved>> solutions;
  std::vector<std::optional<Doubles>> times;
  bool search;

  const Study& study() const { return *solutions.front()->study; }
  std::vector<std::string> names() const { return coordinate_names(study().problem); }

  Samples samples(std::size_t k) const {
    const Solved& s = *solutions.at(k);
    return sample(s.study->problem, s.solution, list(times.at(k).value()));
  }
  std::vector<Samples> all_samples() const {
    std::vector<Samples> all;
    for (std::size_t k = 0; k < solutions.size(); ++k) all.push_back(samples(k));
    return all;
  }

  Result result(std::size_t k) const {
    const Solved& s = *solutions.at(k);
    Result result = result_of(s);
    if (!s.solution.converged()) return result;
    if (times.at(k)) result.samples = samples(k);
    if (s.study->spectrum) add_spectrum(*s.study, *s.study->spectrum, result);
    return result;
  }
  Result whole_result() const {
    Result whole = result(0);
    if (search) {
      whole.solutions.emplace();
      for (std::size_t k = 0; k < solutions.size(); ++k) whole.solutions->push_back(result(k));
    }
    add_surroundings(study(), whole);
    return whole;
  }
};

void write_ephemeris(std::ostream& out, const Written& written) {
  const Study& study = written.study();
  if (!study.units)
    throw std::invalid_argument("the problem has no units; give length, time, frame, centre and epoch");
  write_oem(out, *study.units, study.title, written.names(), written.samples(0));
}

void write_table(std::ostream& out, const Written& written) {
  if (written.search)
    write_csv(out, written.all_samples(), written.names());
  else
    write_csv(out, written.samples(0), written.names());
}

/// By the ending of the path. The lock of Python is kept: interrupts are held for one file at a time.
void save(const std::string& path, const Written& written) {
  if (path.ends_with(".npz")) return write_files({{path, npz_text(written.samples(0), written.names())}});
  write_file(path, [&](std::ostream& out) {
    if (path.ends_with(".json")) return write_json(out, written.whole_result());
    path.ends_with(".oem") ? write_ephemeris(out, written) : write_table(out, written);
  });
}

std::string json(const Written& written) {
  return text_of([&](std::ostream& out) { write_json(out, written.whole_result()); });
}

}  // namespace

void bind_files(py::module_& module) {
  using Solutions = std::vector<std::shared_ptr<Solved>>;
  using Times = std::vector<std::optional<Doubles>>;
  module.def(
      "save",
      [](const std::string& path, const Solutions& solutions, const Times& times, bool search) {
        save(path, {solutions, times, search});
      },
      py::arg("path"), py::arg("solutions"), py::arg("times"), py::arg("search"));
  module.def(
      "json",
      [](const Solutions& solutions, const Times& times, bool search) {
        return json({solutions, times, search});
      },
      py::arg("solutions"), py::arg("times"), py::arg("search"));
}

}  // namespace extremal::python
