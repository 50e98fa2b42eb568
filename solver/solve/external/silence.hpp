#pragma once

#include <glog/logging.h>

/// \file Ceres without its log.

namespace extremal {

/// While it lives nothing of Ceres' log reaches stderr.
class Silence {
 public:
  Silence() { FLAGS_minloglevel = google::FATAL; }
  ~Silence() { FLAGS_minloglevel = before_; }

 private:
  int before_ = FLAGS_minloglevel;
};

}  // namespace extremal
