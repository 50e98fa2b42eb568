#include "solution/broken_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "solution/limits.hpp"

namespace extremal {

using namespace limits::broken_node;

namespace {

/// A node, with the velocities of both elements beside it.
class NodeReader {
 public:
  NodeReader(const Lagrangian& lagrangian, const Trajectory& trajectory, bool paired)
      : lagrangian_(lagrangian),
        trajectory_(trajectory),
        paired_(paired),
        n_(trajectory.coordinates / (paired ? 2 : 1)),
        q_(trajectory.coordinates),
        before_(q_),
        after_(q_) {
    for (const double q : trajectory.nodes) largest_ = std::max(largest_, std::abs(q));
  }

  std::optional<BrokenNode> at(int node) {
    trajectory_.in_element(node - 1, 1, q_, before_);
    trajectory_.in_element(node, 0, q_, after_);
    return compare(trajectory_.times[node], std::min(trajectory_.length(node - 1), trajectory_.length(node)));
  }

  /// At T, where a closed path goes on as it began.
  std::optional<BrokenNode> at_closing(const Eigen::MatrixXd& map) {
    trajectory_.in_element(0, 0, q_, before_);
    Eigen::Map<Eigen::VectorXd>(after_.data(), std::ssize(after_)) =
        map * Eigen::Map<const Eigen::VectorXd>(before_.data(), std::ssize(before_));
    const int last = trajectory_.elements() - 1;
    trajectory_.in_element(last, 1, q_, before_);
    return compare(trajectory_.duration(), std::min(trajectory_.length(0), trajectory_.length(last)));
  }

 private:
  /// `h`: the length of the shorter element.
  std::optional<BrokenNode> compare(double t, double h) {
    const double roundoff = roundoff_of_q * largest_ * trajectory_.degree * (trajectory_.degree + 1) / h;
    if (!jumps(roundoff)) return std::nullopt;
    if (paired_) std::copy_n(q_.begin(), n_, q_.begin() + static_cast<std::ptrdiff_t>(n_));
    const PointValues left = evaluate_at(lagrangian_, q_, before_, t, Order::gradient, scratch_),
                      right = evaluate_at(lagrangian_, q_, after_, t, Order::gradient, scratch_);
    const double change = paired_ ? difference_of_copies(t) : right.value - left.value;
    double mean = 0, of_momenta = 0, terms = std::abs(left.value) + std::abs(right.value);
    BrokenNode found{t, 0, -change};
    for (std::size_t a = 0; a < n_; ++a) {
      const double jump = after_[a] - before_[a], sum = left.dv[a] + right.dv[a];
      mean += 0.5 * sum * jump;
      of_momenta += 0.5 * std::abs((right.dv[a] - left.dv[a]) * jump);
      terms += std::abs(left.dv[a] * before_[a]) + std::abs(right.dv[a] * after_[a]);
      found.velocity = std::max(found.velocity, std::abs(jump));
      found.energy += right.dv[a] * after_[a] - left.dv[a] * before_[a];
    }
    if (!(std::abs(change - mean) > of_momenta + roundoff_of_terms * terms)) return std::nullopt;
    return found;
  }

  /// What is bounded is of third order in the jump: of a smaller one it is roundoff. `roundoff`: that of
  /// slopes, which roundings of q make.
  bool jumps(double roundoff) const {
    double jump = 0, speed = 0;
    for (std::size_t a = 0; a < n_; ++a) {
      jump = std::max(jump, std::abs(after_[a] - before_[a]));
      speed = std::max({speed, std::abs(after_[a]), std::abs(before_[a])});
    }
    return jump > least_jump * speed && jump > roundoff;
  }

  /// L(v₊) − L(v₋): what two copies with these velocities have, where their coordinates agree.
  double difference_of_copies(double t) {
    std::vector<double> v = after_;
    std::copy_n(before_.begin(), n_, v.begin() + static_cast<std::ptrdiff_t>(n_));
    return evaluate_at(lagrangian_, q_, v, t, Order::value, scratch_).value;
  }

  const Lagrangian& lagrangian_;
  const Trajectory& trajectory_;
  const bool paired_;
  const std::size_t n_;
  double largest_ = 0;  ///< coordinate
  std::vector<double> q_, before_, after_;
  Scratch scratch_;
};

}  // namespace

std::optional<BrokenNode> find_broken_node(const Lagrangian& lagrangian, const Trajectory& trajectory,
                                           bool paired, int first, int last, const ClosingMap* closing) {
  if (lagrangian.structure().velocity_free) return std::nullopt;
  NodeReader reader(lagrangian, trajectory, paired);
  std::optional<BrokenNode> worst;
  const auto take = [&](const std::optional<BrokenNode>& found) {
    if (found && (!worst || std::abs(found->energy) > std::abs(worst->energy))) worst = found;
  };
  for (int node = first + 1; node < last; ++node) take(reader.at(node));
  if (closing) take(reader.at_closing(closing->r));
  return worst;
}

std::optional<BrokenNode> find_broken_node(const Lagrangian& lagrangian, const Trajectory& trajectory,
                                           bool paired) {
  return find_broken_node(lagrangian, trajectory, paired, 0, trajectory.elements());
}

std::string describe(const BrokenNode& node) {
  return fmt::format(
      "the velocity jumps by {:.3g} at t = {:.6g}, and with it the energy by {:.3g}: a corner of an extremal "
      "has the same momentum and the same energy on both sides (Weierstrass and Erdmann). There what is "
      "integrated is not convex in the velocities (Legendre's condition); try another guess",
      node.velocity, node.time, std::abs(node.energy));
}

}  // namespace extremal
