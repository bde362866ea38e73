// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::inspect {

/// What the controller said of its state.
struct ControllerState {
  double time_s{};
  bool stopped{};
  std::string fault;  ///< Name; "ok": none.
};

}  // namespace kerfbench::inspect
