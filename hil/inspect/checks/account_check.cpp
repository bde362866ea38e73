// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "hil/inspect/checks/checks.h"

namespace kerfbench::inspect::checks {

namespace {

Check accountHead() {
  return {.name = "account", .title = "The controller is where it says", .unit = "steps"};
}

}  // namespace

Finding accountFinding(const Evidence& evidence) {
  if (evidence.account) return accountCheck(*evidence.account);
  return absentReport(evidence, accountHead());
}

Check accountCheck(const ControllerAccount& account) {
  Check check = accountHead();
  check.limit = 0.0;
  if (!account.told) {
    check.value = std::numeric_limits<double>::quiet_NaN();
    decide(check);
    check.explanation = "The controller did not say where its axes are at the end.";
    return check;
  }
  long long worst = 0;
  check.explanation = fmt::format("The pulses on {} axes add up to what the controller tells of itself{}.",
                                  account.axes.size(), account.belt ? ", the belt's edges too" : "");
  for (const ControllerAccount::Axis& axis : account.axes) {
    const long long off = std::llabs(axis.told - axis.seen);
    if (off <= worst) continue;
    worst = off;
    check.subject = axis.name;
    check.explanation = fmt::format("The controller says that {} is at {} steps; its pulses add up to {}.",
                                    axis.name, axis.told, axis.seen);
  }
  if (account.belt) {
    const auto& belt = *account.belt;
    const long long low = belt.seen_min - kBeltAccountCounts;
    const long long high = belt.seen_max + kBeltAccountCounts;
    const long long off = std::max({low - belt.told, belt.told - high, 0LL});
    if (off > worst) {
      worst = off;
      check.subject = "belt";
      check.unit = "counts";
      check.explanation = fmt::format(
          "The controller says that the belt has gone {} counts; by A and B it made {} to {} while those "
          "words were "
          "under way, of which it may be off by {}: {} are too many or too few.",
          belt.told, belt.seen_min, belt.seen_max, kBeltAccountCounts, off);
    }
  }
  check.value = static_cast<double>(worst);
  decide(check);
  return check;
}

}  // namespace kerfbench::inspect::checks
