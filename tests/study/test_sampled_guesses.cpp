#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenes.hpp"
#include "solution/extension_values.hpp"

using namespace extremal;
using namespace extremal::test;

/// \file Guesses of which some vanish on all nodes between the first eight elements: the law, the ends and
/// the integral decide whether a scene has an extremal, not where elements sample the guess.

namespace {

class SampledGuesses : public Scenes {
 protected:
  Solution solved(const std::string& lagrangian, double end, const std::string& integral,
                  const std::string& guess) {
    const Study given = study("[system]\ncoordinates = [\"x\"]\nlagrangian = \"" + lagrangian +
                              "\"\n[boundary]\nstart = { x = " + std::to_string(end) +
                              " }\nend = { x = " + std::to_string(end) + " }\nduration = 1\nintegrals = [\"" +
                              integral + "\"]\n[guess]\nx = \"" + guess + "\"\n");
    return run(given);
  }
};

}  // namespace

/// x'' = ν and ∫x = 0.1 from 0 to 0 have the parabola x = 0.6 t (1 − t) alone, of action 0.06.
TEST_F(SampledGuesses, OneParabola) {
  for (const int halves : {4, 8, 12, 16, 24}) {
    const Solution s = solved("x'^2/2", 0, "x = 0.1", "2*sin(" + std::to_string(halves) + "*pi*t)");
    ASSERT_EQ(s.status, Status::converged) << halves << ": " << s.message;
    EXPECT_NEAR(s.action, 0.06, 1e-14) << halves;
    EXPECT_EQ(s.morse_index, 0) << halves;
  }
}

/// With ∫x² = 2 the extremals are 2 sin kπt, of action k²π² and index k − 1.
TEST_F(SampledGuesses, ModesWithANorm) {
  for (const int k : {4, 8, 12, 16}) {
    const Solution s = solved("x'^2/2", 0, "x^2 = 2", "1.9*sin(" + std::to_string(k) + "*pi*t)");
    ASSERT_EQ(s.status, Status::converged) << k << ": " << s.message;
    EXPECT_NEAR(s.action, k * k * std::numbers::pi * std::numbers::pi, 1e-11 * k * k);
    EXPECT_EQ(s.morse_index, k - 1);
  }
}

/// Rests: no momentum at all, so that what is left of forces has nothing to be compared with but what would
/// move them. At x = 0.1 the multiplier holds the force −sin x, or none.
TEST_F(SampledGuesses, Rests) {
  for (const double x : {0.1, 0.0})
    for (const char* wave : {"2*sin(8*pi*t)", "0.3*sin(pi*t)"}) {
      const std::string at = std::to_string(x), guess = at + " + " + wave;
      const Solution free = solved("x'^2/2", x, "x = " + at, guess);
      ASSERT_EQ(free.status, Status::converged) << guess << ": " << free.message;
      EXPECT_NEAR(free.action, 0, 1e-20);
      const Solution held = solved("x'^2/2 + cos(x)", x, "x = " + at, guess);
      ASSERT_EQ(held.status, Status::converged) << guess << ": " << held.message;
      EXPECT_NEAR(held.action, std::cos(x), 1e-14);
      EXPECT_NEAR(held.extension->integral_multipliers[0], std::sin(x), 1e-12);
      EXPECT_EQ(held.morse_index, 0);
    }
}
