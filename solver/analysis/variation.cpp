#include "analysis/variation.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "action/rule.hpp"
#include "analysis/limits.hpp"
#include "machine/simd.hpp"

namespace extremal {

namespace {

/// Of the polynomials. The higher, the fewer pieces; with many coordinates they must stay small.
constexpr int usual_degree = 12, middle_degree = 8, highest_degree = 20;
constexpr int few_coordinates = 16, many_coordinates = 60;
/// The two highest Legendre coefficients of a Jacobi field, relative to its largest. The error of the field
/// is some two orders below, that of A, B, D its square.
constexpr double allowed_tail = 1e-7;
/// Pivots this small against the entry they came from: the ends of a piece are nearly conjugate.
constexpr double least_pivot = 1e-3;
/// Doubles kept of inner fields.
constexpr std::size_t most_kept = 1 << 23;
/// Of an element, halved again and again.
constexpr double shortest_part = 0x1p-12;
/// Of T, and at most half a piece: a point that is on one side of the kink at its end.
constexpr double beside_kink = 0x1p-40;
/// Pieces, or so many of an element, at most.
constexpr int most_pieces = 1 << 14, most_of_element = 16;

/// Weights of the nodes for the value at tau of the polynomial through them.
void weigh_nodes(const Barycentric& at, double tau, std::span<double> weights) {
  const auto node = std::ranges::find(at.nodes, tau);
  if (node != at.nodes.end()) {
    std::ranges::fill(weights, 0.0);
    weights[node - at.nodes.begin()] = 1;
    return;
  }
  double sum = 0;
  for (std::size_t j = 0; j < at.nodes.size(); ++j) sum += weights[j] = at.weights[j] / (tau - at.nodes[j]);
  for (double& weight : weights) weight /= sum;
}

int degree_for(int n, int trajectory_degree) {
  if (n <= few_coordinates) return std::max(usual_degree, std::min(trajectory_degree + 3, highest_degree));
  return n <= many_coordinates ? usual_degree : middle_degree;
}

}  // namespace

void SecondVariation::begin(std::shared_ptr<const Lagrangian> lagrangian, const Trajectory& trajectory) {
  lagrangian_ = std::move(lagrangian);
  trajectory_ = &trajectory;
  clear();
}

void SecondVariation::clear() {
  pieces_.clear();
  forms_.clear();
  switches_.clear();
  forms_from_ = 0;
  too_many_ = too_large_ = of_scheme_ = false;
}

bool SecondVariation::assemble_elements(std::shared_ptr<const Lagrangian> lagrangian,
                                        const Trajectory& trajectory, const Path& path,
                                        const ElementTables& tables, const ClosingMap* closed) {
  begin(std::move(lagrangian), trajectory);
  of_scheme_ = true;
  scheme_ = &tables.scheme();
  action_.reset(*lagrangian_, tables, path.elements(), false, Condense::elements);
  action_.evaluate(path);
  if (!action_.finite()) return false;
  keep_elements(action_);
  if (lagrangian_->kinks()) find_crossings(closed);
  forget();
  return true;
}

bool SecondVariation::assemble(std::shared_ptr<const Lagrangian> lagrangian, const Trajectory& trajectory,
                               const Condensed& condensed, const ClosingMap* closed, Definite definite) {
  const bool bound = lagrangian_ == lagrangian;
  begin(std::move(lagrangian), trajectory);
  const int degree = degree_for(trajectory.coordinates, trajectory.degree);
  const SchemeTables& scheme = SchemeTables::of_order(degree, *lagrangian_);
  const bool made = scheme_ == &scheme;
  scheme_ = &scheme;
  if (!made || !bound) tables_.bind(*scheme_, *lagrangian_);
  too_large_ = double(tables_.condensation().fronts.groups()) * simd_lanes() > limits::variation::most_batch;
  if (too_large_) return false;
  definite_ = definite;
  const bool taken = condensed.action && take(condensed), regular = taken || cut();
  if (!regular) pieces_.clear();
  if (regular && lagrangian_->kinks()) find_crossings(closed);
  evaluated_ = regular && !taken ? pieces_.back().first : -1;
  forget();
  return regular;
}

/// Where the path crosses a kink the momentum of a Jacobi field jumps: the piece that ends there has it.
void SecondVariation::find_crossings(const ClosingMap* closed) {
  const std::size_t size = static_cast<std::size_t>(coordinates()) * coordinates();
  const Polynomials path{coordinates(), trajectory_->degree, trajectory_->times, trajectory_->nodes};
  for (const Corner& corner : corners_of(*lagrangian_->kinks(), path, closed))
    for (std::size_t k = 0; k < forms_.size() / (3 * size); ++k) {
      const Part& part = pieces_[forms_from_ + k].part;
      if (part.element == corner.node - 1 && part.tau1 == 1)
        add_stiffness(corner, forms_.data() + (3 * k + 2) * size);
    }
  switches_ = switches_of(*lagrangian_->kinks(), path, closed);
}

std::vector<Switch> SecondVariation::switches_after(int k) const {
  std::vector<Switch> found;
  const Part& part = pieces_[k].part;
  for (const Switch& at : switches_)
    if (part.element == at.node - 1 && part.tau1 == 1) found.push_back(at);
  return found;
}

Piece SecondVariation::piece(int k) const {
  const int n = coordinates();
  const double* forms = forms_.data() + static_cast<std::size_t>(k - forms_from_) * 3 * n * n;
  return {
      pieces_[k].start, pieces_[k].length, {forms, n, n}, {forms + n * n, n, n}, {forms + 2 * n * n, n, n}};
}

int SecondVariation::piece_at(double t) const {
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end() - 1, t,
                                      [](double time, const Kept& k) { return time < k.start + k.length; });
  return static_cast<int>(after - pieces_.begin());
}

/// p' = ∂L/∂q; within the piece, since it may start at a kink, or T be one.
Eigen::VectorXd SecondVariation::shift(int k) const {
  const int n = coordinates();
  const double t = k < count() ? pieces_[k].start : trajectory_->duration();
  std::vector<double> q(n), v(n);
  const Part& part = pieces_[std::min(k, count() - 1)].part;
  const double beside = beside_kink * trajectory_->duration() / trajectory_->length(part.element);
  const double within = lagrangian_->kinks() ? std::min((part.tau1 - part.tau0) / 2, beside) : 0;
  trajectory_->in_element(part.element, k < count() ? part.tau0 + within : part.tau1 - within, q, v);
  Scratch memory;
  const PointValues values = evaluate_at(*lagrangian_, q, v, t, Order::gradient, memory);
  Eigen::VectorXd field(2 * n);
  for (int a = 0; a < n; ++a) {
    field[a] = v[a];
    field[n + a] = values.dq[a];
  }
  return field;
}

/// Evaluates parts, a batch at a time, in the order of time, and halves those that are too long.
bool SecondVariation::cut() {
  const int most = std::max(most_pieces, most_of_element * trajectory_->elements());
  waiting_.clear();  // the next one last
  for (int k = trajectory_->elements(); k-- > 0;) waiting_.push_back({k, 0, 1});
  while (!waiting_.empty()) {
    const std::size_t count = std::min<std::size_t>(simd_lanes(), waiting_.size());
    batch_.assign(waiting_.rbegin(), waiting_.rbegin() + count);
    evaluate(batch_);
    if (!action_.finite()) return false;
    waiting_.resize(waiting_.size() - count);
    if (resolved(action_, static_cast<int>(count), allowed_tail)) {
      keep(action_, batch_);
      too_many_ = this->count() + static_cast<int>(waiting_.size()) > most;
      if (too_many_) return false;
      continue;
    }
    for (auto part = batch_.rbegin(); part != batch_.rend(); ++part) {
      const double middle = (part->tau0 + part->tau1) / 2;
      if (part->tau1 - part->tau0 < shortest_part) return false;
      waiting_.push_back({part->element, middle, part->tau1});
      waiting_.push_back({part->element, part->tau0, middle});
    }
  }
  return true;
}

void SecondVariation::evaluate(std::span<const Part> parts) {
  const int n = coordinates(), s = trajectory_->degree, count = static_cast<int>(parts.size());
  mesh_.clear();
  lengths_.clear();
  for (const Part& part : parts) {
    mesh_.push_back(start(part));
    lengths_.push_back(length(part));
  }
  mesh_.push_back(mesh_.back() + lengths_.back());
  path_.reset(tables_, mesh_, 1, lengths_);
  const int points = scheme_->functions;
  values_.resize(static_cast<std::size_t>(points) * n);
  weights_.resize(static_cast<std::size_t>(points) * (s + 1));
  for (int k = 0; k < count; ++k) {
    const Part& part = parts[k];
    // Most parts are the same of their elements.
    if (k == 0 || part.tau0 != parts[k - 1].tau0 || part.tau1 != parts[k - 1].tau1)
      for (int j = 0; j < points; ++j)
        weigh_nodes(lobatto_barycentric(s), part.tau0 + scheme_->lobatto[j] * (part.tau1 - part.tau0),
                    std::span(weights_).subspan(static_cast<std::size_t>(j) * (s + 1), s + 1));
    const double* nodes = trajectory_->nodes.data() + static_cast<std::size_t>(part.element) * (s + 1) * n;
    std::ranges::fill(values_, 0.0);
    for (int j = 0; j < points; ++j)
      for (int i = 0; i <= s; ++i) {
        const double weight = weights_[j * (s + 1) + i];
        for (int a = 0; a < n; ++a) values_[j * n + a] += weight * nodes[i * n + a];
      }
    path_.set_apart(k, values_.data());
  }
  action_.reset(*lagrangian_, tables_, count, false, Condense::elements);
  action_.evaluate(path_);
}

/// Elements that were condensed by another, if they are short enough.
bool SecondVariation::take(const Condensed& condensed) {
  if (!resolved(*condensed.action, trajectory_->elements(), condensed.tail)) return false;
  keep_elements(*condensed.action);
  return true;
}

void SecondVariation::keep_elements(const DiscreteAction& action) {
  batch_.clear();
  for (int k = 0; k < trajectory_->elements(); ++k) batch_.push_back({k, 0, 1});
  keep(action, batch_);
}

/// Whether pieces are short enough, tried with one Jacobi field that has a share of all.
bool SecondVariation::resolved(const DiscreteAction& action, int count, double allowed) {
  const int paired = count * action.tables().inner() / 2;
  const int negative = definite_ == Definite::paired ? paired : 0;
  if (definite_ != Definite::none && action.nodes.negative != negative) return false;
  if (!(action.nodes.pivot_ratio > least_pivot)) return false;
  const SchemeTables& scheme = action.tables().scheme();
  const int n = coordinates(), functions = scheme.functions;
  steps_.resize(static_cast<std::size_t>(count + 1) * n);
  for (std::size_t i = 0; i < steps_.size(); ++i) steps_[i] = std::cos(1 + 2.4 * i);
  action.expand_step(steps_, 0, inner_);
  std::fill(steps_.begin(), steps_.end(), 0.0);
  action.expand_step(steps_, 0, rest_);
  const int lanes = simd_lanes();
  for (int k = 0; k < count; ++k)
    for (int a = 0; a < n; ++a) {
      double largest = 0, tail = 0;
      for (int i = 0; i < functions; ++i) {
        double coefficient = 0;
        for (int j = 0; j < functions; ++j) {
          const std::size_t at =
              (static_cast<std::size_t>(k / lanes * functions + j) * n + a) * lanes + k % lanes;
          coefficient += scheme.legendre[i * functions + j] * (inner_[at] - rest_[at]);
        }
        largest = std::max(largest, std::abs(coefficient));
        if (i >= functions - 2) tail = std::max(tail, std::abs(coefficient));
      }
      if (!(tail <= allowed * largest)) return false;
    }
  return true;
}

void SecondVariation::keep(const DiscreteAction& action, std::span<const Part> parts) {
  const int first = count(), lanes = simd_lanes(), kept = static_cast<int>(parts.size());
  for (int k = 0; k < kept; ++k)
    pieces_.push_back({parts[k], start(parts[k]), length(parts[k]), first + k / lanes * lanes});
  const std::size_t size = 3 * static_cast<std::size_t>(coordinates()) * coordinates();
  if (double(forms_.size() + kept * size) > limits::variation::most_forms && kept <= lanes &&
      !lagrangian_->kinks()) {
    forms_.clear();
    forms_from_ = first;
  }
  keep_forms(action, kept);
}

/// Appends the forms of the elements that were evaluated last.
void SecondVariation::keep_forms(const DiscreteAction& action, int count) {
  const int n = coordinates(), lanes = simd_lanes();
  const std::size_t size = static_cast<std::size_t>(n) * n, first = forms_.size();
  forms_.resize(first + 3 * count * size);
  for (int k = 0; k < count; k += lanes) {
    double *a[most_lanes], *b[most_lanes], *d[most_lanes];
    const std::size_t used = std::min(lanes, count - k);
    for (std::size_t j = 0; j < used; ++j) {
      a[j] = forms_.data() + first + 3 * (k + j) * size;
      b[j] = a[j] + size;
      d[j] = b[j] + size;
    }
    action.copy_condensed(k / lanes, {a, used}, {b, used}, {d, used});
  }
}

/// The pieces that were evaluated together with piece k.
void SecondVariation::evaluate_group(int k) {
  if (evaluated_ == pieces_[k].first) return;
  batch_.clear();
  for (int i = pieces_[k].first; i < count() && pieces_[i].first == pieces_[k].first; ++i)
    batch_.push_back(pieces_[i].part);
  evaluate(batch_);
  evaluated_ = pieces_[k].first;
}

void SecondVariation::hold(int k) {
  const int n = coordinates(), kept = static_cast<int>(forms_.size() / (3 * static_cast<std::size_t>(n) * n));
  if (k >= forms_from_ && k < forms_from_ + kept) return;
  evaluate_group(k);
  forms_.clear();
  forms_from_ = pieces_[k].first;
  keep_forms(action_, static_cast<int>(batch_.size()));
}

std::vector<Eigen::MatrixXd> SecondVariation::start_forms(int k, std::span<const double> tau) {
  const Part whole = pieces_[k].part;
  const int n = coordinates();
  const std::size_t lanes = simd_lanes();
  std::vector<Eigen::MatrixXd> forms;
  evaluated_ = -1;
  for (std::size_t first = 0; first < tau.size(); first += lanes) {
    const std::size_t batch = std::min(lanes, tau.size() - first);
    batch_.clear();
    for (std::size_t j = first; j < first + batch; ++j)
      batch_.push_back({whole.element, whole.tau0, whole.tau0 + tau[j] * (whole.tau1 - whole.tau0)});
    evaluate(batch_);
    double* a[most_lanes];
    for (std::size_t j = 0; j < batch; ++j) a[j] = forms.emplace_back(n, n).data();
    action_.copy_condensed(0, {a, batch});
  }
  return forms;
}

Eigen::MatrixXd SecondVariation::end_form(int k, double tau) {
  const Part whole = pieces_[k].part;
  const int n = coordinates();
  const Part rest{whole.element, whole.tau0 + tau * (whole.tau1 - whole.tau0), whole.tau1};
  evaluated_ = -1;
  evaluate({&rest, 1});
  Eigen::MatrixXd d(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) d(i, j) = d(j, i) = action_.condensed(0, n + i, n + j);
  return d;
}

/// Makes the inner fields of piece k, from the factor that eliminated the inner unknowns.
const Eigen::MatrixXd& SecondVariation::inner_by_ends(int k) {
  Eigen::MatrixXd& fields = inner_by_ends_[k];
  if (fields.size() > 0) return fields;
  if (!of_scheme_) evaluate_group(k);
  const int n = coordinates(), inner = (scheme_->degree - 1) * n,
            element = of_scheme_ ? k : k - pieces_[k].first;
  if (kept_ + inner * 2 * n > most_kept) forget();
  kept_ += inner * 2 * n;
  fields_.resize(inner, 2 * n);
  action_.inner_by_ends(element, {fields_.data(), static_cast<std::size_t>(fields_.size())});
  fields = fields_;
  return fields;
}

void SecondVariation::forget() {
  inner_by_ends_.assign(pieces_.size(), {});
  kept_ = 0;
}

void SecondVariation::fields(int k, double tau, Eigen::MatrixXd& from_start, Eigen::MatrixXd& from_end) {
  const int n = coordinates();
  const Eigen::MatrixXd& inner = inner_by_ends(k);
  from_start = (1 - tau) * Eigen::MatrixXd::Identity(n, n);
  from_end = tau * Eigen::MatrixXd::Identity(n, n);
  const Barycentric& at = lobatto_barycentric(scheme_->degree);
  const auto node = std::find(at.nodes.begin(), at.nodes.end(), tau);
  double sum = 0;
  for (std::size_t j = 0; j < at.nodes.size(); ++j) sum += at.weights[j] / (tau - at.nodes[j]);
  for (int j = 1; j < scheme_->degree; ++j) {
    const double value =
        node == at.nodes.end() ? at.weights[j] / (tau - at.nodes[j]) / sum : tau == at.nodes[j];
    from_start += value * inner.middleRows((j - 1) * n, n).leftCols(n);
    from_end += value * inner.middleRows((j - 1) * n, n).rightCols(n);
  }
}

}  // namespace extremal
