#pragma once

#include <cstddef>

/// \file Numbers as text, millions of them.

namespace extremal {

/// Room that a number needs: more may be written than belongs to it.
inline constexpr std::size_t number_size = 48;

/// The shortest digits that give the same double again, in the notation of fmt's "{}": 0.0001 to 1e15 without
/// an exponent, a whole number without a point. Returns the end. The number must be finite.
char* write_number(double value, char* to);

/// The same as JSON tells whole numbers that were computed from those that were counted: "1.0".
char* write_real(double value, char* to);

}  // namespace extremal
