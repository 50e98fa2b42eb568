#include "python/pickle.hpp"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"

namespace extremal::python {
namespace py = pybind11;
namespace {

/// All members of a type as references. A member that is added to one of them does not compile here until it
/// is named: no pickle loses one.
auto members(Trajectory& s) {
  auto& [coordinates, degree, times, nodes, slopes, lengths] = s;
  return std::tie(coordinates, degree, times, nodes, slopes, lengths);
}

auto members(Iteration& s) {
  auto& [elements, degree, residual, step, damping] = s;
  return std::tie(elements, degree, residual, step, damping);
}

auto members(Floquet& s) {
  auto& [paired, multipliers, krein, vectors, defect, trivial, circle, real, quadruples] = s;
  return std::tie(paired, multipliers, krein, vectors, defect, trivial, circle, real, quadruples);
}

auto members(DecayRates& s) {
  auto& [start, end] = s;
  return std::tie(start, end);
}

auto members(WaypointImpulse& s) {
  auto& [time, impulse] = s;
  return std::tie(time, impulse);
}

/// But for the Lagrangian and the manifold, which the study has.
auto members(ExtensionValues& s) {
  auto& [constants, integral_multipliers, waypoints, lagrangian, manifold] = s;
  return std::tie(constants, integral_multipliers, waypoints);
}

auto members(Contact& s) {
  auto& [constraint, from, to] = s;
  return std::tie(constraint, from, to);
}

/// But for the manifold, which the study has.
auto members(PathContacts::Arc& s) {
  auto& [from, to, held, manifold] = s;
  return std::tie(from, to, held);
}

auto members(PathContacts& s) {
  auto& [constraints, contacts, arcs] = s;
  return std::tie(constraints, contacts, arcs);
}

auto members(Solution& s) {
  auto& [status, message, strategy, trajectory, action, energy, drift, work, error, residual, index, nullity,
         minimizing, windows, conjugate, conjugate_known, certificate, floquet, period, rates, momentum_start,
         momentum_end, extension, contacts, pinned, energies, degree, unknowns, iterations, history,
         seconds_solve, seconds_analyse] = s;
  return std::tie(status, message, strategy, trajectory, action, energy, drift, work, error, residual, index,
                  nullity, minimizing, windows, conjugate, conjugate_known, certificate, floquet, period,
                  rates, momentum_start, momentum_end, extension, contacts, pinned, energies, degree,
                  unknowns, iterations, history, seconds_solve, seconds_analyse);
}

auto members(Fitted::Column& s) {
  auto& [name, observed, residual, sigma] = s;
  return std::tie(name, observed, residual, sigma);
}

auto members(Fitted& s) {
  auto& [parameters, open_ends, values, covariance, scaled, chi_squared, freedom, t, columns] = s;
  return std::tie(parameters, open_ends, values, covariance, scaled, chi_squared, freedom, t, columns);
}

auto members(BranchPoint& s) {
  auto& [parameter, kind, branch, solution, momentum_difference, resolved] = s;
  return std::tie(parameter, kind, branch, solution, momentum_difference, resolved);
}

auto members(BranchRecord& s) {
  auto& [origin, end, message, points, action_slope, momentum] = s;
  return std::tie(origin, end, message, points, action_slope, momentum);
}

auto members(FollowedBranch& s) {
  auto& [title, parameter, names, points, branches] = s;
  return std::tie(title, parameter, names, points, branches);
}

template <class T>
concept HasMembers = requires(T& value) {
  members(value);
};

template <class T>
py::object pack(T& value);
template <class T>
void unpack(const py::handle& packed, T& value);

/// Long lists of numbers are bytes.
py::object pack(std::vector<double>& numbers) {
  return py::bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
}
void unpack(const py::handle& packed, std::vector<double>& numbers) {
  const std::string bytes = packed.cast<py::bytes>();
  numbers.resize(bytes.size() / sizeof(double));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
}

template <HasMembers T>
py::object pack(std::optional<T>& value) {
  return value ? pack(*value) : py::none();
}
template <HasMembers T>
void unpack(const py::handle& packed, std::optional<T>& value) {
  if (!packed.is_none()) unpack(packed, value.emplace());
}

template <HasMembers T>
py::object pack(std::shared_ptr<const T>& value) {
  if (!value) return py::none();
  T copy = *value;
  return pack(copy);
}
template <HasMembers T>
void unpack(const py::handle& packed, std::shared_ptr<const T>& value) {
  if (packed.is_none()) return;
  T unpacked;
  unpack(packed, unpacked);
  value = std::make_shared<const T>(std::move(unpacked));
}

template <HasMembers T>
py::object pack(std::vector<T>& values) {
  py::list list;
  for (T& value : values) list.append(pack(value));
  return list;
}
template <HasMembers T>
void unpack(const py::handle& packed, std::vector<T>& values) {
  for (const py::handle& value : packed.cast<py::list>()) unpack(value, values.emplace_back());
}

template <class T>
py::object pack(T& value) {
  if constexpr (HasMembers<T>)
    return std::apply([](auto&... member) -> py::object { return py::make_tuple(pack(member)...); },
                      members(value));
  else if constexpr (std::is_enum_v<T>)
    return py::int_(static_cast<int>(value));
  else
    return py::cast(value);
}

template <class T>
void unpack(const py::handle& packed, T& value) {
  if constexpr (HasMembers<T>) {
    const auto state = packed.cast<py::tuple>();
    std::size_t k = 0;
    std::apply(
        [&](auto&... member) {
          if (state.size() != sizeof...(member)) throw std::invalid_argument("pickled by another version");
          (unpack(state[k++], member), ...);
        },
        members(value));
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(packed.cast<int>());
  } else {
    value = packed.cast<T>();
  }
}

}  // namespace

py::tuple packed(const Solution& solution) {
  Solution copy = solution;
  return pack(copy);
}

py::object packed(const std::shared_ptr<const Fitted>& fit) {
  std::shared_ptr<const Fitted> copy = fit;
  return pack(copy);
}

std::shared_ptr<const Fitted> unpacked_fit(const py::handle& state) {
  std::shared_ptr<const Fitted> fit;
  unpack(state, fit);
  return fit;
}

py::tuple packed(const FollowedBranch& branch) {
  FollowedBranch copy = branch;
  return pack(copy);
}

FollowedBranch unpacked_branch(const py::tuple& state) {
  FollowedBranch branch;
  unpack(state, branch);
  return branch;
}

Solution unpacked(const py::tuple& state) {
  Solution solution;
  unpack(state, solution);
  return solution;
}

}  // namespace extremal::python
