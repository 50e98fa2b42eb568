#pragma once

#include <functional>

#include "verdict.hpp"

/// \file Whether a result is what it says.

namespace bench {

/// Reads and solves verdict.scene.text by way of the file `scratch`, as the command line would, and looks for
/// whatever is wrong with the result. `solved` is called in between, with status and seconds set.
void judge(Verdict& verdict, const std::string& scratch, const std::function<void()>& solved);

}  // namespace bench
