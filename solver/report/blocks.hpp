#pragma once

#include <algorithm>
#include <ostream>
#include <vector>

#include "machine/workers.hpp"

/// \file Long text made in blocks, in several threads.

namespace extremal {

/// Writes the text of items 0 … count − 1 in their order. fill(first, end, to) makes that of some, at most
/// `room` characters for each, and returns its end; it must not throw. As many blocks as there are threads
/// are made at once, in memory that is used again.
template <class Fill>
void write_blocks(std::ostream& out, std::size_t count, std::size_t room, const Fill& fill) {
  constexpr std::size_t characters = std::size_t{1} << 18;  // of a block: what a core's cache holds
  const std::size_t items = std::max<std::size_t>(1, characters / room);
  const std::size_t blocks = (count + items - 1) / items, at_once = threads();
  std::vector<std::vector<char>> texts(std::min(at_once, blocks), std::vector<char>(items * room));
  std::vector<std::size_t> sizes(texts.size());
  for (std::size_t done = 0; done < blocks; done += at_once) {
    const std::size_t now = std::min(at_once, blocks - done);
    share_out(static_cast<int>(now), [&](int, int piece) {
      const std::size_t first = (done + piece) * items;
      char* const text = texts[piece].data();
      sizes[piece] = fill(first, std::min(first + items, count), text) - text;
    });
    for (std::size_t k = 0; k < now; ++k) out.write(texts[k].data(), static_cast<std::streamsize>(sizes[k]));
  }
}

}  // namespace extremal
