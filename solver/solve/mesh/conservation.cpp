#include "solve/mesh/conservation.hpp"

#include <algorithm>

#include "machine/largest.hpp"
#include "solve/mesh/limits.hpp"
#include "solve/mesh/roundoff.hpp"

namespace extremal {

using namespace limits::conservation;

namespace {

double shortest_element(const Trajectory& trajectory) {
  double shortest = trajectory.duration();
  for (int k = 0; k < trajectory.elements(); ++k)
    shortest = std::min(shortest, trajectory.times[k + 1] - trajectory.times[k]);
  return shortest;
}

/// Factor of errors of q in the slopes at the ends of the shortest element.
double amplification(const Trajectory& trajectory) {
  return trajectory.degree * (trajectory.degree + 1) / shortest_element(trajectory);
}

double noise(const Survey& survey, const Trajectory& trajectory) {
  return roundoff_of_terms * survey.terms +
         roundoff_of_q * largest(trajectory.nodes) * amplification(trajectory) * survey.momentum;
}

/// Whether the energy drifts by no more than that.
bool drifts_within(double explained, const Survey& survey, const Trajectory& trajectory) {
  return survey.energy_drift <= margin * (explained + noise(survey, trajectory));
}

}  // namespace

bool conserves_energy(const Survey& survey, const Trajectory& trajectory, double tolerance) {
  const double explained =
      tolerance * (momentum_tolerances * survey.speed * largest(survey.p) + survey.force * largest(survey.q));
  return drifts_within(explained, survey, trajectory);
}

bool conserves_energy(const Survey& survey, const Trajectory& trajectory, const Resolution::Error& left_out) {
  const double explained = survey.momentum * left_out.v + survey.force * left_out.q;
  return drifts_within(explained, survey, trajectory);
}

double error_behind_drift(const Survey& survey, const Trajectory& trajectory, double estimate) {
  const double explained = estimate * (survey.momentum * amplification(trajectory) + survey.force);
  if (drifts_within(explained, survey, trajectory)) return estimate;
  return std::max(estimate,
                  survey.energy_drift / (survey.momentum / shortest_element(trajectory) + survey.force));
}

}  // namespace extremal
