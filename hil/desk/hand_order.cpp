// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/hand_order.h"

#include <set>
#include <utility>

#include <fmt/format.h>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/order/hand_order.h"
#include "firmware_under_test/planner/program/plan.h"
#include "hil/desk/desk_issue.h"
#include "hil/desk/job_case.h"
#include "hil/desk/json_text.h"
#include "hil/desk/scenario_edit.h"

namespace kerfbench::desk {
namespace {

using nlohmann::json;

const std::vector<std::string> kOrderPath{"planner", "order"};

/// Numbers as numbers, ranges as texts.
nlohmann::ordered_json valueOfOrder(const std::vector<int>& order) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const std::string& words : orderWords(order)) {
    if (words.find('-') == std::string::npos) {
      list.push_back(std::stoi(words));
    } else {
      list.push_back(words);
    }
  }
  return list;
}

std::vector<int> asCut(const std::string& gcode) {
  std::vector<int> order;
  std::set<int> seen;
  for (const planner::Segment& segment : planner::readGcode(gcode))
    if (segment.entity >= 0 && !segment.jump && seen.insert(segment.entity).second)
      order.push_back(segment.entity);
  return order;
}

/// The order that the planner makes of the case, and what is doubtful in it.
struct Ordered {
  std::vector<int> order;
  std::vector<DeskIssue> issues;
};

Ordered orderedBy(const scenario::Case& test_case, const ScenarioText& scenario) {
  Ordered result;
  const TextPlace place = placeOfKey(scenario.text, "planner.order");
  const auto note = [&](const std::string& message, bool is_error) {
    result.issues.push_back({.line = place.line,
                             .column = place.column,
                             .is_error = is_error,
                             .key = "planner.order",
                             .message = message});
  };
  try {
    result.order =
        asCut(planner::makeGcode(*test_case.dieline, scenario::targetedMachine(test_case),
                                 scenario::plannerJob(test_case), test_case.scenario.planner_faults));
    for (const std::string& doubt : planner::orderDoubts(*test_case.dieline, result.order))
      note(doubt, false);
  } catch (const planner::PlanError& error) {
    note(error.what(), true);
  }
  return result;
}

}  // namespace

std::vector<std::string> orderWords(const std::vector<int>& order) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from < order.size();) {
    std::size_t to = from + 1;
    while (to < order.size() && order[to] == order[to - 1] + 1) ++to;
    const std::size_t count = to - from;
    if (count > 2) {
      words.push_back(fmt::format("{}-{}", order[from], order[to - 1]));
    } else {
      for (std::size_t i = from; i < to; ++i) words.push_back(fmt::format("{}", order[i]));
    }
    from = to;
  }
  return words;
}

std::string orderJson(const ScenarioText& scenario, const std::vector<int>& order,
                      const DeskRequest& request) {
  nlohmann::ordered_json value;
  if (!order.empty()) value = valueOfOrder(order);
  const ScenarioText changed{edited(scenario.text, {{kOrderPath, std::move(value)}}), scenario.file};
  JobCase found = jobCaseOf(changed, false, request);
  Ordered ordered;
  if (found.test_case) ordered = orderedBy(*found.test_case, changed);
  for (DeskIssue& issue : ordered.issues) found.issues.push_back(std::move(issue));
  return jsonText(
      {{"text", changed.text}, {"order", ordered.order}, {"issues", jsonOf(found.issues, request)}});
}

}  // namespace kerfbench::desk
