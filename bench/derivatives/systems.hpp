#pragma once

#include <cmath>

/// \file The systems of the benchmark, generic over the scalar: what is left of L once its constant
/// quadratic part is taken out, as a function of the variables z that are left with it.

namespace bench {

/// A number in the scalar T; specialised where T(double) does not exist.
template <class T>
struct Number {
  static T of(double x) { return T(x); }
};

/// z = (x, y).
struct Kepler {
  static constexpr int coordinates = 2, variables = 2;
  template <class T>
  static T remainder(const T* z) {
    using std::sqrt;
    return Number<T>::of(1) / sqrt(z[0] * z[0] + z[1] * z[1]);
  }
};

/// z = (x, y) in the rotating frame.
struct Restricted {
  static constexpr int coordinates = 2, variables = 2;
  static constexpr double mu = 0.0121505856;
  template <class T>
  static T remainder(const T* z) {
    using std::sqrt;
    const T m = Number<T>::of(mu), rest = Number<T>::of(1 - mu), half = Number<T>::of(0.5);
    const T a = z[0] + m, b = z[0] - rest, yy = z[1] * z[1];
    return half * (z[0] * z[0] + yy) + rest / sqrt(a * a + yy) + m / sqrt(b * b + yy);
  }
};

/// Unit masses and lengths; z = (angles, their rates): the mass varies, nothing is taken out.
struct DoublePendulum {
  static constexpr int coordinates = 2, variables = 4;
  static constexpr double g = 9.81;
  template <class T>
  static T remainder(const T* z) {
    using std::cos;
    const T half = Number<T>::of(0.5), g1 = Number<T>::of(g), g2 = Number<T>::of(2 * g);
    return z[2] * z[2] + half * (z[3] * z[3]) + z[2] * z[3] * cos(z[0] - z[1]) + g2 * cos(z[0]) +
           g1 * cos(z[1]);
  }
};

/// Unit masses; z = positions, body by body.
template <int bodies, int dimension>
struct Gravity {
  static constexpr int coordinates = bodies * dimension, variables = coordinates;
  template <class T>
  static T remainder(const T* z) {
    using std::sqrt;
    T sum = Number<T>::of(0);
    for (int i = 1; i < bodies; ++i) {
      for (int j = 0; j < i; ++j) {
        T square = Number<T>::of(0);
        for (int k = 0; k < dimension; ++k) {
          const T d = z[i * dimension + k] - z[j * dimension + k];
          square = square + d * d;
        }
        sum = sum + Number<T>::of(1) / sqrt(square);
      }
    }
    return sum;
  }
};

}  // namespace bench
