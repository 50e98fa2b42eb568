#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// \file Arrays as NumPy keeps them: one in a file .npy, several with names in a file .npz.

namespace extremal {

/// The last index runs fastest.
struct NumpyArray {
  std::vector<std::size_t> shape;
  std::vector<double> values;  ///< as many as the product of the shape
};

/// Real numbers and integers of 4 or 8 bytes. Throws std::runtime_error with the reason.
NumpyArray read_npy(std::string_view bytes);

/// Arrays by name, together at most `most` bytes. Throws std::runtime_error with the reason.
std::map<std::string, NumpyArray> read_npz(std::string_view bytes, std::size_t most);

/// The bytes of a file .npz with these one-dimensional arrays.
std::string npz(const std::vector<std::pair<std::string, std::span<const double>>>& arrays);

}  // namespace extremal
