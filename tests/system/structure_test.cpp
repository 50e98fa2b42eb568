#include "system/structure.hpp"

#include <gtest/gtest.h>

#include <string>

#include "system/oracle.hpp"
#include "system/systems.hpp"

namespace extremal {
namespace {

Structure structure_of(const LagrangianGraph& l) { return make_lagrangian(l)->structure(); }

TEST(Structure, KeplerIsANumberMassAndAPotential) {
  const Structure s = structure_of(systems::kepler());
  EXPECT_TRUE(s.quadratic);
  EXPECT_TRUE(s.autonomous);
  EXPECT_TRUE(s.velocity_free);
  ASSERT_EQ(s.mass.size(), 2u);
  for (int a = 0; a < 2; ++a) {
    EXPECT_EQ(s.mass[a].row, a);
    EXPECT_EQ(s.mass[a].column, a);
    EXPECT_EQ(s.mass[a].value, 1);
  }
  EXPECT_TRUE(s.gyroscopic.empty());
  EXPECT_TRUE(s.linear.empty());
  EXPECT_EQ(s.gradient, (std::vector<int>{0, 1}));
  EXPECT_EQ(s.hessian.size(), 3u);
}

TEST(Structure, TheRotatingFrameIsGyroscopic) {
  const Structure s = structure_of(systems::restricted());
  EXPECT_TRUE(s.quadratic && s.velocity_free && s.autonomous);
  ASSERT_EQ(s.gyroscopic.size(), 2u);  // v_x (−y) + v_y x
  EXPECT_EQ(s.gyroscopic[0].row, 0);
  EXPECT_EQ(s.gyroscopic[0].column, 1);
  EXPECT_EQ(s.gyroscopic[0].value, -1);
  EXPECT_EQ(s.gyroscopic[1].value, 1);
}

TEST(Structure, AConstantVectorPotentialIsLinear) {
  const Structure s = structure_of(systems::uniform_magnetic());
  EXPECT_TRUE(s.quadratic);
  EXPECT_EQ(s.mass[1].value, 3);
  EXPECT_EQ(s.linear, (std::vector<double>{5, 0}));
  EXPECT_EQ(s.gradient, (std::vector<int>{1}));  // of −exp(y)
}

TEST(Structure, WhatVariesIsNotQuadratic) {
  for (const LagrangianGraph& l : {systems::double_pendulum(), systems::magnetic(), systems::torus()}) {
    const Structure s = structure_of(l);
    EXPECT_FALSE(s.quadratic);
    EXPECT_FALSE(s.velocity_free);
    EXPECT_TRUE(s.mass.empty() && s.gyroscopic.empty() && s.linear.empty());
  }
}

TEST(Structure, TimeInThePotentialLeavesTheMassAlone) {
  const Structure s = structure_of(systems::driven());
  EXPECT_TRUE(s.quadratic);
  EXPECT_FALSE(s.autonomous);
}

TEST(Structure, FrequenciesOfTime) {
  const Structure s = structure_of(trace_graph(2, [](auto q, auto v, auto t) {
    return v[0] * v[0] + v[1] * v[1] + q[0] * cos(2 * t + 1) - sin(q[1] - 3 * t);
  }));
  EXPECT_TRUE(s.harmonic);
  EXPECT_EQ(s.frequencies, (std::vector<double>{2, 3}));
  EXPECT_FALSE(structure_of(trace_graph(1, [](auto q, auto v, auto t) {
                 return v[0] * v[0] + q[0] * cos(t * t);
               })).harmonic);
  EXPECT_FALSE(structure_of(trace_graph(1, [](auto q, auto v, auto t) {
                 return v[0] * v[0] + q[0] * cos(t) + q[0] * q[0] * t;
               })).harmonic);
  EXPECT_TRUE(structure_of(systems::kepler()).frequencies.empty());
}

TEST(Structure, Pulses) {
  const auto potential = [](auto make) {
    return structure_of(
               trace_graph(1, [&](auto q, auto v, auto t) { return v[0] * v[0] / 2 - make(q[0], t); }))
        .pulses;
  };
  EXPECT_TRUE(potential([](auto q, auto t) { return q * exp(-t * t); }));
  EXPECT_TRUE(potential([](auto q, auto) { return exp(-(q - 1) * (q - 1)); }));
  EXPECT_TRUE(potential([](auto q, auto) { return tanh(q); }));
  EXPECT_TRUE(potential([](auto q, auto t) { return q / (cosh(t) * cosh(t)); }));
  EXPECT_TRUE(potential([](auto q, auto t) { return q * pow(sin(t), 40); }));
  EXPECT_TRUE(potential([](auto q, auto t) { return q * exp(sin(t)); }));
  EXPECT_FALSE(potential([](auto q, auto t) { return q * exp(-3 * t) * sin(q + 5 * t) + q * q * t * t; }));
  EXPECT_FALSE(potential([](auto q, auto) { return exp(-2 * q) - 2 * exp(-q) + cosh(q); }));
  EXPECT_FALSE(potential([](auto q, auto) { return 1 / sqrt(q * q + 1e-4) + pow(q, -12); }));
}

TEST(Structure, AVelocityTimesTimeIsNotQuadratic) {
  const Structure s =
      structure_of(trace_graph(1, [](auto, auto v, auto t) { return v[0] * v[0] / 2 + sin(t) * v[0]; }));
  EXPECT_FALSE(s.quadratic);
  EXPECT_EQ(s.gradient, (std::vector<int>{1}));
}

TEST(Structure, TimeThatCancelsIsNotSeen) {
  EXPECT_TRUE(structure_of(trace_graph(1, [](auto q, auto v, auto t) {
                return v[0] * v[0] / 2 + (q[0] * sin(t) - sin(t) * q[0]) - q[0] * q[0];
              })).autonomous);
}

TEST(Structure, AFreeParticleHasNoRemainder) {
  const Structure s =
      structure_of(trace_graph(2, [](auto, auto v, auto) { return v[0] * v[1] + 2 * v[1] * v[1]; }));
  EXPECT_TRUE(s.quadratic);
  EXPECT_EQ(s.mass.size(), 3u);
  EXPECT_TRUE(s.gradient.empty() && s.hessian.empty());
}

TEST(Structure, AnActiveMassIsNotConstant) {
  LagrangianGraph l = systems::bodies(2);
  EXPECT_TRUE(structure_of(l).quadratic);  // active: the constant of gravity
  l.parameters = 2;                        // and the first mass
  EXPECT_FALSE(structure_of(l).quadratic);
}

TEST(Structure, TheHessianOfAChainIsTridiagonal) {
  const int n = 10000;
  const Structure s = structure_of(systems::chain(n, false));
  EXPECT_TRUE(s.quadratic);
  EXPECT_EQ(s.mass.size(), static_cast<std::size_t>(n));
  EXPECT_EQ(s.gradient.size(), static_cast<std::size_t>(n));
  ASSERT_EQ(s.hessian.size(), static_cast<std::size_t>(2 * n - 1));
  for (const auto& [row, column] : s.hessian) EXPECT_LE(row - column, 1);
  EXPECT_EQ(structure_of(systems::chain(n, true)).hessian.size(), static_cast<std::size_t>(2 * n));
}

TEST(Structure, AWrittenOutChainIsSparseToo) {
  const int n = 2000;
  const Structure s = structure_of(trace_graph(n, [](auto q, auto v, auto) {
    Symbol sum = v[0] * v[0] / 2;
    for (int k = 1; k < n; ++k) sum += v[k] * v[k] / 2 - pow(q[k] - q[k - 1], 4);
    return sum;
  }));
  EXPECT_EQ(s.mass.size(), static_cast<std::size_t>(n));
  EXPECT_EQ(s.hessian.size(), static_cast<std::size_t>(2 * n - 1));
}

TEST(Structure, MalformedLagrangiansAreRefusedWithNumbers) {
  const auto message = [](LagrangianGraph l) {
    try {
      make_lagrangian(std::move(l));
    } catch (const std::invalid_argument& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  LagrangianGraph none = systems::kepler();
  none.coordinates = 0;
  EXPECT_EQ(message(none), "coordinates = 0; need at least 1");
  LagrangianGraph beyond = systems::kepler();
  beyond.terms[0].table[3] = 5;
  EXPECT_EQ(message(beyond), "a term names input 5; there are 5");
  LagrangianGraph ragged = systems::chain(4, false);
  ragged.terms[1].table.push_back(0);
  EXPECT_EQ(message(ragged), "a table of 7 entries for a term of 2 inputs");
  LagrangianGraph narrow = systems::kepler();
  narrow.terms[0].arity = 1;
  narrow.terms[0].table.resize(1);
  EXPECT_EQ(message(narrow), "a term reads input 3 of 1");
  LagrangianGraph active = systems::kepler();
  active.parameters = 1;
  EXPECT_EQ(message(active), "parameters = 1 of 0 uniforms");
}

}  // namespace
}  // namespace extremal
