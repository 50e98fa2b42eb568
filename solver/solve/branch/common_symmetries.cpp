#include "solve/branch/common_symmetries.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "linear/dense.hpp"
#include "problem/own_symmetries.hpp"
#include "solve/branch/limits.hpp"

namespace extremal {

namespace {

using namespace limits::common_symmetries;

/// One column for each.
Eigen::MatrixXd columns_of(const std::vector<Generator>& symmetries) {
  if (symmetries.empty()) return {};
  const Generator& first = symmetries.front();
  Eigen::MatrixXd columns(std::ssize(first.matrix) + std::ssize(first.shift), std::ssize(symmetries));
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    std::vector<double> all = symmetries[j].matrix;
    all.insert(all.end(), symmetries[j].shift.begin(), symmetries[j].shift.end());
    columns.col(j) = Eigen::Map<const Eigen::VectorXd>(all.data(), std::ssize(all));
  }
  return columns;
}

/// Of as many.
bool span_the_same(const std::vector<Generator>& a, const std::vector<Generator>& b) {
  if (a.empty()) return true;
  const Eigen::MatrixXd of_a = columns_of(a), of_b = columns_of(b);
  const Eigen::MatrixXd rest = of_b - of_a * least_norm(of_a, of_b);
  return rest.norm() <= same * of_b.norm();
}

class CommonSymmetries {
 public:
  explicit CommonSymmetries(const ProblemFamily& family)
      : at_(family.at),
        guess_(family.problem.guess),
        duration_(family.problem.duration.value),
        beside_(beside_first * (family.to - family.from)) {
    std::vector<std::vector<Generator>> found;
    for (const double part : {beside_first, between, 1.0})
      if (auto there = found_at(family.from + part * (family.to - family.from)))
        found.push_back(*std::move(there));
    if (found.empty()) found.push_back(family.problem.symmetries);
    symmetries_ = *std::ranges::min_element(found, {}, &std::vector<Generator>::size);
    constant_ = std::ranges::all_of(found, [&](const std::vector<Generator>& each) {
      return each.size() > symmetries_.size() || span_the_same(each, symmetries_);
    });
  }

  /// Where a member has more, as those beside it have them.
  std::vector<Generator> at(double value) const {
    if (!constant_)
      for (const double by : {0.0, beside_, -beside_})
        if (auto there = found_at(value + by); there && there->size() == symmetries_.size())
          return *std::move(there);
    return symmetries_;
  }

 private:
  std::optional<std::vector<Generator>> found_at(double value) const {
    std::optional<Problem> problem = at_(value);
    if (!problem) return std::nullopt;
    problem->guess = guess_;
    if (problem->duration.free) problem->duration.value = duration_;
    return own_symmetries(*problem, everywhere());
  }

  std::function<std::optional<Problem>(double)> at_;
  Guess guess_;
  double duration_, beside_;
  std::vector<Generator> symmetries_;
  bool constant_ = true;
};

template <class Symmetries>
ProblemFamily with(ProblemFamily family, Symmetries symmetries) {
  family.at = [at = std::move(family.at), symmetries = std::move(symmetries)](double value) {
    std::optional<Problem> problem = at(value);
    if (problem) problem->symmetries = symmetries(value);
    return problem;
  };
  return family;
}

}  // namespace

ProblemFamily with_common_symmetries(ProblemFamily family) {
  if (family.varied != Varied::parameter) {
    family.problem.symmetries = own_symmetries(family.problem, everywhere());
    return family;
  }
  auto common = std::make_shared<const CommonSymmetries>(family);
  return with(std::move(family), [common = std::move(common)](double value) { return common->at(value); });
}

ProblemFamily with_symmetries_of_first(ProblemFamily family) {
  std::vector<Generator> symmetries = family.problem.symmetries;
  return with(std::move(family), [symmetries = std::move(symmetries)](double) { return symmetries; });
}

}  // namespace extremal
