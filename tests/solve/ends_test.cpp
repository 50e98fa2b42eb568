#include "solve/newton/ends.hpp"

#include "machine/simd.hpp"
#include "solve/laws.hpp"
#include "solve/mesh/levels.hpp"

/// \file Ends stay on the boundary relation, however far steps lead on the way.

namespace extremal::laws {
namespace {

struct Line {
  Line(std::shared_ptr<const Lagrangian> lagrangian, const EndMap& ends) : ends(ends) {
    levels.bind(lagrangian);
    path.reset(levels.at(4), std::vector<double>{0, 0.5, 1}, 1);
    for (int a = 0; a < path.coordinates(); ++a) path.set_node(0, a, ends.offset[a]);
    keep_ends(ends, path);
  }

  /// Of q(0), the middle, q(T); and back.
  void go_and_return(std::vector<double> step) {
    const AlignedDoubles inner(static_cast<std::size_t>(levels.at(4).unknowns()) * simd_lanes());
    for (const double factor : {1.0, -1.0}) {
      path.add(step, inner, factor);
      keep_ends(ends, path);
    }
  }

  EndMap ends;
  Levels levels;
  Path path;
};

/// x(0) = a, x(0) + b y(T) + y(0) = c, with steps of y a million times longer than c.
TEST(Ends, MeetTheirConditionsAfterLongSteps) {
  const double b = 0.36518190181485594, c = -0.31009455743747527;
  BoundaryRelation relation;
  relation.coordinates = 2;
  relation.fix(0, false, 0.7);
  const int row = relation.add_row(c);
  relation.add(row, 0, 1);
  relation.add(row, 1, 1);
  relation.add(row, 3, b);
  Line line(trace(2, [](auto, auto v, auto) { return v[0] * v[0] + v[1] * v[1]; }), solve_relation(relation));
  for (const double size : {1e2, 1e4, 1e6}) {
    const double y = size / 3;
    line.go_and_return({0, y, 0, 0, 0, -y / b});
    const double *start = line.path.node(0), *end = line.path.node(2);
    EXPECT_EQ(start[0], 0.7);
    EXPECT_NEAR(start[0] + start[1] + b * end[1], c, 4e-16 * (0.7 + std::abs(start[1]) + std::abs(c)));
  }
}

TEST(Ends, OfClosedPathsAreTheSameToTheLastDigit) {
  const auto free = trace(1, [](auto, auto v, auto) { return v[0] * v[0]; });
  const Problem problem = periodic(free, 1);
  Line line(free, problem.ends);
  for (const double step : {0.1, 1 / 3.0, 1e-9, 1e7}) {
    line.path.add(std::vector<double>{step, 0, step},
                  AlignedDoubles(line.levels.at(4).unknowns() * simd_lanes()), 1);
    keep_ends(line.ends, line.path);
    EXPECT_EQ(line.path.node(0)[0], line.path.node(2)[0]);
    EXPECT_EQ(line.path.rest(0)[0], line.path.rest(2)[0]);
  }
}

}  // namespace
}  // namespace extremal::laws
