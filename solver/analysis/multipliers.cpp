#include "analysis/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/dichotomy.hpp"
#include "analysis/symplectic.hpp"
#include "linear/dense.hpp"

namespace extremal {

namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXd;

/// Relative, over that of coordinates.
constexpr double momentum_error = 10;
/// A symmetry has a double multiplier 1, which may be so many times farther off than its accuracy.
constexpr double expected = 1e4;
/// Pairs that nothing makes ±1 are so within their accuracy, and within this. Where an orbit is known badly
/// the accuracy is far more than the error, and all pairs would be ±1: then each is what it is found to be.
constexpr double most_uncertain = 1e-2;
/// Of the shift in time after a part of the orbit.
constexpr double same_shift = 0.1;
/// Pieces are multiplied until their product is this large.
constexpr double largest_factor = 100;
/// Imaginary parts of a double real eigenvalue, relative.
constexpr double real_within = 1e-12;
/// Moduli as near as this, relative, are equal in the order of multipliers.
constexpr double same_modulus = 1e-9;

/// An orthogonal symplectic matrix with v/|v| as its first column, without that and the one beside it.
MatrixXd across(const Eigen::VectorXd& v) {
  const auto n = v.size() / 2;
  const Eigen::MatrixXcd u = unitary(v.head(n) + Complex(0, 1) * v.tail(n)).q;
  MatrixXd basis(2 * n, 2 * n - 2);
  basis << u.real().rightCols(n - 1), -u.imag().rightCols(n - 1), u.imag().rightCols(n - 1),
      u.real().rightCols(n - 1);
  return basis;
}

/// The flow over a part of the orbit, from its start to its end, and the shift in time at both.
struct Factor {
  MatrixXd flow;
  Eigen::VectorXd before, after;

  /// The flow of the fields of the energy, but for multiples of the shift: both are known, and with them one
  /// pair of multipliers 1. Their rows and columns make a Jordan block, which alone costs half of the digits.
  /// The image of the shift differs from the shift by the error of the path, and what is across the one is
  /// turned to across the other: so the result is symplectic to second order in that error.
  MatrixXd across_shift() const {
    const MatrixXd image = across(flow * before);
    return (across(after).transpose() * image) * (image.transpose() * flow * across(before));
  }
};

/// Products of some pieces each, then R⁻¹: q ← R⁻¹q, p ← Rᵀp.
std::vector<Factor> factors(const SecondVariation& variation, const MatrixXd& map) {
  const int n = variation.coordinates();
  const Eigen::VectorXd unit = symplectic_units(variation);
  const auto shift = [&](int k) {
    Eigen::VectorXd field = variation.shift(k);
    field.head(n).array() *= unit.array();
    field.tail(n).array() /= unit.array();
    return field;
  };
  std::vector<Factor> result;
  for (int k = 0; k < variation.count(); ++k) {
    MatrixXd next = transfer(variation.piece(k), unit);
    if (result.empty() || result.back().flow.norm() > largest_factor) {
      const Eigen::VectorXd field = shift(k);
      if (k > 0) result.back().after = field;
      result.push_back({std::move(next), field, {}});
    } else {
      result.back().flow = next * result.back().flow;
    }
  }
  result.back().after = result.front().before;
  if (map.size() > 0) {
    const MatrixXd scaled = unit.asDiagonal() * map * unit.cwiseInverse().asDiagonal();
    MatrixXd& last = result.back().flow;
    last.topRows(n) = solved(scaled, last.topRows(n));
    last.bottomRows(n) = (scaled.transpose() * last.bottomRows(n)).eval();
  }
  return result;
}

/// The same in phase space. Along motions the momenta of the coordinates z = (q, p) are (p, 0), or (p, −q)/2
/// in the symmetric form: Π z. So the flow takes z_a to z_b with Π z_a = −(A z_a + Bᵀz_b). Variables are
/// q·unit and p/unit.
std::vector<Factor> phase_factors(const SecondVariation& variation, const MatrixXd& map,
                                  const PhaseWeights& weights) {
  const int n = variation.coordinates() / 2;
  const double unit = std::sqrt(std::sqrt(weights.velocity / weights.force));
  MatrixXd momenta = MatrixXd::Zero(2 * n, 2 * n);
  momenta.topRightCorner(n, n).diagonal().setConstant(weights.symmetric ? 0.5 : 1);
  if (weights.symmetric) momenta.bottomLeftCorner(n, n).diagonal().setConstant(-0.5);
  Eigen::VectorXd scale(2 * n);
  scale << Eigen::VectorXd::Constant(n, unit), Eigen::VectorXd::Constant(n, 1 / unit);
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const auto shift = [&](int k) -> Eigen::VectorXd {
    return scale.asDiagonal() * variation.shift(k).head(2 * n);
  };
  std::vector<Factor> result;
  for (int k = 0; k < variation.count(); ++k) {
    const Piece piece = variation.piece(k);
    const MatrixXd flow = solved(-piece.b.transpose(), piece.a + momenta);
    const MatrixXd next = scale.asDiagonal() * flow * inverse.asDiagonal();
    if (result.empty() || result.back().flow.norm() > largest_factor) {
      const Eigen::VectorXd field = shift(k);
      if (k > 0) result.back().after = field;
      result.push_back({next, field, {}});
    } else {
      result.back().flow = next * result.back().flow;
    }
  }
  result.back().after = result.front().before;
  if (map.size() > 0) {
    const MatrixXd scaled = scale.asDiagonal() * map * inverse.asDiagonal();
    result.back().flow = solved(scaled, result.back().flow);
  }
  return result;
}

/// On how many parts of the orbit its shift in time is what the flow makes of it: on none where it rests.
/// Next to a point of rest the error of the orbit may be more than the shift.
std::ptrdiff_t shifting(const std::vector<Factor>& factors) {
  return std::count_if(factors.begin(), factors.end(), [](const Factor& factor) {
    const double size = factor.after.norm();
    return size > 0 && (factor.flow * factor.before - factor.after).norm() <= same_shift * size;
  });
}

/// Largest modulus first; those of equal moduli by |argument|, the positive one first. Moduli may be known
/// better than the numbers tell.
template <class Modulus>
void sort_by_modulus(Floquet& floquet, const Modulus& modulus) {
  std::vector<std::size_t> order(floquet.multipliers.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto by_argument = [&](std::size_t a, std::size_t b) {
    const double x = std::arg(floquet.multipliers[a]), y = std::arg(floquet.multipliers[b]);
    return std::abs(x) != std::abs(y) ? std::abs(x) < std::abs(y) : x > y;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return modulus(a) > modulus(b); });
  for (auto first = order.begin(); first != order.end();) {
    const auto end = std::find_if(
        first, order.end(), [&](std::size_t k) { return modulus(k) < (1 - same_modulus) * modulus(*first); });
    std::stable_sort(first, end, by_argument);
    first = end;
  }
  const Floquet unsorted = floquet;
  for (std::size_t k = 0; k < order.size(); ++k) {
    floquet.multipliers[k] = unsorted.multipliers[order[k]];
    if (!unsorted.krein.empty()) floquet.krein[k] = unsorted.krein[order[k]];
  }
}

/// Multipliers as they are found, a pair or four at a time.
class Collection {
 public:
  /// A double multiplier 1, as the shift in time has, or −1.
  void add_double(double one) {
    ++result_.trivial_pairs;
    add(one, 1, 0);
    add(one, 1, 0);
  }

  /// By μ = λ + 1/λ, which is not ±2.
  void add_sum(const ReciprocalPair& pair) {
    const Complex half = pair.sum / 2.0;
    if (half.imag() == 0 && std::abs(half.real()) < 1) {
      ++result_.circle_pairs;
      const double sine = std::sqrt((1 - half.real()) * (1 + half.real()));
      add({half.real(), sine}, 1, pair.sign);
      add({half.real(), -sine}, 1, -pair.sign);
      note_defect(half.real() * half.real() + sine * sine);
    } else {
      Complex root = std::sqrt(half - 1.0) * std::sqrt(half + 1.0);
      if (std::real(std::conj(root) * half) < 0) root = -root;
      add_growing(half + root);
    }
  }

  /// λ, |λ| > 1, and 1/λ; for a positive imaginary part also their conjugates, for a negative one none.
  void add_growing(Complex lambda) {
    if (std::abs(lambda.imag()) <= real_within * std::abs(lambda)) {
      ++result_.real_pairs;
      const double real = lambda.real();
      add(real, std::abs(real), 0);
      add(1 / real, std::abs(1 / real), 0);
      note_defect(real * (1 / real));
    } else if (lambda.imag() > 0) {
      ++result_.quadruples;
      add_pair(lambda);
      add_pair(std::conj(lambda));
    }
  }

  /// In their order; nothing if one is not finite.
  std::optional<Floquet> ordered() {
    for (const Entry& entry : entries_)
      if (!std::isfinite(entry.modulus) || entry.modulus == 0) return std::nullopt;
    for (const Entry& entry : entries_) {
      result_.multipliers.push_back(entry.value);
      result_.krein.push_back(entry.sign);
    }
    sort_by_modulus(result_, [this](std::size_t k) { return entries_[k].modulus; });
    return result_;
  }

 private:
  struct Entry {
    Complex value;
    double modulus;
    int sign;
  };
  void add(Complex value, double modulus, int sign) { entries_.push_back({value, modulus, sign}); }
  void add_pair(Complex lambda) {
    const Complex inverse = 1.0 / lambda;
    add(lambda, std::abs(lambda), 0);
    add(inverse, std::abs(inverse), 0);
    note_defect(lambda * inverse);
  }
  void note_defect(Complex product) {
    result_.symplectic_defect = std::max(result_.symplectic_defect, std::abs(product - 1.0));
  }

  Floquet result_;
  std::vector<Entry> entries_;
};

}  // namespace

void sort_multipliers(Floquet& floquet) {
  sort_by_modulus(floquet, [&](std::size_t k) { return std::abs(floquet.multipliers[k]); });
}

std::vector<double> doubling_tests(const Floquet& floquet) {
  if (!floquet.paired) {
    Complex product = 1;
    for (const Complex& value : floquet.multipliers) product *= (1.0 + value) / (1 + std::abs(value));
    return {product.real()};
  }
  std::vector<double> tests;
  bool first_of_two = false;  // of a pair at −1
  for (const Complex& value : floquet.multipliers) {
    const double x = value.real(), y = value.imag();
    if (y > 0 && std::abs(std::norm(value) - 1) < same_modulus)
      tests.push_back(std::asinh(x) + std::asinh(1));
    if (y == 0 && std::abs(x) > 1) tests.push_back(std::asinh(0.5 * (x + 1 / x)) + std::asinh(1));
    if (value == -1.0 && (first_of_two = !first_of_two)) tests.push_back(0);
  }
  std::sort(tests.begin(), tests.end());
  return tests;
}

namespace {

/// By the flow of the fields of a motion with so many degrees of freedom.
std::optional<Floquet> floquet_of(const std::vector<Factor>& flow, int degrees, const ClosedOrbit& orbit) {
  const std::ptrdiff_t parts_shifting = orbit.autonomous ? shifting(flow) : 0;
  const bool shifted = parts_shifting > 0;
  // Across a shift that is not known the flow is not known either. With one degree of freedom nothing is
  // across it.
  if (shifted && parts_shifting < std::ssize(flow) && degrees > 1) return std::nullopt;
  std::vector<MatrixXd> parts;
  for (const Factor& factor : flow) parts.push_back(shifted ? factor.across_shift() : factor.flow);
  Collection found;
  if (shifted) found.add_double(1);
  if (!parts.front().size()) return found.ordered();
  const Dichotomy split = separate(parts);
  for (const MatrixXd& block : split.growing) {
    if (!block.allFinite()) return std::nullopt;
    const auto values =
        block.rows() == 1 ? Eigen::VectorXcd(block.diagonal().cast<Complex>()) : general_eigenvalues(block);
    for (const Complex& value : values) found.add_growing(value);
  }
  if (!split.centre.allFinite()) return std::nullopt;
  if (split.centre.size() > 0) {
    const ReciprocalPairs centre = reciprocal_pairs(split.centre);
    const double accuracy = (sum_accuracy + momentum_error * orbit.relative_error) * centre.scale;
    std::vector<ReciprocalPair> pairs = centre.pairs;
    std::stable_sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) {
      return std::abs(a.sum - 2.0) < std::abs(b.sum - 2.0);
    });
    const int trivial = orbit.symmetries + (orbit.autonomous && !shifted);
    for (int k = 0; k < std::ssize(pairs); ++k) {
      const double one = std::copysign(1, pairs[k].sum.real());
      const double within = k < trivial ? expected * accuracy : std::min(accuracy, most_uncertain);
      if (std::abs(pairs[k].sum - 2 * one) <= within)
        found.add_double(one);
      else
        found.add_sum(pairs[k]);
    }
  }
  return found.ordered();
}

}  // namespace

std::optional<Floquet> floquet(const SecondVariation& variation, const ClosedOrbit& orbit) {
  return floquet_of(factors(variation, orbit.map), variation.coordinates(), orbit);
}

std::optional<Floquet> floquet_in_phase_space(const SecondVariation& variation, const ClosedOrbit& orbit,
                                              const PhaseWeights& weights) {
  return floquet_of(phase_factors(variation, orbit.map, weights), variation.coordinates() / 2, orbit);
}

}  // namespace extremal
