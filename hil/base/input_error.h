// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace kerfbench::base {

/// A file or a device named by the user that cannot be used: what() says why, in the user's words.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace kerfbench::base
