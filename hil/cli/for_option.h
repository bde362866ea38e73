// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <system_error>

#include "hil/base/input_error.h"

namespace kerfbench::cli {

/// Writes what an option asks for. The system's refusal is then a fault of the option's word, by its name,
/// and no breakdown of the bench. @throws base::InputError.
template <typename Write>
auto forOption(std::string_view option, const Write& write) {
  try {
    return write();
  } catch (const std::system_error& error) {
    throw base::InputError(fmt::format("{}: {}", option, error.what()));
  }
}

}  // namespace kerfbench::cli
