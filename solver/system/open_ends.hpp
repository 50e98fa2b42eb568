#pragma once

/// \file Lagrangians that are not finite at an end of the time.

namespace extremal {

/// A base of such Lagrangians: quadrature leaves the ends of elements out, and there is no momentum there.
class OpenEnds {
 public:
  virtual ~OpenEnds() = default;
  bool open_start() const { return start_; }
  bool open_end() const { return end_; }

 protected:
  OpenEnds(bool start, bool end) : start_(start), end_(end) {}

 private:
  bool start_, end_;
};

}  // namespace extremal
