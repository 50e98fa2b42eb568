#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "formula_support.hpp"

namespace extremal {
namespace {

const std::map<std::string, ParameterText> parameters{
    {"a", {{2.5}}}, {"n", {{4}}}, {"m", {{1, 2, 4, 8}, true}}};

double number_of(const std::string& text) { return number(text, parameters, "duration"); }
std::string refusal(const std::string& text) {
  return error_of([&] { number_of(text); });
}

TEST(FormulaNumber, PowersBindTightestAndToTheRight) {
  EXPECT_EQ(number_of("-2^2"), -4);
  EXPECT_EQ(number_of("2^3^2"), 512);
  EXPECT_EQ(number_of("2^-1"), 0.5);
  EXPECT_EQ(number_of("2*3^2"), 18);
  EXPECT_EQ(number_of("(-2)^2"), 4);
  EXPECT_EQ(number_of("-2^-2^2"), -0.0625);
  EXPECT_EQ(number_of("2^2*3"), 12);
}

TEST(FormulaNumber, OperatorsOfOneRankRunFromLeftToRight) {
  EXPECT_EQ(number_of("10 - 4 - 3"), 3);
  EXPECT_EQ(number_of("24/4/2"), 3);
  EXPECT_EQ(number_of("24/4*2"), 12);
  EXPECT_EQ(number_of("1 - 2*3 + 4"), -1);
  EXPECT_EQ(number_of("2 - (3 - 4)"), 3);
  EXPECT_EQ(number_of("2*-3"), -6);
  EXPECT_EQ(number_of("--3 + +1 - -1"), 5);
}

TEST(FormulaNumber, NumbersAreReadAsWritten) {
  EXPECT_EQ(number_of("1"), 1);
  EXPECT_EQ(number_of("1.5"), 1.5);
  EXPECT_EQ(number_of("1e-3"), 1e-3);
  EXPECT_EQ(number_of("2.5E+2"), 250);
  EXPECT_EQ(number_of(".5"), 0.5);
  EXPECT_EQ(number_of("0.1"), 0.1);
  EXPECT_EQ(number_of("\t1\n + 1\r\n"), 2);
  EXPECT_EQ(number_of("pi"), std::numbers::pi);
}

TEST(FormulaNumber, FunctionsAreThoseOfTheStandardLibrary) {
  EXPECT_EQ(number_of("sin(0.6)"), std::sin(0.6));
  EXPECT_EQ(number_of("cos(0.6)"), std::cos(0.6));
  EXPECT_EQ(number_of("tan(0.6)"), std::tan(0.6));
  EXPECT_EQ(number_of("asin(0.6)"), std::asin(0.6));
  EXPECT_EQ(number_of("acos(0.6)"), std::acos(0.6));
  EXPECT_EQ(number_of("atan(0.6)"), std::atan(0.6));
  EXPECT_EQ(number_of("atan2(-0.6, -0.3)"), std::atan2(-0.6, -0.3));
  EXPECT_EQ(number_of("sinh(0.6)"), std::sinh(0.6));
  EXPECT_EQ(number_of("cosh(0.6)"), std::cosh(0.6));
  EXPECT_EQ(number_of("tanh(0.6)"), std::tanh(0.6));
  EXPECT_EQ(number_of("exp(0.6)"), std::exp(0.6));
  EXPECT_EQ(number_of("log(0.6)"), std::log(0.6));
  EXPECT_EQ(number_of("sqrt(0.6)"), std::sqrt(0.6));
  EXPECT_EQ(number_of("abs(-0.6)"), 0.6);
  EXPECT_EQ(number_of("min(2, -1)"), -1);
  EXPECT_EQ(number_of("max(2, -1)"), 2);
}

TEST(FormulaNumber, ParametersListsAndSums) {
  EXPECT_EQ(number_of("a*m[3]"), 10);
  EXPECT_EQ(number_of("m[n]"), 8);
  EXPECT_EQ(number_of("sum(i, 1, n, m[i])"), 15);
  EXPECT_EQ(number_of("sum(i, 1, n, sum(j, i + 1, n, m[i]*m[j]))"), 70);
  EXPECT_EQ(number_of("sum(i, 5, n, 1/0)"), 0);
  EXPECT_EQ(number_of("sum(i, 0, 2, i)*sum(i, -1, 3, i^2)"), 45);
}

TEST(FormulaNumber, MalformedFormulasAreRefusedWhereTheyBreak) {
  EXPECT_EQ(refusal(""), "the formula is empty | duration | 0");
  EXPECT_EQ(refusal("  "), "the formula is empty | duration | 0");
  EXPECT_EQ(refusal("1 +"), "the formula ends where a value is expected | duration | 3");
  EXPECT_EQ(refusal("2 a"),
            "unexpected 'a'; write '*' to multiply, and numbers without units | duration | 2");
  EXPECT_EQ(refusal("(a) a"), "unexpected 'a'; write '*' to multiply | duration | 4");
  EXPECT_EQ(refusal("sin a"), "unexpected 'a'; write sin(…) | duration | 4");
  EXPECT_EQ(refusal("(1)(2)"), "unexpected '('; write '*' to multiply | duration | 3");
  EXPECT_EQ(refusal("2**3"), "unexpected '*'; a power is written '^' | duration | 2");
  EXPECT_EQ(refusal("1)"), "unexpected ')'; no '(' is open | duration | 1");
  EXPECT_EQ(refusal("a = 1"), "unexpected '='; a formula has no '=' | duration | 2");
  EXPECT_EQ(refusal("2*(1 + a"), "')' is missing for the '(' of (1 + a | duration | 8");
  EXPECT_EQ(refusal("(1 + a = 2"), "')' is missing for the '(' of (1 + a, before '=' | duration | 7");
  EXPECT_EQ(refusal("m[1"), "']' is missing for the '[' of [1 | duration | 3");
  EXPECT_EQ(refusal("()"), "a value is missing before ')' | duration | 1");
  EXPECT_EQ(refusal("1 + * 2"), "unexpected '*' | duration | 4");
  EXPECT_EQ(refusal("1e999"), "the number 1e999 is beyond the range of double | duration | 0");
  EXPECT_EQ(refusal("2 + a\xce\xb8"),
            "unexpected character '\xce\xb8'; names are made of the letters a-z and "
            "A-Z, digits and _ | duration | 5");
  EXPECT_EQ(refusal("2·a"), "unexpected character '·'; write * | duration | 1");
  EXPECT_EQ(refusal("a²"), "unexpected character '²'; write ^2 | duration | 1");
  EXPECT_EQ(refusal("1,5*a"), "unexpected ','; decimals are written with a point | duration | 1");
  EXPECT_EQ(refusal("1 + \xff"),
            "unexpected character '\\xff'; names are made of the letters a-z and A-Z, "
            "digits and _ | duration | 4");
  EXPECT_EQ(refusal("m[1, 2]"), "'m' takes one index | duration | 3");
  EXPECT_EQ(refusal("sum(i, 1, 2)"),
            "sum takes an index, two bounds and a body: sum(i, from, to, body) | "
            "duration | 11");
  EXPECT_EQ(refusal("sum(1, 2, 3, 4)"), "the index is missing; write sum(i, from, to, body) | duration | 4");
  EXPECT_EQ(refusal("sum + 1"), "'sum' is a function; write sum(i, from, to, body) | duration | 0");
}

TEST(FormulaNumber, UnknownNamesAreMended) {
  EXPECT_EQ(refusal("1 + sn(a)"), "unknown function 'sn'; did you mean 'sin'? | duration | 4");
  EXPECT_EQ(refusal("a*sqr"),
            "unknown name 'sqr'; is it a parameter that is not declared? Declared: a, m, n | duration | 2");
  EXPECT_EQ(refusal("2*na"), "unknown name 'na'; did you mean 'n*a'? | duration | 2");
  EXPECT_EQ(refusal("npi"), "unknown name 'npi'; did you mean 'n*pi'? | duration | 0");
  EXPECT_EQ(refusal("sqr(a)"), "unknown function 'sqr'; did you mean 'sqrt'? | duration | 0");
  EXPECT_EQ(refusal("ln(a)"), "unknown function 'ln'; ln(u) is written log(u) | duration | 0");
  EXPECT_EQ(refusal("pow(a, 2)"), "unknown function 'pow'; pow(u, v) is written u^v | duration | 0");
  EXPECT_EQ(refusal("cot(a)"), "unknown function 'cot'; cot(u) is written 1/tan(u) | duration | 0");
  EXPECT_EQ(refusal("sgn(a)"),
            "unknown function 'sgn'; sgn(u)*u is written abs(u), sgn(u) in a force u/abs(u), and of t and "
            "parameters 2*step(u) - 1 | duration | 0");
  EXPECT_EQ(refusal("e^a"), "unknown name 'e'; exp(u) is written for e^u | duration | 0");
  EXPECT_EQ(refusal("q + 1"),
            "unknown name 'q'; is it a parameter that is not declared? Declared: a, m, n | duration | 0");
  EXPECT_EQ(
      refusal("besselj(a)"),
      "unknown function 'besselj'; known are sum sin cos tan asin acos atan atan2 sinh cosh tanh exp log "
      "sqrt abs min max step | duration | 0");
  EXPECT_EQ(refusal("a(2)"), "'a' is a parameter, not a function; write a*(…) to multiply | duration | 0");
  EXPECT_EQ(refusal("2*sin"), "'sin' is a function; write sin(…) | duration | 2");
  EXPECT_EQ(refusal("atan2(1)"), "atan2 takes 2 arguments, here are 1 | duration | 0");
  EXPECT_EQ(refusal("sin(1, 2)"), "sin takes 1 argument, here are 2 | duration | 0");
  EXPECT_EQ(refusal("2*t"), "unknown name 't'; the time cannot stand here | duration | 2");
  EXPECT_EQ(refusal("a'"),
            "'a' is a parameter and has no velocity; only coordinates and definitions have | duration | 0");
  EXPECT_EQ(refusal("m + 1"), "'m' has 4 elements; write m[1] … m[4] | duration | 0");
  EXPECT_EQ(refusal("a[1]"), "'a' is a parameter without elements; write a | duration | 0");
}

TEST(FormulaNumber, ValuesOutOfRangeAreRefusedWithTheNumbers) {
  EXPECT_EQ(refusal("m[5]"), "m[5] is out of range: 'm' has 4 elements, counted from 1 | duration | 0");
  EXPECT_EQ(refusal("m[0]"), "m[0] is out of range: 'm' has 4 elements, counted from 1 | duration | 0");
  EXPECT_EQ(refusal("m[n/8]"), "the index of 'm' is 0.5, not an integer | duration | 2");
  EXPECT_EQ(refusal("sum(i, 1, n, m[i + 1])"),
            "m[5] is out of range: 'm' has 4 elements, counted from 1 (at i = 4) | duration | 13");
  EXPECT_EQ(refusal("m[1 + 1e-300]"),
            "1 is an integer only by rounding; write it in integers | duration | 2");
  EXPECT_EQ(refusal("sum(i, 1, 2, m[i + 1e-300])"),
            "1 is an integer only by rounding (at i = 1); write it in integers | duration | 15");
  EXPECT_EQ(refusal("sum(i, 1, 2, m[3*i/3])"), "no error");
  EXPECT_EQ(refusal("sum(i, 1, a, i)"), "the upper bound of a sum is 2.5, not an integer | duration | 10");
  EXPECT_EQ(refusal("1/0"), "the value is not finite | duration | 0");
  EXPECT_EQ(refusal("1 + log(-1)"), "the value is not finite | duration | 0");
  EXPECT_EQ(refusal("sum(i, 1, 1e14, 1/i)"),
            "the sums take more than 300000000 operations; make them shorter | duration | 16");
}

TEST(FormulaNumber, NestingIsBounded) {
  const auto nested = [](int depth) { return std::string(depth, '(') + "1" + std::string(depth, ')'); };
  EXPECT_EQ(number_of(nested(400)), 1);
  const std::string message = "nested more than 500 deep; name parts of it as definitions | duration | ";
  EXPECT_EQ(refusal(nested(1'000'000)), message + "500");
  EXPECT_EQ(refusal(std::string(1'000'000, '(')), message + "500");
  std::string power = "1";
  for (int k = 0; k < 100'000; ++k) power += "^1";
  EXPECT_EQ(refusal(power), message + "1000");
  std::string index = "1";
  for (int k = 0; k < 1000; ++k) index = "m[" + index + "]";
  EXPECT_EQ(refusal(index), message + "1000");
  EXPECT_EQ(number_of(std::string(1'000'000, '-') + "1"), 1);
  std::string sum = "1";
  for (int k = 0; k < 100'000; ++k) sum += "+1";
  EXPECT_EQ(number_of(sum), 100'001);
}

TEST(FormulaNumber, ParametersAreChecked) {
  const auto refused = [](const std::string& name, ParameterText text) {
    return error_of([&] { number("1", std::map<std::string, ParameterText>{{name, text}}, "duration"); });
  };
  EXPECT_EQ(refused("2m", {{1}}),
            "'2m' is not a name: it takes letters, digits and _, and no digit first | parameters.2m | 0");
  EXPECT_EQ(refused("sin", {{1}}),
            "'sin' is a function; choose another name for a parameter | parameters.sin | 0");
  EXPECT_EQ(refused("t", {{1}}), "'t' is the time; choose another name for a parameter | parameters.t | 0");
  EXPECT_EQ(refused("T", {{1}}),
            "'T' is the duration; choose another name for a parameter | parameters.T | 0");
  EXPECT_EQ(refused("pi", {{1}}),
            "'pi' is a constant of the language; choose another name for a parameter | parameters.pi | 0");
  EXPECT_EQ(refused("g", {{std::numeric_limits<double>::infinity()}}),
            "the parameter 'g' is inf; it must be finite | parameters.g | 0");
  EXPECT_EQ(refused("g", {{1, 2}}),
            "the parameter 'g' has 2 numbers; it is one number, or a list | parameters.g | 0");
}

TEST(FormulaNumber, GuessesAreTabulated) {
  const std::vector<double> times{0, 0.5, 2};
  EXPECT_EQ(tabulate("a*t/T", parameters, 2, times, 0, "guess.x"), (std::vector<double>{0, 0.625, 2.5}));
  EXPECT_EQ(tabulate("m[i]*t + i", parameters, 2, times, 3, "guess.q"), (std::vector<double>{3, 5, 11}));
  EXPECT_EQ(tabulate("sum(k, 1, i, k*t)", parameters, 2, times, 3, "guess.q"),
            (std::vector<double>{0, 3, 12}));
  const auto refused = [&](const std::string& text, int index) {
    return error_of([&] { tabulate(text, parameters, 2, times, index, "guess.x"); });
  };
  EXPECT_EQ(refused("i*t", 0),
            "unknown name 'i'; is it a parameter that is not declared? Declared: a, m, n | guess.x | 0");
  EXPECT_EQ(refused("1/t", 0), "the guess is not finite at t = 0 | guess.x | 0");
  EXPECT_EQ(refused("m[i]", 5),
            "m[5] is out of range: 'm' has 4 elements, counted from 1 (at i = 5) | guess.x | 0");
  EXPECT_EQ(refused("m[t]", 1), "an index is made of numbers, parameters and indices only | guess.x | 2");
  EXPECT_EQ(refused("sum(i, 1, 2, i)", 1),
            "the index 'i' is an index already; choose another name for it | guess.x | 4");
  EXPECT_EQ(error_of([&] {
              tabulate("1 + i", std::map<std::string, ParameterText>{{"i", {{7}}}}, 2, times, 1, "guess.x");
            }),
            "'i' is the index of the element and a parameter; rename that one | guess.x | 4");
  EXPECT_EQ(tabulate("1 + i", std::map<std::string, ParameterText>{{"i", {{7}}}}, 2, {}, 0, "guess.x"),
            std::vector<double>{});
}

TEST(FormulaNumber, NearestNameKnowsTyposButNotStrangers) {
  const std::vector<std::string> known{"kinetic", "potential", "x", "mu", "omega"};
  EXPECT_EQ(nearest_name("kinetc", known), "kinetic");
  EXPECT_EQ(nearest_name("kineitc", known), "kinetic");
  EXPECT_EQ(nearest_name("Kinetic", known), "kinetic");
  EXPECT_EQ(nearest_name("potental", known), "potential");
  EXPECT_EQ(nearest_name("mo", known), "mu");
  EXPECT_EQ(nearest_name("y", known), "");
  EXPECT_EQ(nearest_name("temperature", known), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'a'), known), "");
}

}  // namespace
}  // namespace extremal
