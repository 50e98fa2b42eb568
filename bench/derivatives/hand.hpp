#pragma once

#include <cmath>

#include "systems.hpp"

/// \file Value, gradient and Hessian written by hand: out = (value, gradient, packed lower triangle).

namespace bench {

inline void by_hand(Kepler, const double* z, double* out) {
  const double x = z[0], y = z[1], u = 1 / std::sqrt(x * x + y * y), u2 = u * u, u3 = u2 * u,
               u5 = 3 * u3 * u2;
  out[0] = u;
  out[1] = -x * u3;
  out[2] = -y * u3;
  out[3] = x * x * u5 - u3;
  out[4] = x * y * u5;
  out[5] = y * y * u5 - u3;
}

inline void by_hand(Restricted, const double* z, double* out) {
  constexpr double mu = Restricted::mu;
  const double x = z[0], y = z[1], a = x + mu, b = x - (1 - mu), yy = y * y;
  const double u = 1 / std::sqrt(a * a + yy), w = 1 / std::sqrt(b * b + yy);
  const double u2 = u * u, w2 = w * w, u3 = (1 - mu) * u2 * u, w3 = mu * w2 * w, u5 = 3 * u3 * u2,
               w5 = 3 * w3 * w2;
  out[0] = 0.5 * (x * x + yy) + (1 - mu) * u + mu * w;
  out[1] = x - a * u3 - b * w3;
  out[2] = y * (1 - u3 - w3);
  out[3] = 1 - u3 - w3 + a * a * u5 + b * b * w5;
  out[4] = y * (a * u5 + b * w5);
  out[5] = 1 - u3 - w3 + yy * (u5 + w5);
}

inline void by_hand(DoublePendulum, const double* z, double* out) {
  constexpr double g = DoublePendulum::g;
  const double c = std::cos(z[0] - z[1]), s = std::sin(z[0] - z[1]), v = z[2], w = z[3];
  const double ca = std::cos(z[0]), sa = std::sin(z[0]), cb = std::cos(z[1]), sb = std::sin(z[1]);
  out[0] = v * v + 0.5 * w * w + v * w * c + g * (2 * ca + cb);
  out[1] = -v * w * s - 2 * g * sa;
  out[2] = v * w * s - g * sb;
  out[3] = 2 * v + w * c;
  out[4] = w + v * c;
  out[5] = -v * w * c - 2 * g * ca;
  out[6] = v * w * c;
  out[7] = -v * w * c - g * cb;
  out[8] = -w * s;
  out[9] = w * s;
  out[10] = 2;
  out[11] = -v * s;
  out[12] = v * s;
  out[13] = c;
  out[14] = 1;
}

template <int bodies, int dimension>
void by_hand(Gravity<bodies, dimension>, const double* z, double* out) {
  constexpr int n = bodies * dimension;
  double* const gradient = out + 1;
  double* const hessian = out + 1 + n;
  for (int k = 0; k < 1 + n + n * (n + 1) / 2; ++k) out[k] = 0;
  for (int i = 1; i < bodies; ++i) {
    for (int j = 0; j < i; ++j) {
      double d[dimension], square = 0;
      for (int k = 0; k < dimension; ++k) {
        d[k] = z[i * dimension + k] - z[j * dimension + k];
        square += d[k] * d[k];
      }
      const double u = 1 / std::sqrt(square), u3 = u * u * u, u5 = 3 * u3 * u * u;
      out[0] += u;
      for (int k = 0; k < dimension; ++k) {
        const int a = i * dimension + k, b = j * dimension + k;
        gradient[a] -= d[k] * u3;
        gradient[b] += d[k] * u3;
        for (int l = 0; l < dimension; ++l) {
          const int c = i * dimension + l, e = j * dimension + l;
          const double h = d[k] * d[l] * u5 - (k == l ? u3 : 0);
          if (l <= k) hessian[a * (a + 1) / 2 + c] += h;
          if (l <= k) hessian[b * (b + 1) / 2 + e] += h;
          hessian[a * (a + 1) / 2 + e] -= h;
        }
      }
    }
  }
}

}  // namespace bench
