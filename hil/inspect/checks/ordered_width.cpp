// SPDX-License-Identifier: Apache-2.0
// Whether cuts are as wide as ordered.
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "hil/dieline/geometry.h"
#include "hil/inspect/checks/checks.h"
#include "hil/inspect/evidence/extreme.h"
#include "hil/inspect/evidence/whereabouts.h"
#include "twin/base/constants.h"

namespace kerfbench::inspect::checks {

Finding orderedWidthCheck(const Evidence& evidence, const Tolerances& limits,
                          const std::vector<EntityResult>& entities) {
  Check check{.name = "ordered_width", .title = "Cuts are as wide as ordered", .unit = "mm"};
  const Tolerances::OrderedWidth& order = limits.ordered_width;
  if (!(order.nominal_mm > 0.0))
    return notApplicable(check, "The scenario orders no width (checks.ordered_width).");
  check.limit = order.limit_mm;
  std::size_t cuts = 0;
  std::size_t measured = 0;
  for (const EntityResult& e : entities) {
    if (entityOf(evidence, e.entity).process != dieline::Process::kCut) continue;
    ++cuts;
    if (std::isfinite(e.width_mm)) ++measured;
  }
  if (cuts == 0) return notApplicable(check, "The dieline has no cut.");
  if (measured == 0) return notJudged(check, "No width of a cut could be measured; see coverage.");
  ExtremeEstimate extreme(measured);
  const EntityResult* worst = nullptr;
  for (const EntityResult& e : entities) {
    if (!std::isfinite(e.width_mm) || entityOf(evidence, e.entity).process != dieline::Process::kCut)
      continue;
    extreme.add(e.width_mm - order.nominal_mm, 0.5 * e.width_U_mm);
    if (worst == nullptr ||
        std::abs(e.width_mm - order.nominal_mm) > std::abs(worst->width_mm - order.nominal_mm))
      worst = &e;
  }
  check.value = extreme.value();
  check.u = check.guard = extreme.expandedU();
  decide(check);
  check.subject = nameOf(worst->unit, worst->entity);
  check.where = onLine(worst->unit, worst->entity);
  check.explanation =
      fmt::format("{} is {:.3f} ± {:.3f} mm wide, ordered are {:g} mm; {} of {} cuts were measured.",
                  check.subject, worst->width_mm, worst->width_U_mm, order.nominal_mm, measured, cuts);
  return check;
}

}  // namespace kerfbench::inspect::checks
