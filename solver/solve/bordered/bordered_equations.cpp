#include "solve/bordered/bordered_equations.hpp"

#include <algorithm>
#include <cmath>

#include "linear/sparse.hpp"
#include "machine/simd.hpp"
#include "solve/bordered/limits.hpp"

namespace extremal {

void BorderedEquations::reset(const Problem& problem, const ElementTables& tables, const ElementTables& own,
                              const LegMesh& mesh) {
  problem_ = &problem;
  tables_ = &tables;
  own_ = &own;
  mesh_ = mesh;
  n_ = problem.coordinates();
  all_ = tables.coordinates();
  elements_ = mesh.elements();
  inner_ = tables.inner();
  local_ = tables.unknowns();
  leg_.clear();
  for (int l = 0; l < mesh.legs(); ++l) leg_.resize(mesh.first[l + 1], l);
  action_.reset(*extension().lagrangian, tables, elements_, true, Condense::nothing);
  number_unknowns();
  gradient_.resize(2 * static_cast<std::size_t>(all_));
  hessian_.resize(4 * static_cast<std::size_t>(all_) * all_);
  node_gradient_.resize(static_cast<std::size_t>(elements_ + 1) * n_);
}

/// Element by element, so that the matrix is a band with a border.
void BorderedEquations::number_unknowns() {
  const Extension& e = extension();
  std::vector<char> fixed(static_cast<std::size_t>(elements_ + 1) * n_);
  for (std::size_t w = 0; w < e.waypoints.size(); ++w)
    for (const auto& [a, value] : e.waypoints[w].fixed)
      fixed[static_cast<std::size_t>(mesh_.first[w + 1]) * n_ + a] = 1;
  const EndMap& ends = problem_->ends;
  std::vector<int> node(fixed.size(), -1);
  std::vector<int> inner(elements_);  // the first inner unknown of each element
  int next = ends.free;
  for (int k = 0; k < elements_; ++k) {
    inner[k] = next;
    next += inner_ / all_ * n_;
    for (int a = 0; a < n_ && k + 1 < elements_; ++a)
      if (const std::size_t place = static_cast<std::size_t>(k + 1) * n_ + a; !fixed[place])
        node[place] = next++;
  }
  of_path_ = next;
  shares_.clear();
  start_.assign(1, 0);
  for (int k = 0; k < elements_; ++k)
    for (int u = 0; u < local_; ++u) {
      const int a = u % all_, at = k + (u - inner_) / all_;
      if (a >= n_) {
        if (u >= inner_) shares_.push_back({of_path_ + a - n_, 1});
      } else if (u < inner_) {
        shares_.push_back({inner[k] + u / all_ * n_ + a, 1});
      } else if (at > 0 && at < elements_) {
        if (const int unknown = node[static_cast<std::size_t>(at) * n_ + a]; unknown >= 0)
          shares_.push_back({unknown, 1});
      } else {
        for (const Triplet& z : ends.z)
          if (z.row == (at == 0 ? a : n_ + a)) shares_.push_back({z.column, z.value});
      }
      start_.push_back(static_cast<int>(shares_.size()));
    }
  free_times_.clear();
  time_unknown_.assign(mesh_.legs(), -1);
  const int first = first_time();
  for (int l = 0; l < mesh_.legs(); ++l) {
    const bool last = l + 1 == mesh_.legs();
    if (!(last ? problem_->duration.free : e.waypoints[l].free)) continue;
    time_unknown_[l] = first + static_cast<int>(free_times_.size());
    free_times_.push_back(l);
  }
  held_ = problem_->periodic ? static_cast<int>(problem_->symmetries.size()) + problem_->shifts_in_time() : 0;
  unknowns_ = first_held() + held_;
  replaced_.assign(unknowns_, 0);
  closing_rows_.clear();
  for (int k = 0; k < e.unknowns(); ++k) closing_rows_.push_back(first_constant() + k);
  if (problem_->duration.free && !problem_->duration.energy) closing_rows_.push_back(time_unknown_.back());
  for (const int row : closing_rows_) replaced_[row] = 1;
  for (std::size_t l = 0; l + 1 < time_unknown_.size(); ++l)
    if (times_held_ && time_unknown_[l] >= 0) replaced_[time_unknown_[l]] = 1;
}

void BorderedEquations::add(int row, int column, double value) {
  symmetric_.emplace_back(row, column, value);
  if (!replaced_[row]) entries_.emplace_back(row, column, value);
}

void BorderedEquations::add_both(int row, int column, double value) {
  add(row, column, value);
  add(column, row, value);
}

bool BorderedEquations::evaluate(const BorderedState& state, bool matrix) {
  values_.setZero(unknowns_);
  momentum_ = 0;
  std::fill(node_gradient_.begin(), node_gradient_.end(), 0.0);
  if (matrix) {
    entries_.clear();
    symmetric_.clear();
    mass_ = 0;
  }
  add_elements(state, matrix);
  const PathSize size = path_size(state, n_);
  momentum_of_rest_ = size.rests ? mass_ * size.value / state.times.back() : 0;
  if (!action_.finite()) return false;
  const Extension& e = extension();
  target_sizes_.clear();
  for (const double c : e.integrals) target_sizes_.push_back(std::max(1.0, std::abs(c)));
  for (int j = 0; j < e.multipliers(); ++j) values_[first_constant() + e.unknowns() + j] -= e.integrals[j];
  for (std::size_t end = 0; end < problem_->boundary.momenta.size(); ++end) {
    const bool start = end < static_cast<std::size_t>(n_);
    const int place = static_cast<int>(start ? end : end - n_ + all_);
    for (const Share& share : end_shares(place))
      values_[share.unknown] += share.factor * (start ? 1 : -1) * problem_->boundary.momenta[end];
  }
  add_conditions(state, matrix);
  add_closing(state, matrix);
  const std::vector<int> rows = target_rows();
  for (std::size_t i = 0; i < offsets_.size(); ++i) values_[rows[i]] -= offsets_[i];
  if (times_held_)
    for (std::size_t l = 0; l + 1 < time_unknown_.size(); ++l)
      if (const int row = time_unknown_[l]; row >= 0) {
        values_[row] = 0;
        if (matrix) entries_.emplace_back(row, row, 1.0);
      }
  if (matrix && held_ > 0) add_held(state);
  return values_.allFinite();
}

std::vector<int> BorderedEquations::target_rows() const {
  std::vector<int> rows;
  for (int r = first_constant() + extension().unknowns(); r < first_time(); ++r) rows.push_back(r);
  rows.insert(rows.end(), closing_rows_.begin(), closing_rows_.end());
  return rows;
}

std::vector<double> BorderedEquations::targets() const {
  std::vector<double> values;
  for (const int row : target_rows()) values.push_back(values_[row]);
  return values;
}

/// Whether two local unknowns are coordinates at the two ends of an element: these couple by −∂²L/∂q'²/h.
bool BorderedEquations::couples_ends(int row, int column) const {
  const int at = std::min(row, column) - inner_, beside = std::max(row, column) - inner_ - all_;
  return at >= 0 && at < n_ && beside >= 0 && beside < n_;
}

void BorderedEquations::add_elements(const BorderedState& state, bool matrix) {
  const int lanes = simd_lanes();
  action_.visit(state.path, matrix, [&](int batch, const BatchValues& values) {
    for (int k = batch * lanes; k < std::min(elements_, (batch + 1) * lanes); ++k)
      add_element(k, k - batch * lanes, values, state, matrix);
  });
}

/// A free time t_l ends leg l and begins the next: an element of part s of a leg is longer by s δt, or
/// shorter.
void BorderedEquations::add_element(int k, int lane, const BatchValues& values, const BorderedState& state,
                                    bool matrix) {
  const int lanes = simd_lanes(), leg = leg_[k];
  for (int u = 0; u < local_; ++u) {
    const double g = values.gradient[u * lanes + lane];
    for (const Share& share : shares(k, u)) values_[share.unknown] += share.factor * g;
    if (u < inner_ || u % all_ >= n_) continue;
    node_gradient_[static_cast<std::size_t>(k + (u - inner_) / all_) * n_ + u % all_] += g;
    momentum_ = std::max(momentum_, std::abs(g));
  }
  struct Growth {
    int unknown;
    double factor;
  };
  Growth growth[2];
  int count = 0;
  if (time_unknown_[leg] >= 0) growth[count++] = {time_unknown_[leg], mesh_.parts[k]};
  if (leg > 0 && time_unknown_[leg - 1] >= 0) growth[count++] = {time_unknown_[leg - 1], -mesh_.parts[k]};
  for (int i = 0; i < count; ++i) values_[growth[i].unknown] += growth[i].factor * values.slope[lane];
  if (!matrix) return;
  const ElementTables::Entries& places = tables_->entries();
  for (std::size_t e = 0; e < places.row.size(); ++e) {
    const double value = values.entries[e * lanes + lane];
    if (couples_ends(places.row[e], places.column[e]))
      mass_ = std::max(mass_, std::abs(value) * state.path.h(k / lanes)[lane]);
    for (const Share& r : shares(k, places.row[e]))
      for (const Share& c : shares(k, places.column[e])) {
        add(r.unknown, c.unknown, r.factor * c.factor * value);
        if (places.row[e] != places.column[e]) add(c.unknown, r.unknown, r.factor * c.factor * value);
      }
  }
  if (count == 0) return;
  const double scale = state.path.duration() / state.path.h(k / lanes)[lane];  // visit() gives δh = (h/T) δT
  for (int i = 0; i < count; ++i) {
    for (int u = 0; u < local_; ++u)
      for (const Share& share : shares(k, u))
        add_both(share.unknown, growth[i].unknown,
                 share.factor * growth[i].factor * scale * values.border[u * lanes + lane]);
    for (int j = 0; j < count; ++j)
      add(growth[i].unknown, growth[j].unknown,
          growth[i].factor * growth[j].factor * scale * scale * values.corner[lane]);
  }
}

/// Of the condition whose gradient was evaluated last.
double BorderedEquations::size_of_terms(std::span<const double> start, std::span<const double> end) const {
  double size = 1;
  for (int e = 0; e < 2 * all_; ++e)
    size = std::max(size, std::abs(gradient_[e] * (e < all_ ? start[e] : end[e - all_])));
  return size;
}

double BorderedEquations::mismatch() const {
  double most = 0;
  const std::vector<int> rows = target_rows();
  for (std::size_t i = 0; i < rows.size(); ++i)
    most = std::max(most, std::abs(values_[rows[i]]) / target_sizes_[i]);
  return most;
}

double BorderedEquations::energy_jump() const {
  double most = 0;
  for (int row = first_time(); row < first_held(); ++row)
    if (!replaced_[row]) most = std::max(most, std::abs(values_[row]));
  return most;
}

/// Of the function of the ends that was evaluated last.
void BorderedEquations::add_gradient(double factor) {
  for (int e = 0; e < 2 * all_; ++e) {
    if (gradient_[e] == 0) continue;
    for (const Share& share : end_shares(e)) values_[share.unknown] += factor * share.factor * gradient_[e];
  }
}

void BorderedEquations::add_hessian(double factor) {
  for (int e = 0; e < 2 * all_; ++e)
    for (int f = 0; f < 2 * all_; ++f) {
      const double value = factor * hessian_[static_cast<std::size_t>(e) * 2 * all_ + f];
      if (value == 0) continue;
      for (const Share& r : end_shares(e))
        for (const Share& c : end_shares(f)) add(r.unknown, c.unknown, r.factor * c.factor * value);
    }
}

void BorderedEquations::add_conditions(const BorderedState& state, bool matrix) {
  const std::size_t all = all_;
  const std::span<const double> start{state.path.node(0), all}, end{state.path.node(elements_), all};
  const std::span<double> hessian = matrix ? hessian_ : std::span<double>{};
  for (int i = 0; i < conditions(); ++i) {
    const int row = first_multiplier() + i;
    const double eta = state.multipliers[i];
    values_[row] = extension().conditions[i].function(start, end, gradient_, hessian);
    target_sizes_.push_back(size_of_terms(start, end));
    add_gradient(eta);
    if (!matrix) continue;
    for (int e = 0; e < 2 * all_; ++e)
      if (gradient_[e] != 0)
        for (const Share& share : end_shares(e)) add_both(row, share.unknown, share.factor * gradient_[e]);
    add_hessian(eta);
  }
  for (const EndCondition& term : extension().end_terms) {
    term.function(start, end, gradient_, hessian);
    add_gradient(1);
    if (matrix) add_hessian(1);
  }
}

void BorderedEquations::add_closing(const BorderedState& state, bool matrix) {
  if (problem_->duration.energy) values_[time_unknown_.back()] += *problem_->duration.energy;
  const std::size_t all = all_;
  const std::span<const double> start{state.path.node(0), all}, end{state.path.node(elements_), all};
  for (std::size_t i = 0; i < closing_rows_.size(); ++i) {
    const int row = closing_rows_[i];
    values_[row] = extension().where[i].function(start, end, gradient_, {});
    target_sizes_.push_back(size_of_terms(start, end));
    for (int e = 0; e < 2 * all_; ++e) {
      if (gradient_[e] == 0) continue;
      if (matrix)
        for (const Share& share : end_shares(e))
          entries_.emplace_back(row, share.unknown, share.factor * gradient_[e]);
    }
  }
}

/// No step along the directions in which a periodic path may be moved, and a force along them in return.
void BorderedEquations::add_held(const BorderedState& state) {
  without_constants(state.path, *own_, own_path_);
  PhaseConditions found;
  measure_phases(*problem_, own_path_, own_->scheme(), true, found);
  phases_ = independent(found);
  for (int j = 0; j < held_; ++j) {
    const int row = first_held() + j;
    if (j >= phases_.count) {  // one that depends on others
      entries_.emplace_back(row, row, 1.0);
      continue;
    }
    const std::span<const double> direction = phases_.direction(j);
    const auto put = [&](int k, int local, std::size_t place) {
      for (const Share& share : shares(k, local)) {
        entries_.emplace_back(row, share.unknown, share.factor * direction[place]);
        entries_.emplace_back(share.unknown, row, share.factor * direction[place]);
      }
    };
    for (int k = 0; k <= elements_; ++k)
      for (int a = 0; a < n_; ++a)
        k < elements_ ? put(k, inner_ + a, static_cast<std::size_t>(k) * n_ + a)
                      : put(k - 1, inner_ + all_ + a, static_cast<std::size_t>(k) * n_ + a);
  }
}

BorderedEquations::Matrix BorderedEquations::matrix() const {
  Matrix m(unknowns_, unknowns_);
  m.setFromTriplets(entries_.begin(), entries_.end());
  return m;
}

bool BorderedEquations::apply(BorderedState& state, const Eigen::VectorXd& step, double factor) const {
  std::vector<double> times = state.times;
  for (std::size_t i = 0; i < free_times_.size(); ++i)
    times[free_times_[i]] += factor * step[first_time() + static_cast<Eigen::Index>(i)];
  for (int l = 0; l < mesh_.legs(); ++l) {
    const double length = times[l] - (l > 0 ? times[l - 1] : 0);
    if (!(length > limits::bordered::least_leg * state.leg(l))) return false;
  }
  const int lanes = simd_lanes();
  std::vector<double> nodes(state.path.nodes().size());
  AlignedDoubles inner(static_cast<std::size_t>(state.path.batches()) * local_ * lanes);
  for (int k = 0; k < elements_; ++k)
    for (int u = 0; u < local_; ++u) {
      double value = 0;
      for (const Share& share : shares(k, u)) value += share.factor * step[share.unknown];
      if (u < inner_)
        inner[(static_cast<std::size_t>(k / lanes) * local_ + u) * lanes + k % lanes] = value;
      else
        nodes[static_cast<std::size_t>(k) * all_ + u - inner_] = value;
    }
  state.path.add(nodes, inner, factor);
  state.path.load_ends();
  for (int i = 0; i < conditions(); ++i) state.multipliers[i] += factor * step[first_multiplier() + i];
  move_to(state, *tables_, times);
  return true;
}

double BorderedEquations::minimised(const BorderedState& state) const {
  double sum = action_.action();
  const std::vector<double>& momenta = problem_->boundary.momenta;
  for (std::size_t end = 0; end < momenta.size(); ++end)
    sum += end < static_cast<std::size_t>(n_) ? momenta[end] * state.path.node(0)[end]
                                              : -momenta[end] * state.path.node(elements_)[end - n_];
  return sum;
}

Eigen::VectorXd BorderedEquations::node_times(const BorderedState& state) const {
  const int lanes = simd_lanes();
  Eigen::VectorXd times = Eigen::VectorXd::Zero(of_path_);
  for (int k = 0; k < elements_; ++k) {
    const double inside = state.path.h(k / lanes)[k % lanes] / tables_->scheme().degree;
    for (int u = 0; u < local_; ++u)
      for (const Share& share : shares(k, u))
        if (share.unknown < of_path_)
          times[share.unknown] += share.factor * share.factor * (u < inner_ ? inside : inside / 2);
  }
  return times;
}

double BorderedEquations::residual() const {
  return values_.head(of_path_).lpNorm<Eigen::Infinity>() / (momentum() > 0 ? momentum() : 1);
}

std::vector<double> BorderedEquations::units_of_times() const {
  std::vector<double> diagonal(unknowns_), beside(unknowns_), units(unknowns_, 1.0);
  double largest = 0;
  for (const auto& e : symmetric_) {
    if (e.row() < of_path_ && e.col() < of_path_) largest = std::max(largest, std::abs(e.value()));
    (e.row() == e.col() ? diagonal : beside)[e.row()] += std::abs(e.value());
  }
  for (int row = first_time(); row < first_held(); ++row) {
    const double size = std::max(std::sqrt(diagonal[row] * largest), beside[row]);
    if (size > 0) units[row] = largest / size;
  }
  return units;
}

/// What is held has multipliers of its own units, in which its derivatives may be large or small beside the
/// second variation: in units in which both are as large, neither counts for the other's roundoff. Entries of
/// the second variation are those of numbers below `varied`. Returns its largest.
double BorderedEquations::unite_conditions(int varied, const std::vector<int>& number,
                                           std::vector<double>& units) const {
  double largest = 0;
  std::vector<double> slopes(unknowns_);
  const auto measure = [&](const Eigen::Triplet<double>& e) {
    const int r = number[e.row()], c = number[e.col()];
    if (r < 0 || c < 0) return;
    const double size = std::abs(units[e.row()] * units[e.col()] * e.value());
    if (r < varied && c < varied) largest = std::max(largest, size);
    if (r >= varied && c < varied) slopes[e.row()] = std::max(slopes[e.row()], size);
  };
  for (const auto& e : symmetric_) measure(e);
  for (const auto& e : entries_)
    if (e.row() >= first_held()) measure(e);
  for (int row = 0; row < unknowns_; ++row)
    if (slopes[row] > 0 && largest > 0) units[row] *= largest / slopes[row];
  return largest;
}

Inertia BorderedEquations::inertia() const {
  // Columns of the matrix that are kept: the path, times of waypoints, ν, η and the directions held.
  std::vector<int> number(unknowns_, -1);
  int size = 0;
  for (int u = 0; u < of_path_; ++u) number[u] = size++;
  for (std::size_t l = 0; l + 1 < time_unknown_.size(); ++l)
    if (time_unknown_[l] >= 0) number[time_unknown_[l]] = size++;
  const int varied = size;
  for (int u = first_constant() + extension().unknowns(); u < first_time(); ++u) number[u] = size++;
  const int conditions = size - varied;
  const int held = phases_.count;
  for (int j = 0; j < held; ++j) number[first_held() + j] = size++;
  std::vector<double> units = units_of_times();
  const double largest = unite_conditions(varied, number, units);
  std::vector<int> rows, columns;
  std::vector<double> values;
  const auto take = [&](const Eigen::Triplet<double>& e) {
    const int r = number[e.row()], c = number[e.col()];
    if (r < 0 || c < 0 || r < c) return;  // the other triangle is its mirror image
    rows.push_back(r);
    columns.push_back(c);
    values.push_back(units[e.row()] * units[e.col()] * e.value());
  };
  for (const auto& e : symmetric_) take(e);
  if (held > 0)
    for (const auto& e : entries_)
      if (e.row() >= first_held() && e.row() < first_held() + held) take(e);
  const std::size_t entries = values.size();
  for (int u = 0; u < size; ++u) {
    rows.push_back(u);
    columns.push_back(u);
  }
  SparseSymmetric matrix;
  matrix.pattern(size, rows, columns);
  const auto shifted = [&](double shift) {
    std::copy(values.begin(), values.end(), matrix.values());
    std::fill_n(matrix.values() + entries, size, shift);
    matrix.factor();
    return matrix.inertia();
  };
  const double null = limits::bordered::null_eigenvalue * largest;
  Inertia result;
  result.negative = shifted(null).negative - conditions - held;
  result.positive = shifted(-null).positive - conditions - held;
  result.zero = varied - conditions - held - result.negative - result.positive + held;
  return result;
}

}  // namespace extremal
