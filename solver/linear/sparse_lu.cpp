#include "linear/sparse_lu.hpp"

template class Eigen::SparseLU<Eigen::SparseMatrix<double>>;
