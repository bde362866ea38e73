// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::inspect {

/// Where the controller says that its axes and its belt are at the end of a run, beside what its pins say.
struct ControllerAccount {
  struct Axis {
    std::string name;  ///< "galvo_x", …
    long long told{};  ///< Steps.
    long long seen{};  ///< Rising edges of PUL, each with the sense of DIR.
  };
  struct Belt {
    long long told{};  ///< Counts between its first and its last word.
    long long seen_min{},
        seen_max{};  ///< Least and most counts of A and B, between the times at which it can have looked.
  };
  bool told{};  ///< False: it was asked, or should have spoken, and did not.
  std::vector<Axis> axes;
  std::optional<Belt> belt;  ///< None: no encoder is wired.
};

/// Counts by which belt and pins may differ besides: at both ends a controller that counts edges of A alone
/// does not know the part between two of them.
inline constexpr long long kBeltAccountCounts = 4;

namespace checks {
/// "account": pulses exactly as told, the belt within kBeltAccountCounts; INVALID without an account.
Check accountCheck(const ControllerAccount& account);
}  // namespace checks

}  // namespace kerfbench::inspect
