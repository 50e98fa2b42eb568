#include <atomic>
#include <cstdlib>

#include "machine/sanitizer.hpp"
#include "solve/guess/first_path.hpp"
#include "solve/guess/starting_ends.hpp"
#include "solve/laws.hpp"
#include "solve/newton/iteration.hpp"

/// \file A Newton iteration takes nothing from the heap once its memory stands.

#if !EXTREMAL_ADDRESS_SANITIZER
namespace {
std::atomic<long> allocations{0};
}

// Counts what the program takes from the heap, be it by operator new or, as Eigen does, by malloc.
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}

namespace extremal::laws {
namespace {

/// Newton's method by hand on one discretisation.
class Steps {
 public:
  Steps(Problem problem, const Scheme& scheme, int elements)
      : problem_(std::move(problem)), scheme_(scheme, 8), elements_(elements), mesh_(elements + 1) {
    tables_.bind(scheme_, *problem_.lagrangian);
    for (int k = 0; k <= elements; ++k) mesh_[k] = static_cast<double>(k) / elements;
  }

  /// From the guess: `full` full steps, then `chord` chord steps; what the steps after the first allocate.
  long run(int full, int chord) {
    newton_.reset(problem_, tables_, elements_);
    path_.reset(tables_, mesh_, problem_.duration.value);
    start_path(problem_, starting_ends(problem_), tables_, path_);
    newton_.set_scale(1);
    EXPECT_EQ(newton_.full_step(path_, 0), StepResult::ok);
    const long before = allocations;
    for (int i = 1; i < full; ++i) EXPECT_EQ(newton_.full_step(path_, 0), StepResult::ok);
    for (int i = 0; i < chord; ++i) EXPECT_EQ(newton_.chord_step(path_), StepResult::ok);
    return allocations - before;
  }

 private:
  Problem problem_;
  SchemeTables scheme_;
  int elements_;
  std::vector<double> mesh_;
  ElementTables tables_;
  NewtonIteration newton_;
  Path path_;
};

std::vector<Problem> problems() {
  std::vector<Problem> list = {
      fixed_ends(systems::pendulum(), {0}, {1.5}, 2),
      fixed_ends(systems::kepler(), {1, 0}, {-0.6, 0.9}, 2.5),
      fixed_ends(systems::double_pendulum(), {0.5, 0.5}, {-0.2, -0.3}, 0.8),
      fixed_ends(systems::magnetic(), {0.3, -0.2}, {0.9, 0.5}, 1.5),
  };
  Problem open = list.back();  // one end natural
  open.boundary = {};
  open.boundary.coordinates = 2;
  open.boundary.fix(0, false, 0.3);
  open.boundary.fix(1, false, -0.2);
  open.boundary.fix(0, true, 0.9);
  list.push_back(make_problem(open));
  Problem closing = list[1];  // duration unknown
  closing.duration = {.value = 2.4, .free = true, .energy = -0.4972, .where = {}};
  list.push_back(make_problem(closing));
  return list;
}

TEST(Allocation, NoneInANewtonIterationAfterTheFirst) {
  for (const Problem& problem : problems())
    for (const Scheme& scheme : {lobatto(1), lobatto(6), gauss(3)})
      for (int elements : {1, 9}) {
        Steps steps(guided(problem), scheme, elements);
        EXPECT_EQ(steps.run(3, 2), 0)
            << scheme.name << ' ' << elements << " elements, first run, n = " << problem.coordinates()
            << ", free ends " << problem.ends.free;
        EXPECT_EQ(steps.run(3, 2), 0) << scheme.name << ' ' << elements << " elements, second run";
      }
}

TEST(Allocation, TheCounterCounts) {
  const long before = allocations;
  std::vector<double> x(100);
  asm volatile("" : : "r"(x.data()) : "memory");  // or a compiler may do without the vector
  EXPECT_EQ(allocations - before, 1);
}

}  // namespace
}  // namespace extremal::laws
#endif
