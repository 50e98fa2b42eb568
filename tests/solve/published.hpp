#pragma once

#include <Eigen/Dense>

#include "solve/scenes.hpp"

/// \file Published periodic orbits as scenes that begin at their initial states.

namespace extremal::laws {

/// All cases of a file of tests/data/reference.
nlohmann::json cases_of(const char* name);

/// The refined state in the order of the scene: coordinates, of bodies all x and then all y, then velocities.
Eigen::VectorXd state_of(const nlohmann::json& c);

/// Of a periodic orbit from its state, its period given.
std::string scene_of(const nlohmann::json& c, double tolerance);
Study study_of(const nlohmann::json& c, double tolerance);
Solution solved(const nlohmann::json& c, double tolerance);

/// Of the refined state from the orbit, in phase space and but for what symmetries leave open.
double distance(const nlohmann::json& c, const Solution& solution);

}  // namespace extremal::laws
