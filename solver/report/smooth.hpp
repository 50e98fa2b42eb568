#pragma once

#include <vector>

#include "report/result.hpp"

/// \file Curves through points that are known.

namespace extremal {

struct Polyline {
  Column x, y;
};

/// A smooth curve through points in a plane where an extent of one across and up looks alike. Each coordinate
/// is a cubic Hermite spline in the length of the chords: its slope at a point is that of the parabola
/// through the neighbours, no more than three times the smaller one of both chords (Hyman, SIAM J. Sci. Stat.
/// Comput. 4, 1983). Then a piece between two points is monotone where the points are. x turns back at points
/// alone. The curve has `pieces` chords for each chord between points. No two neighbours are the same point.
Polyline smooth(const Polyline& points, int pieces);

}  // namespace extremal
