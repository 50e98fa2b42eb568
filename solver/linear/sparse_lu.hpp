#pragma once

#include <Eigen/SparseLU>

/// \file Eigen's sparse LU, instantiated once: see dense.hpp.

extern template class Eigen::SparseLU<Eigen::SparseMatrix<double>>;
