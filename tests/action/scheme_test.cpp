#include "action/scheme.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "action/rule.hpp"

namespace extremal {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& name) {
  try {
    scheme(name);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Scheme, EveryListedNameGivesItsOwnRecord) {
  ASSERT_EQ(schemes().size(), 9u);
  for (const Scheme& listed : schemes()) {
    const Scheme found = scheme(listed.name);
    EXPECT_EQ(found.name, listed.name);
    EXPECT_EQ(found.degree, listed.degree);
    EXPECT_EQ(found.quadrature, listed.quadrature);
    EXPECT_EQ(found.points, listed.points);
    EXPECT_EQ(found.order, listed.order);
    EXPECT_FALSE(listed.source.empty());
  }
}

TEST(Scheme, FamiliesTakeEveryDegree) {
  for (int s = 1; s <= max_degree; ++s) {
    const Scheme l = scheme("lobatto(" + std::to_string(s) + ")"),
                 g = scheme("gauss(" + std::to_string(s) + ")");
    EXPECT_EQ(l.degree, s);
    EXPECT_EQ(l.points, s + 1);
    EXPECT_EQ(l.order, 2 * s);
    EXPECT_EQ(g.degree, s);
    EXPECT_EQ(g.points, s);
    EXPECT_EQ(g.order, 2 * s);
    EXPECT_EQ(l.name, "lobatto(" + std::to_string(s) + ")");
  }
}

TEST(Scheme, RefusalsSayWhatIsWrongAndWhatThereIs) {
  EXPECT_THAT(refusal("euler"), HasSubstr("scheme \"euler\" does not exist"));
  EXPECT_THAT(refusal("euler"), HasSubstr("lobatto(s), gauss(s) with s = 1 to 24"));
  EXPECT_THAT(refusal(""), HasSubstr("does not exist"));
  EXPECT_THAT(refusal("lobatto"), HasSubstr("needs its degree"));
  EXPECT_THAT(refusal("lobatto(0)"), HasSubstr("degree out of range"));
  EXPECT_THAT(refusal("lobatto(25)"), HasSubstr("degree out of range"));
  EXPECT_THAT(refusal("lobatto(-1)"), HasSubstr("degree out of range"));
  EXPECT_THAT(refusal("lobatto(99999999999999)"), HasSubstr("degree out of range"));
  EXPECT_THAT(refusal("lobatto(3.5)"), HasSubstr("whole number"));
  EXPECT_THAT(refusal("lobatto()"), HasSubstr("whole number"));
  EXPECT_THAT(refusal("lobatto( 3)"), HasSubstr("whole number"));
  EXPECT_THAT(refusal("gauss(3"), HasSubstr("closing parenthesis"));
  EXPECT_THAT(refusal("gauss("), HasSubstr("closing parenthesis"));
  EXPECT_THAT(refusal("midpoint(2)"), HasSubstr("takes no argument"));
  EXPECT_THROW(lobatto(0), std::invalid_argument);
  EXPECT_THROW(gauss(max_degree + 1), std::invalid_argument);
}

TEST(Scheme, RuleOfEachScheme) {
  const auto rule = [](const char* name) { return rule_of(scheme(name), 5); };
  EXPECT_EQ(rule("rectangle").nodes, std::vector<double>{0});
  EXPECT_EQ(rule("rectangle-right").nodes, std::vector<double>{1});
  EXPECT_EQ(rule("midpoint").nodes, std::vector<double>{0.5});
  EXPECT_EQ(rule("midpoint").weights, std::vector<double>{1});
  EXPECT_EQ(rule("trapezoid").nodes, (std::vector<double>{0, 1}));
  EXPECT_EQ(rule("trapezoid").weights, (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(rule("simpson").nodes, (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(rule("simpson").weights, (std::vector<double>{1 / 6., 2 / 3., 1 / 6.}));
  EXPECT_EQ(rule("linear").nodes, gauss_rule(5).nodes);
  EXPECT_EQ(rule("quadratic").weights, gauss_rule(5).weights);
  EXPECT_EQ(rule("lobatto(4)").nodes, lobatto_rule(5).nodes);
  EXPECT_EQ(rule("gauss(4)").nodes, gauss_rule(4).nodes);
}

}  // namespace
}  // namespace extremal
