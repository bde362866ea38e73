// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::gauge {

/// One verdict quantity of one case: as measured, with U (k = 2), and as it truly is; mm.
struct Reading {
  std::string quantity;  ///< "worst of all lines", …
  double value{};
  double U{};
  double truth{};
};

}  // namespace kerfbench::gauge
