#include "report/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "report/file.hpp"
#include "report/json_parts.hpp"
#include "solution/extension_values.hpp"
#include "solution/path_contacts.hpp"

namespace extremal {

namespace {

/// The fields of one result but for the samples.
class Fields {
 public:
  explicit Fields(const Result& result) : result_(result), converged_(result.solution.converged()) {
    texts();
    numbers();
    stability();
    append(object_, "momentum_start", momentum("momentum_start", result.solution.momentum_start));
    append(object_, "momentum_end", momentum("momentum_end", result.solution.momentum_end));
    multipliers();
    if (converged_ && result.solution.extension) extension(*result.solution.extension);
    if (converged_ && result.solution.contacts) contacts(*result.solution.contacts);
    if (converged_ && result.spectrum) spectrum(*result.spectrum);
    if (converged_ && result.fit) fit(*result.fit);
    counts();
  }

  const Json& object() const { return object_; }

 private:
  void texts() {
    append(object_, "status", name(result_.solution.status));
    append(object_, "message", result_.solution.message);
    append(object_, "strategy", result_.solution.strategy);
    append(object_, "title", result_.title);
  }

  /// Without a trajectory there is nothing that these could belong to, and without convergence no extremal
  /// whose error could be estimated.
  void numbers() {
    const Solution& solution = result_.solution;
    const bool any = converged_ || solution.trajectory.elements() > 0;
    const auto known = [](bool condition, double value) {
      return condition ? std::optional<double>(value) : std::nullopt;
    };
    append_number("duration", known(any, solution.duration()));
    append_number("action", known(any, solution.action));
    append_number("energy", solution.energy);
    append_number("energy_drift", solution.energy_drift);
    if (solution.work) append_number("work", solution.work);
    if (converged_ && solution.rates) rates(*solution.rates);
    append_number("error_estimate", known(converged_, solution.error_estimate));
    append_number("residual", known(any, solution.residual));
  }

  /// Of the infinite ends.
  void rates(const DecayRates& rates) {
    Json object = Json::object();
    if (rates.start) append(object, "start", number("rates.start", *rates.start));
    if (rates.end) append(object, "end", number("rates.end", *rates.end));
    append(object_, "rates", std::move(object));
  }

  void stability() {
    const auto count = [](const std::optional<int>& value) { return value ? Json(*value) : Json(nullptr); };
    append(object_, "morse_index", count(result_.solution.morse_index));
    append(object_, "nullity", count(result_.solution.nullity));
    // Without an index it is known of paths under inequalities alone, all of which are minimisers.
    const bool known = !converged_ || result_.solution.morse_index || result_.solution.contacts;
    append(object_, "minimizing", known ? Json(result_.solution.minimizing) : Json(nullptr));
    windows();
  }

  /// Null where they are not known.
  void windows() {
    const Solution& solution = result_.solution;
    const bool known = converged_ && solution.certificate != Certificate::none;
    append(object_, "certificate", known ? Json(name(solution.certificate)) : Json(nullptr));
    Json windows = Json::array(), times = Json::array();
    for (const auto& [from, to] : solution.windows)
      windows.push_back({number("windows", from), number("windows", to)});
    for (double time : solution.conjugate_times) times.push_back(number("conjugate_times", time));
    append(object_, "windows", known ? std::move(windows) : Json(nullptr));
    const bool times_known = known && solution.conjugate_times_known;
    append(object_, "conjugate_times", times_known ? std::move(times) : Json(nullptr));
  }

  /// Null where the orbit is not periodic and where they are not known.
  void multipliers() {
    const Floquet* floquet = converged_ && result_.solution.floquet ? &*result_.solution.floquet : nullptr;
    Json values = Json::array();
    if (floquet)
      for (const std::complex<double>& value : floquet->multipliers)
        values.push_back({number("multipliers", value.real()), number("multipliers", value.imag())});
    append(object_, "multipliers", floquet ? std::move(values) : Json(nullptr));
    const bool paired = floquet && floquet->paired;
    append(object_, "krein", paired ? Json(floquet->krein) : Json(nullptr));
    if (converged_ && result_.solution.minimal_period)
      append_number("minimal_period", result_.solution.minimal_period);
    append_number("symplectic_defect", paired ? std::optional(floquet->symplectic_defect) : std::nullopt);
  }

  /// Multipliers of integrals, impulses at waypoints.
  void extension(const ExtensionValues& values) {
    if (!values.integral_multipliers.empty()) {
      Json multipliers = Json::array();
      for (const double nu : values.integral_multipliers)
        multipliers.push_back(number("integral_multipliers", nu));
      append(object_, "integral_multipliers", std::move(multipliers));
    }
    if (values.waypoints.empty()) return;
    Json waypoints = Json::array();
    for (const WaypointImpulse& waypoint : values.waypoints) {
      Json impulse = Json::object();
      for (const auto& [a, jump] : waypoint.impulse)
        append(impulse, result_.names.at(a), number("waypoints.impulse", jump));
      Json object = Json::object();
      append(object, "t", number("waypoints.t", waypoint.time));
      append(object, "impulse", std::move(impulse));
      waypoints.push_back(std::move(object));
    }
    append(object_, "waypoints", std::move(waypoints));
  }

  void contacts(const PathContacts& found) {
    Json list = Json::array();
    for (const Contact& contact : found.contacts) {
      Json object = Json::object();
      append(object, "constraint", contact.constraint);
      append(object, "from", number("contacts.from", contact.from));
      append(object, "to", number("contacts.to", contact.to));
      list.push_back(std::move(object));
    }
    append(object_, "contacts", std::move(list));
  }

  void spectrum(const SolutionSpectrum& spectrum) {
    Json lines = Json::object();
    for (std::size_t a = 0; a < result_.names.size(); ++a) {
      Json list = Json::array();
      for (const SpectralLine& line : spectrum.motion.coordinates.at(a).lines) {
        Json object = Json::object();
        append(object, "frequency", number("spectrum", line.frequency));
        append(object, "amplitude", number("spectrum", line.amplitude));
        append(object, "phase", number("spectrum", line.phase));
        list.push_back(std::move(object));
      }
      append(lines, result_.names[a], std::move(list));
    }
    append(object_, "spectrum", std::move(lines));
    std::vector<double> left;
    for (const Spectrum& each : spectrum.motion.coordinates) left.push_back(each.residual);
    append(object_, "spectrum_residual", by_name("spectrum_residual", left));
    append(object_, "drift", by_name("drift", spectrum.motion.drift));
    if (!spectrum.flat_norm.empty()) append(object_, "flat_norm", by_name("flat_norm", spectrum.flat_norm));
  }

  void fit(const Fitted& fit) {
    const auto values = [&](const std::vector<std::string>& names, std::size_t first) {
      Json object = Json::object();
      for (std::size_t k = 0; k < names.size(); ++k)
        append(object, names[k], number("parameters." + names[k], fit.values.at(first + k)));
      return object;
    };
    append(object_, "parameters", values(fit.parameters, 0));
    append(object_, "open_ends", values(fit.open_ends, fit.parameters.size()));
    Json rows = Json::array();
    for (const std::vector<double>& row : fit.covariance) {
      Json entries = Json::array();
      for (const double x : row) entries.push_back(number("covariance", x));
      rows.push_back(std::move(entries));
    }
    append(object_, "covariance", std::move(rows));
    append(object_, "covariance_scaled", fit.scaled);
    append(object_, "chi_squared", number("chi_squared", fit.chi_squared));
    append(object_, "degrees_of_freedom", fit.freedom);
    const auto columns = [&](const char* field, auto member, Json object = Json::object()) {
      for (const Fitted::Column& column : fit.columns) {
        Json values = Json::array();
        for (const std::optional<double>& x : column.*member)
          values.push_back(x ? number(field, *x) : Json(nullptr));
        append(object, column.name, std::move(values));
      }
      append(object_, field, std::move(object));
    };
    Json times = Json::object();
    append(times, "t", Json(fit.t));
    columns("residuals", &Fitted::Column::residual, std::move(times));
    columns("observed", &Fitted::Column::observed);
    const auto known = [](const Fitted::Column& column) {
      return std::ranges::any_of(column.sigma, [](const auto& x) { return x.has_value(); });
    };
    if (std::ranges::any_of(fit.columns, known)) columns("sigma", &Fitted::Column::sigma);
  }

  /// The ends of elements of a scheme that was asked for.
  void nodes() {
    const Trajectory& trajectory = result_.solution.trajectory;
    const std::size_t n = trajectory.coordinates, s = trajectory.degree;
    const auto value = [&](int k, std::size_t a) {
      const std::size_t first = k < trajectory.elements() ? k * (s + 1) : (k - 1) * (s + 1) + s;
      return trajectory.nodes[first * n + a];
    };
    Json object = Json::object();
    const auto list = [&](const std::string& key, const std::vector<double>& values) {
      Json numbers = Json::array();
      for (const double x : values) numbers.push_back(number("nodes." + key, x));
      append(object, key, std::move(numbers));
    };
    list("t", trajectory.times);
    std::vector<double> column(trajectory.times.size());
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t k = 0; k < column.size(); ++k) column[k] = value(static_cast<int>(k), a);
      const std::size_t names = result_.names.size();  // in phase space momenta follow
      list(a < names ? result_.names[a] : momentum_key(result_.names[a - names]), column);
    }
    if (!result_.solution.element_energies.empty()) list("energy", result_.solution.element_energies);
    append(object_, "nodes", std::move(object));
  }

  void counts() {
    const Solution& solution = result_.solution;
    if (converged_ && solution.pinned) nodes();
    append(object_, "elements", std::max(0, solution.trajectory.elements()));
    append(object_, "degree", solution.degree);
    append(object_, "unknowns", unknowns());
    append(object_, "iterations", solution.iterations);
    Json seconds = Json::object();
    append(seconds, "read", number("seconds.read", result_.seconds_read));
    append(seconds, "solve", number("seconds.solve", solution.seconds_solve));
    append(seconds, "analyse", number("seconds.analyse", solution.seconds_analyse));
    append(object_, "seconds", std::move(seconds));
  }

  /// The constants that were asked for; elsewhere how many unknowns the equations had.
  Json unknowns() const {
    const auto& extension = result_.solution.extension;
    if (!converged_ || !extension || extension->unknowns.empty()) return result_.solution.unknowns;
    Json values = Json::object();
    for (const auto& [name, value] : extension->unknowns) append(values, name, number("unknowns", value));
    return values;
  }

  Json momentum(const std::string& field, const std::vector<double>& values) const {
    if (values.size() != result_.names.size()) {
      if (!converged_ || values.empty()) return nullptr;  // infinite where L is
      throw std::invalid_argument(
          fmt::format("{} has {} entries for {} coordinates", field, values.size(), result_.names.size()));
    }
    return by_name(field, values);
  }

  Json by_name(const std::string& field, const std::vector<double>& values) const {
    Json object = Json::object();
    for (std::size_t a = 0; a < values.size(); ++a)
      append(object, result_.names[a], number(field + "." + result_.names[a], values[a]));
    return object;
  }

  void append_number(const char* field, const std::optional<double>& value) {
    append(object_, field, value ? number(field, *value) : Json(nullptr));
  }

  Json number(const std::string& field, double value) const {
    if (std::isfinite(value)) return value;
    if (converged_) refuse_number(field, value);
    return nullptr;
  }

  const Result& result_;
  bool converged_;
  Json object_ = Json::object();
};

/// An object that begins where the stream is; its lines are indented by two more than `indent`.
void write_object(std::ostream& out, const std::string& indent, const Result& result) {
  const Fields fields(result);
  const std::string inner = indent + "  ";
  const char* separator = "{\n";
  for (const auto& [key, value] : fields.object().items()) {
    out << separator << inner << dumped(key) << ": " << dumped(value);
    separator = ",\n";
  }
  if (result.samples && result.solution.converged()) write_samples(out, inner, *result.samples, result.names);
  write_surroundings(out, inner, result);
  if (result.solutions) {
    out << ",\n" << inner << "\"solutions\": [";
    for (std::size_t k = 0; k < result.solutions->size(); ++k) {
      out << (k == 0 ? "" : ", ");
      write_object(out, inner, (*result.solutions)[k]);
    }
    out << "]";
  }
  out << "\n" << indent << "}";
}

}  // namespace

void write_json(std::ostream& out, const Result& result) {
  write_object(out, "", result);
  out << "\n";
}

void write_json(const std::string& path, const Result& result) {
  write_file(path, [&](std::ostream& out) { write_json(out, result); });
}

}  // namespace extremal
