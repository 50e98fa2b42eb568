#pragma once

#include <memory>
#include <new>
#include <string>

#include "system/lagrangian.hpp"

/// \file Memory: what a solve needs and what there is.

namespace extremal {

/// Bytes that `elements` elements take at the least: eight side by side keep a matrix of their (degree + 1) n
/// unknowns each, and every node between them its blocks of the chain and their factors.
double solve_bytes(const Structure& structure, int elements, int degree);

/// Bytes of a march over so many: q and q' at the nodes of its trajectory, and the motion that it is compared
/// with.
double march_bytes(int coordinates, int elements, int degree);

/// Bytes that this process may use: physical memory, or less where its own limit or that of its control
/// group is lower.
double available_bytes();

/// There is not enough memory; with a message that says for what.
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(const std::string& message) : message_(std::make_shared<const std::string>(message)) {}
  const char* what() const noexcept override { return message_->c_str(); }

 private:
  std::shared_ptr<const std::string> message_;  ///< copies must not throw
};

/// Three digits with a unit: "3.25 GB".
std::string byte_text(double bytes);

}  // namespace extremal
