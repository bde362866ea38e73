// SPDX-License-Identifier: Apache-2.0
#pragma once

// Which checks fail by themselves, and which along with another. Private to hil/report and its tests.

#include <string>
#include <string_view>
#include <vector>

#include "hil/inspect/inspect.h"

namespace kerfbench::report {

/// What is known of a check besides a run: what it says when it fails, and what makes it fail as well.
struct CheckFacts {
  std::string_view name;
  std::string_view failing;               ///< "The cut lies off the dieline": no full stop.
  std::vector<std::string_view> follows;  ///< Checks whose failure brings this one along; nearest first.
};

/// All checks of a run, in the order in which a fault works: controller and pins, beam, cut.
const std::vector<CheckFacts>& checkFacts();

/// What a check says when it fails; its name for one that is not known.
std::string failingPhrase(std::string_view name);

/// A check that did not pass for a reason of its own, with those that it brings along.
struct FailureGroup {
  const inspect::Check* primary{};
  std::vector<const inspect::Check*> followers;  ///< In the order of checkFacts().
};

/// Checks with this verdict in groups: each follows the first of `CheckFacts::follows` that has it too, and
/// so on up to one that follows none. The group with the most followers comes first, else the order of
/// checkFacts(). That a fault of one kind brings another along is how the machine works, and not measured in
/// this run. The pointers are into `checks`.
std::vector<FailureGroup> failureGroups(const std::vector<inspect::Check>& checks, inspect::Verdict verdict);

}  // namespace kerfbench::report
