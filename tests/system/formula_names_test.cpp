#include <fmt/format.h>
#include <gtest/gtest.h>

#include "formula_support.hpp"

namespace extremal {
namespace {

std::string numbered(int k) { return fmt::format("d{}", k); }

const std::string free_particle = "x'^2/2";

TEST(FormulaNames, CoordinatesAreDeclared) {
  SystemText text{.coordinates = {"x", "q[3]", "r[2*n]", " y "}, .parameters = {{"n", {{2}}}}};
  const formula::Names names = formula::names_of(text);
  ASSERT_EQ(names.coordinates.size(), 4u);
  EXPECT_EQ(names.elements, 9);
  EXPECT_EQ(names.coordinates[1].name, "q");
  EXPECT_EQ(names.coordinates[1].first, 1);
  EXPECT_EQ(names.coordinates[1].count, 3);
  EXPECT_TRUE(names.coordinates[1].array);
  EXPECT_EQ(names.coordinates[2].first, 4);
  EXPECT_EQ(names.coordinates[2].count, 4);
  EXPECT_EQ(names.coordinates[3].name, "y");
  EXPECT_FALSE(names.coordinates[3].array);
}

TEST(FormulaNames, MalformedCoordinatesAreRefused) {
  const auto refused = [](std::vector<std::string> coordinates) {
    return error_of({.coordinates = coordinates,
                     .parameters = {{"n", {{2}}}, {"h", {{0.5}}}, {"k", {{2}}}},
                     .lagrangian = "1",
                     .active = {"k"}});
  };
  EXPECT_EQ(refused({}), "no coordinates; need at least 1 | coordinates | 0");
  EXPECT_EQ(refused({"x", "x"}),
            "'x' is a coordinate already; choose another name for a coordinate | coordinates[1] | 0");
  EXPECT_EQ(refused({"n"}),
            "'n' is a parameter already; choose another name for a coordinate | coordinates[0] | 0");
  EXPECT_EQ(refused({"sin"}),
            "'sin' is a function; choose another name for a coordinate | coordinates[0] | 0");
  EXPECT_EQ(refused({"t"}), "'t' is the time; choose another name for a coordinate | coordinates[0] | 0");
  EXPECT_EQ(refused({"2"}),
            "'2' does not declare a coordinate; write x, or x[32] for an array | coordinates[0] | 0");
  EXPECT_EQ(refused({"x'"}),
            "'x'' does not declare a coordinate; write x, or x[32] for an array | coordinates[0] | 0");
  EXPECT_EQ(refused({"x[0]"}), "'x' would have 0 elements; need at least 1 | coordinates[0] | 0");
  EXPECT_EQ(refused({"x[h]"}), "the size of an array is 0.5, not an integer | coordinates[0] | 2");
  EXPECT_EQ(refused({"x[k]"}), "'k' is not a number when the formula is read | coordinates[0] | 2");
  EXPECT_EQ(refused({"x", "y[x]"}),
            "'x' is a coordinate; only parameters can stand here | coordinates[1] | 2");
  EXPECT_EQ(refused({"x", "y[1e6]"}),
            "'y' has 1000000 elements after 1; 1000000 are the most in all | coordinates[1] | 0");
  EXPECT_EQ(refused({""}), "the formula is empty | coordinates[0] | 0");
}

TEST(FormulaNames, StepsAreOfTimeAndParameters) {
  const auto refused = [](const std::string& lagrangian) {
    return error_of({.coordinates = {"x"},
                     .parameters = {{"a", {{2}}}},
                     .definitions = {{"late", "t - a"}, {"right", "x - a"}},
                     .lagrangian = lagrangian});
  };
  const std::string reason =
      "step(u) jumps where u passes 0, and a Lagrangian must not jump along a motion: u is made of t and "
      "parameters only; max(0, u) has the slope step(u) | lagrangian | ";
  EXPECT_EQ(refused("x'^2/2 + x*step(x)"), reason + "11");
  EXPECT_EQ(refused("x'^2/2 + step(2*x')"), reason + "9");
  EXPECT_EQ(refused("x'^2/2 + step(right)"), reason + "9");
  EXPECT_EQ(refused("step(t, a)"), "step takes 1 argument, here are 2 | lagrangian | 0");
  const SystemText text{.coordinates = {"x"},
                        .parameters = {{"a", {{2}}}},
                        .definitions = {{"late", "t - a"}},
                        .lagrangian = "x*step(late) + step(a) + step(-a)"};
  EXPECT_EQ(value_of(text, {3}, {0}, 1.9), 1);
  EXPECT_EQ(value_of(text, {3}, {0}, 2), 4);
}

TEST(FormulaNames, ActiveParametersAreSingleNumbers) {
  const auto refused = [](std::vector<std::string> active) {
    return error_of({.coordinates = {"x"},
                     .parameters = {{"g", {{2}}}, {"m", {{1, 2}, true}}},
                     .lagrangian = free_particle,
                     .active = active});
  };
  EXPECT_EQ(refused({"g"}), "no error");
  EXPECT_EQ(refused({"g", "k"}), "there is no parameter 'k' | active[1] | 0");
  EXPECT_EQ(refused({"m"}), "'m' is a list; only single parameters can be active | active[0] | 0");
}

TEST(FormulaNames, UnknownNamesAreMended) {
  const auto refused = [](const std::string& lagrangian) {
    return error_of({.coordinates = {"x", "q[4]"},
                     .parameters = {{"mu", {{1}}}},
                     .definitions = {{"kinetic", "x'^2/2"}},
                     .lagrangian = lagrangian});
  };
  EXPECT_EQ(refused("kinetc - mu*x"), "unknown name 'kinetc'; did you mean 'kinetic'? | lagrangian | 0");
  EXPECT_EQ(refused("kinetic - m*x"),
            "unknown name 'm'; is it a parameter that is not declared? Declared: mu | lagrangian | 10");
  EXPECT_EQ(
      refused("x' + T"),
      "unknown name 'T'; T is the duration only in a guess, and in x(T) in a condition | lagrangian | 5");
  EXPECT_EQ(refused("x'^2 - x(0)"),
            "'x' is a coordinate, not a function; write x*(…) to multiply | lagrangian | 7");
  EXPECT_EQ(refused("q(x)"),
            "'q' is a coordinate, not a function; write q[1]*(…) to multiply | lagrangian | 0");
  EXPECT_EQ(refused("q'^2"), "'q' has 4 elements; write q[1] … q[4] | lagrangian | 0");
  EXPECT_EQ(refused("x[1]"), "'x' is a coordinate without elements; write x | lagrangian | 0");
  EXPECT_EQ(refused("q[5]"), "q[5] is out of range: 'q' has 4 elements, counted from 1 | lagrangian | 0");
  EXPECT_EQ(refused("q'[1]"), "the index stands before the prime: q[…]' | lagrangian | 2");
  EXPECT_EQ(refused("x''"), "a second \"'\"; formulas know first derivatives only | lagrangian | 2");
  EXPECT_EQ(refused("t'"), "'t' has no velocity; only coordinates and definitions have | lagrangian | 0");
  EXPECT_EQ(
      refused("mu'"),
      "'mu' is a parameter and has no velocity; only coordinates and definitions have | lagrangian | 0");
  EXPECT_EQ(refused("kinetic'"),
            "'kinetic' has velocities in it, so \"kinetic'\" would need second derivatives | lagrangian | 0");
  EXPECT_EQ(refused("pi[1]"), "'pi' is one number and takes no index | lagrangian | 0");
  EXPECT_EQ(refused("q[x]"), "an index is made of numbers, parameters and indices only | lagrangian | 2");
}

TEST(FormulaNames, VelocitiesInOtherNotations) {
  const auto refused = [](const std::string& lagrangian) {
    const std::string error = error_of({.coordinates = {"x", "q[4]"}, .lagrangian = lagrangian});
    const auto mend = error.find(';');
    return mend == error.npos ? error : error.substr(mend + 2, error.find(" |") - mend - 2);
  };
  for (const char* name : {"dx/dt", "dx", "x_dot", "xdot", "v_x", "vx", "diff(x, t)", "x_t"})
    EXPECT_EQ(refused(std::string(name) + "*1"), "velocities are written x'") << name;
  EXPECT_EQ(refused("q_dot[2]^2"), "velocities are written q[1]'");
  EXPECT_EQ(refused("x'(t)^2"), "write x' for x'(t) | lagrangian | 0");
}

TEST(FormulaNames, IndicesOfSumsAreChecked) {
  const auto refused = [](const std::string& lagrangian) {
    return error_of({.coordinates = {"x", "q[4]"}, .parameters = {{"m", {{1}}}}, .lagrangian = lagrangian});
  };
  EXPECT_EQ(refused("sum(m, 1, 4, q[m])"),
            "the index 'm' is a parameter already; choose another name for it | lagrangian | 4");
  EXPECT_EQ(refused("sum(x, 1, 4, q[x])"),
            "the index 'x' is a coordinate already; choose another name for it | lagrangian | 4");
  EXPECT_EQ(refused("sum(i, 1, 4, sum(i, 1, 4, q[i]))"),
            "the index 'i' is an index already; choose another name for it | lagrangian | 17");
  EXPECT_EQ(refused("sum(cos, 1, 4, q[1])"),
            "'cos' is a word of the language; choose another name for the index | lagrangian | 4");
  EXPECT_EQ(refused("sum(i, 1, x, q[i])"),
            "a bound of a sum is made of numbers, parameters and indices only | lagrangian | 10");
  EXPECT_EQ(refused("sum(i, 1, 4, q[i]) + i"),
            "unknown name 'i'; is it a parameter that is not declared? Declared: m | lagrangian | 21");
  EXPECT_EQ(refused("sum(i, 1, i, q[i])"),
            "unknown name 'i'; is it a parameter that is not declared? Declared: m | lagrangian | 10");
  EXPECT_EQ(refused("sum(i, 1, 4, q[i + 1]^2)"),
            "q[5] is out of range: 'q' has 4 elements, counted from 1 (at i = 4) | lagrangian | 13");
  EXPECT_EQ(refused("sum(i, 1, 2, sum(j, i, 2, q[i*j + i]'))"),
            "q[6] is out of range: 'q' has 4 elements, counted from 1 (at i = 2, j = 2) | lagrangian | 26");
  EXPECT_EQ(refused("sum(i, 1, 4, i(2)*q[i])"),
            "'i' is an index, not a function; write i*(…) to multiply | lagrangian | 13");
}

TEST(FormulaNames, DefinitionsAreResolvedByDependence) {
  const SystemText text{.coordinates = {"x", "y"},
                        .parameters = {{"mu", {{2}}}},
                        .definitions = {{"energy", "T - V"},
                                        {"V", "-mu/r"},
                                        {"r", "sqrt(s)"},
                                        {"s", "x^2 + y^2"},
                                        {"T", "(x'^2 + y'^2)/2"}},
                        .lagrangian = "T - V + 0*energy"};
  EXPECT_EQ(value_of(text, {3, 4}, {1, 2}), 2.5 + 2.0 / 5);
}

TEST(FormulaNames, CyclesArePrinted) {
  SystemText text{.coordinates = {"x"},
                  .definitions = {{"a", "b + x"}, {"b", "2*c"}, {"c", "x*b"}, {"d", "2"}},
                  .lagrangian = free_particle};
  EXPECT_EQ(error_of(text), "definitions form a cycle: b -> c -> b | definitions.c | 2");
  text.lagrangian = "a";
  EXPECT_EQ(error_of(text), "definitions form a cycle: b -> c -> b | definitions.c | 2");
  text.definitions = {{"d", "d + 1"}};
  EXPECT_EQ(error_of(text), "definitions form a cycle: d -> d | definitions.d | 0");
  text.definitions = {{"a", "b + c"}, {"b", "c"}, {"c", "x"}};
  EXPECT_EQ(error_of(text), "no error");
}

TEST(FormulaNames, UnusedDefinitionsAreOnlyParsed) {
  SystemText text{.coordinates = {"x"}, .definitions = {{"a", "unknown(x)"}}, .lagrangian = free_particle};
  EXPECT_EQ(error_of(text), "no error");
  text.definitions["a"] = "2*(x";
  EXPECT_EQ(error_of(text), "')' is missing for the '(' of (x | definitions.a | 4");
  text.definitions = {{"x", "1"}};
  EXPECT_EQ(error_of(text),
            "'x' is a coordinate already; choose another name for a definition | definitions.x | 0");
  text.definitions = {{"a", "y"}};
  text.lagrangian = "a";
  EXPECT_EQ(error_of(text), "unknown name 'y'; is it a parameter that is not declared? | definitions.a | 0");
}

TEST(FormulaNames, DefinitionsDoNotSeeTheIndexOfASum) {
  const SystemText text{
      .coordinates = {"q[4]"}, .definitions = {{"site", "q[i]^2"}}, .lagrangian = "sum(i, 1, 4, site)"};
  EXPECT_EQ(error_of(text),
            "unknown name 'i'; is it a parameter that is not declared? | definitions.site | 2");
}

TEST(FormulaNames, LongChainsOfDefinitionsAreBounded) {
  SystemText text{.coordinates = {"x"}, .definitions = {{"d0", "x"}}};
  for (int k = 1; k <= 100'000; ++k) text.definitions[numbered(k)] = numbered(k - 1) + " + x";
  text.lagrangian = "d400";
  EXPECT_EQ(value_of(text, {0.5}, {0}), 200.5);
  text.lagrangian = "d100000";
  EXPECT_EQ(error_of(text), "nested more than 1000 deep through definitions | definitions.d500 | 0");
}

TEST(FormulaNames, DefinitionsThatDoubleAreReadOnce) {
  SystemText text{.coordinates = {"x"}, .definitions = {{"d0", "x"}}, .lagrangian = "d60"};
  for (int k = 1; k <= 60; ++k) {
    const std::string before = numbered(k - 1);
    text.definitions[numbered(k)] = "sin(" + before + ") + " + before + "/2";
  }
  EXPECT_LT(graph_of(text).graph.size(), 300u);
}

}  // namespace
}  // namespace extremal
