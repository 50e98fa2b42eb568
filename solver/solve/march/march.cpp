#include "solve/march/march.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "action/rule.hpp"
#include "solve/march/kink_watch.hpp"
#include "solve/march/limits.hpp"
#include "solve/march/predictor.hpp"
#include "solve/march/record.hpp"

namespace extremal {

using namespace limits::march;
using Result = ElementSolver::Result;

namespace {

/// Elements between two looks at the clock.
constexpr int elements_a_look = 256;
/// So many elements tell how many the whole motion takes; it is given up where these are that much more than
/// can be kept.
constexpr int telling_elements = 1 << 16;
constexpr double hopeless_excess = 100;
/// So many elements in a row, each shorter than this part of the duration, do not lead on.
constexpr int most_creeping = 256;
constexpr double creeping = 1e-12;
/// A motion that meets so many kinks within this part of the duration stays on one.
constexpr int crowd = 64;
constexpr double crowded = 1e-5;
/// Beside kinks: points that a finer quadrature has more, and roundings of momenta that it does not tell.
constexpr int more_points = 3;
constexpr double roundings_of_force = 64 * unit_roundoff;

void report(const MarchRecord& record, const ElementSolver& solver, const MarchProgress& progress) {
  if (progress) progress({record.elements(), solver.tables().degree(), solver.residual(), 0, 1});
}

/// The unknowns of an element from those of `pieces` equal ones that cover it: x[piece*size + …].
void join_pieces(const StepTables& tables, const std::vector<double>& parts, std::span<double> x) {
  const int n = tables.coordinates(), s = tables.degree();
  const std::size_t size = x.size();
  const std::vector<double>& lobatto = tables.scheme().lobatto;
  double value[max_degree + 1];
  for (int a = 0; a < n; ++a) {
    double before[pieces + 1] = {};
    for (int i = 0; i < pieces; ++i) before[i + 1] = before[i] + parts[i * size + a * s + s - 1];
    const double delta = before[pieces];
    x[a * s + s - 1] = delta;
    for (int j = 1; j < s; ++j) {
      const int piece = std::min(static_cast<int>(lobatto[j] * pieces), pieces - 1);
      const double tau = lobatto[j] * pieces - piece;
      const double* const own = parts.data() + piece * size + static_cast<std::size_t>(a) * s;
      lobatto_basis_at(s, tau, value, nullptr);
      double q = before[piece] + tau * own[s - 1];
      for (int k = 1; k < s; ++k) q += value[k] * own[k - 1];
      x[a * s + j - 1] = q - lobatto[j] * delta;
    }
  }
}

/// Where Newton's method finds no element near the guess, it starts from shorter ones.
Result solve_by_pieces(ElementSolver& solver, UniformMotion& uniform, const MotionState& state, double h,
                       int cuts) {
  const StepTables& tables = solver.tables();
  std::vector<double> parts;
  MotionState now = state;
  for (int i = 0; i < pieces; ++i) {
    if (i == 0) uniform.predict(now, h / pieces, solver.x());
    Result result = solver.solve(now, h / pieces);
    if (result != Result::solved && cuts > 1)
      result = solve_by_pieces(solver, uniform, now, h / pieces, cuts - 1);
    if (result != Result::solved) return result;
    parts.insert(parts.end(), solver.x().begin(), solver.x().end());
    solver.advance(now, now.time + h / pieces);
  }
  join_pieces(tables, parts, solver.x());
  return solver.solve(state, h);
}

/// The rule that tells what Gauss's rule of an element misses.
Scheme with_more_points(const StepTables& tables) {
  Scheme scheme = gauss(tables.degree());
  scheme.points = std::min(scheme.points + more_points, most_points);
  return scheme;
}

/// Elements whose lengths follow the truncation error.
class AdaptiveMarch {
 public:
  AdaptiveMarch(const InitialData& start, double duration, const StepTables& tables, double truncation,
                double longest, const Trajectory* near)
      : tables_(tables),
        duration_(duration),
        truncation_(truncation),
        bound_(longest),
        record_(tables, start, 1024, true),
        solver_(tables),
        kinks_(tables, record_.state()),
        uniform_(tables, start.paired),
        continuation_(tables),
        finer_tables_(with_more_points(tables), 0, tables.lagrangian()),
        finer_(finer_tables_),
        last_(tables.unknowns(), 0.0),
        length_(first_length * duration) {
    if (near) reader_.emplace(*near, tables);
  }

  March run(const Deadline& deadline, const MarchProgress& progress) {
    for (int tries = 0; time_.high < duration_; ++tries) {
      if (tries % elements_a_look == 0) {
        if (deadline.passed()) return record_.finish(March::End::deadline);
        report(record_, solver_, progress);
      }
      if (record_.full() || (tries % elements_a_look == 0 && hopeless()))
        return record_.finish(March::End::memory);
      length_ = std::min(length_, bound_);
      const double left = (duration_ - time_.high) - time_.low;
      if (kinks_.active() && kink_tries_ == 0)
        length_ = std::min(length_, std::max(kinks_.expected(length_), 4 * least_length * duration_));
      const bool last = length_ * (1 + 1e-3) >= left;
      const double h = last ? left : kinks_.active() ? length_ : std::min(length_, left / 2);
      if (h < least_length * duration_ || stays_on_kink_ || creeping_ > most_creeping ||
          record_.state().time + h == record_.state().time) {
        record_.march().wanted = h;
        record_.march().stays_on_kink = stays_on_kink_;
        return record_.finish(March::End::no_element);
      }
      try_element(h, last);
    }
    return record_.finish(March::End::complete);
  }

 private:
  void try_element(double h, bool last) {
    const MotionState& state = record_.state();
    if (reader_)
      reader_->predict(state.time, std::min(h, duration_ - state.time), solver_.x());
    else if (last_length_ > 0)
      continuation_.predict(last_, h / last_length_, solver_.x());
    else
      uniform_.predict(state, h, solver_.x());
    const Result result = solver_.solve_cheaply(state, h);
    record_.count(solver_.steps());
    record_.march().reason = result;
    if (result != Result::solved && solver_.cheap() && ++cheap_cuts_ <= most_cheap_cuts) {
      length_ = longest_ = cheap_cut * h;
      return;
    }
    if (result != Result::solved && solver_.cheap()) {
      solver_.give_up_cheap_steps();
      length_ = h / std::pow(cheap_cut, most_cheap_cuts);
      longest_ = INFINITY;
      return;
    }
    if (result != Result::solved) {
      length_ = most_shrink * h;
      return;
    }
    if (kinks_.active()) {
      const double precision = kink_precision * duration_;
      const KinkWatch::Verdict verdict = kinks_.judge(state, solver_.x(), h, std::max(precision, 1e-15 * h));
      if (verdict.length && ++kink_tries_ <= most_kink_tries) {
        length_ = *verdict.length;
        return;
      }
    }
    const double excess = this->excess(h);
    const double factor =
        std::pow(aim / std::max(excess, 1e-30), 1.0 / (tables_.degree() + 1 + record_.gain()));
    if (excess > accepted) {
      length_ = h * std::clamp(factor, most_shrink, 0.9);
      return;
    }
    std::copy(solver_.x().begin(), solver_.x().end(), last_.begin());
    last_length_ = h;
    time_.add(h);
    record_.add(solver_, last_, h, last ? duration_ : time_.high);
    if (last) time_ = {duration_, 0};
    kink_tries_ = 0;
    creeping_ = h < creeping * duration_ ? creeping_ + 1 : 0;
    // Elements grow where a force holds a motion at rest, but not where it points to a kink from both sides.
    still_ = kinks_.active() && rests() ? still_ + 1 : 0;
    stays_on_kink_ = stays_on_kink_ || still_ > most_creeping;
    if (kinks_.active() && kinks_.accept()) count_kink();
    const double most = tail_.size == 0 || excess < 1e-6 ? fast_growth : most_growth;
    cheap_cuts_ = 0;
    longest_ *= cheap_growth;
    length_ = std::min(h * std::clamp(factor, most_shrink, most), longest_);
  }

  void count_kink() {
    if (++met_ % crowd != 0) return;
    stays_on_kink_ = time_.high - crowd_from_ < crowded * duration_;
    crowd_from_ = time_.high;
  }

  /// Whether the last element moves no coordinate by more than roundoff.
  bool rests() const { return tail_.extent <= roundings * magnitude(); }
  double magnitude() const {
    double largest = 0;
    for (const LongSum& q : record_.state().q) largest = std::max(largest, std::abs(q.high));
    return largest;
  }

  /// Whether a motion that goes on as it began takes far more elements than can be kept.
  bool hopeless() {
    const double numbers = static_cast<double>(record_.march().trajectory.nodes.size());
    return record_.elements() > telling_elements &&
           numbers * duration_ > hopeless_excess * most_numbers * time_.high;
  }

  /// The truncation error of the element relative to what is allowed: the first coefficient that the output
  /// leaves out of q, and its derivative at the ends of the element.
  double excess(double h) {
    tail_ = continuation_.tail(solver_.x(), magnitude());
    if (tail_.size == 0) return 0;
    const int order = tables_.degree() + 1 + record_.gain();
    const double error = tail_.size * std::pow(tail_.fall, 1 + record_.gain());
    const double v = error * order * (order + 1) / h;
    // An error of q' makes one of p, as large against |p| as that against the speed.
    const double speed = 2 * tail_.extent / h;
    double momentum = 0;
    for (std::size_t a = 0; a < solver_.force().size(); ++a) {
      const double p = record_.state().p[a].high;
      momentum = std::max({momentum, std::abs(p), std::abs(p + solver_.force()[a])});
    }
    const double range_q = std::max(record_.range_q(), tail_.extent),
                 range_v = std::max(record_.range_v(), speed),
                 range_p = std::max(record_.range_p(), momentum);
    const double by_size =
        std::max({error / range_q, v / (10 * range_v), v * momentum / (speed * 10 * range_p)}) / truncation_;
    const double missed = kinks_.active() ? missed_force(h, momentum) / (range_p * truncation_) : 0;
    return std::max(tail_.fall > slowest_fall ? std::max(by_size, 2 * accepted) : by_size, missed);
  }

  /// What the quadrature of an element misses of the change of a momentum. A force like u^1.5 beside a kink
  /// has no series there: coefficients of the motion do not tell how its momentum errs.
  double missed_force(double h, double momentum) {
    finer_.action_of(record_.state(), solver_.x(), h);
    double missed = 0;
    for (std::size_t a = 0; a < solver_.force().size(); ++a)
      missed = std::max(missed, std::abs(finer_.force()[a] - solver_.force()[a]));
    return missed > roundings_of_force * momentum ? missed : 0;
  }

  const StepTables& tables_;
  const double duration_, truncation_, bound_;
  MarchRecord record_;
  ElementSolver solver_;
  KinkWatch kinks_;
  int kink_tries_ = 0, met_ = 0, creeping_ = 0, still_ = 0;
  double crowd_from_ = -INFINITY;
  bool stays_on_kink_ = false;
  UniformMotion uniform_;
  PolynomialContinuation continuation_;
  PolynomialContinuation::Tail tail_;
  StepTables finer_tables_;
  ElementSolver finer_;
  std::optional<TrajectoryReader> reader_;
  std::vector<double> last_;
  double length_, last_length_ = 0;
  double longest_ = INFINITY;  ///< that cheap steps allow
  int cheap_cuts_ = 0;
  LongSum time_;
};

}  // namespace

March march_uniform(const InitialData& start, double duration, const StepTables& tables, int elements,
                    bool recovering, const Deadline& deadline, const MarchProgress& progress,
                    const StepTables* finer) {
  MarchRecord record(tables, start, elements, recovering);
  ElementSolver solver(tables);
  UniformMotion uniform(tables, start.paired);
  Differences differences(tables.unknowns());
  std::optional<ElementSolver> sum;
  if (finer) sum.emplace(*finer);
  const double h = duration / elements;
  for (int k = 0; k < elements; ++k) {
    if (k % elements_a_look == 0) {
      if (deadline.passed()) return record.finish(March::End::deadline);
      report(record, solver, progress);
    }
    if (differences.empty())
      uniform.predict(record.state(), h, solver.x());
    else
      differences.predict(solver.x());
    Result result = solver.solve(record.state(), h);
    record.count(solver.steps());
    if (result != Result::solved || solver.wandered()) {
      result = solve_by_pieces(solver, uniform, record.state(), h, most_cuts);
      if (result == Result::solved && solver.wandered()) result = Result::not_converged;
    }
    if (result != Result::solved) {
      record.march().reason = result;
      record.march().wanted = h;
      return record.finish(March::End::no_element);
    }
    if (sum) record.add_finer(sum->action_of(record.state(), solver.x(), h));
    differences.add(solver.x());
    const double time = k + 1 == elements ? duration : duration * (static_cast<double>(k + 1) / elements);
    record.add(solver, solver.x(), h, time);
    if (!record.finite()) {
      record.march().reason = Result::not_finite;
      record.march().wanted = h;
      return record.finish(March::End::no_element);
    }
  }
  return record.finish(March::End::complete);
}

March march_adaptive(const InitialData& start, double duration, const StepTables& tables, double truncation,
                     double longest, const Deadline& deadline, const Trajectory* near,
                     const MarchProgress& progress) {
  return AdaptiveMarch(start, duration, tables, truncation, longest, near).run(deadline, progress);
}

}  // namespace extremal
