// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/doctor/loopback.h"

namespace kerfbench::doctor {
namespace {

using Json = nlohmann::ordered_json;

double microseconds(double time_ns) { return 1e-3 * time_ns; }
double microseconds(std::uint64_t time_ns) { return microseconds(static_cast<double>(time_ns)); }

std::string lineText(const std::filesystem::path& chip, const source::ChipLine& line) {
  return fmt::format("{} line {} ({})", chip.string(), line.offset, line.name);
}

std::string headText(const BenchReport& report) {
  const source::LoopBackLines& lines = report.lines;
  std::string text = fmt::format("{}, clock {}\n{} drives {}; {} is read besides\n", report.kernel,
                                 report.clock_source.empty() ? "not named" : report.clock_source,
                                 lineText(lines.out_chip, lines.out), lineText(lines.in_chip, lines.in),
                                 lineText(lines.in_chip, lines.beside));
  if (!report.virtual_machine.empty()) {
    text += fmt::format("MEASURED IN A VIRTUAL MACHINE ({}): no machine's figures\n", report.virtual_machine);
  }
  for (const std::string& note : report.real_time_notes) text += fmt::format("note: {}\n", note);
  return text;
}

std::string rateTable(const BenchReport& report) {
  std::string text =
      "\nHow many are read: by one thread, as in a run; its share is of one processor, without the kernel's "
      "threads\n"
      "| edges/s asked for | driven, edges/s | edges | read | worst from stamp to read, us | worst from plan "
      "to "
      "line, us | reader's share, % |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const source::LoopBackStep& step : report.steps) {
    // An output that falls behind all the time has no worst.
    const std::string late =
        step.wasDriven() ? fmt::format("{:.1f}", microseconds(static_cast<double>(step.worst_put_ns))) : "-";
    text +=
        fmt::format("| {:.0f} | {:.0f} | {} | {} | {:.1f} | {} | {:.1f} |\n", step.asked_hz, step.driven_hz,
                    step.driven, step.read, microseconds(step.worst_read_ns), late, 100.0 * step.cpu_share);
  }
  return text;
}

std::string between(double least_ns, double most_ns) {
  return fmt::format("{:.1f} to {:.1f}", microseconds(least_ns), microseconds(most_ns));
}

std::string stampTable(const BenchReport& report) {
  std::string text =
      "\nHow late a stamp is, us: bounds, since the line changed somewhere within the call that drove it\n"
      "| edges/s | edges | worst | 95 % are within | root mean square |\n|---|---|---|---|---|\n";
  for (const source::LoopBackStep& step : report.steps) {
    if (!step.held()) continue;
    const source::TimeSpread& least = step.stamp_least;
    const source::TimeSpread& most = step.stamp_most;
    text += fmt::format("| {:.0f} | {} | {} | {} | {} |\n", step.driven_hz, step.read,
                        between(static_cast<double>(least.worst_ns), static_cast<double>(most.worst_ns)),
                        between(static_cast<double>(least.share95_ns), static_cast<double>(most.share95_ns)),
                        between(least.rms_ns, most.rms_ns));
  }
  return text;
}

std::string verdictText(const BenchReport& report) {
  std::string text = "\n";
  const source::LoopBackStep* const best = sustained(report);
  if (best != nullptr) text += fmt::format("{:.0f} edges/s without loss", best->driven_hz);
  if (best == nullptr) text += "no rate was held";
  const source::LoopBackStep& last = report.steps.back();
  if (!last.held()) {
    text += fmt::format("; at {:.0f} edges/s:\n", last.driven_hz);
    for (const std::string& problem : last.problems) text += fmt::format("  {}\n", problem);
  } else {
    text += last.wasDriven() ? "; nothing faster was tried\n"
                             : fmt::format("; the output cannot be driven at {:.0f}\n", last.asked_hz);
  }
  std::uint64_t beside = 0;
  for (const source::LoopBackStep& step : report.steps) beside += step.beside;
  if (beside > 0) {
    text += fmt::format("{} had {} edges of its own: name one by --beside that does not float\n",
                        lineText(report.lines.in_chip, report.lines.beside), beside);
  }
  return text;
}

std::string stampText(const BenchReport& report) {
  const std::optional<StampBound> bound = stampBound(report);
  if (!bound) return "";
  return fmt::format(
      "\nstamp_err_us: {}   # Upper bound of the worst of {} edges, rounded up. Of edges like these, at 95 % "
      "confidence, fewer than\n"
      "                    # {:.2g} % are stamped later. Couplers and shifters of the wiring come on top.\n",
      bound->stamp_err_us, bound->edges, 100.0 * 3.0 / static_cast<double>(bound->edges));
}

Json spreadJson(const source::TimeSpread& spread) {
  return {{"worst_us", microseconds(spread.worst_ns)},
          {"share95_us", microseconds(spread.share95_ns)},
          {"rms_us", microseconds(spread.rms_ns)}};
}

Json stepJson(const source::LoopBackStep& step) {
  Json json{{"asked_hz", step.asked_hz},
            {"driven_hz", step.driven_hz},
            {"driven", step.driven},
            {"read", step.read},
            {"beside", step.beside},
            {"worst_stamp_to_read_us", microseconds(step.worst_read_ns)},
            {"worst_plan_to_line_us", microseconds(static_cast<double>(step.worst_put_ns))},
            {"reader_share", step.cpu_share},
            {"problems", step.problems}};
  if (step.held())
    json["stamp_late"] = {{"at_least", spreadJson(step.stamp_least)},
                          {"at_most", spreadJson(step.stamp_most)}};
  return json;
}

Json lineJson(const std::filesystem::path& chip, const source::ChipLine& line) {
  return {{"chip", chip.string()}, {"line", line.offset}};
}

}  // namespace

std::string benchText(const BenchReport& report) {
  return headText(report) + rateTable(report) + stampTable(report) + verdictText(report) + stampText(report);
}

std::string benchJson(const BenchReport& report) {
  Json json{{"kernel", report.kernel},
            {"clock", report.clock_source},
            {"virtual_machine", report.virtual_machine},
            {"out", lineJson(report.lines.out_chip, report.lines.out)},
            {"in", lineJson(report.lines.in_chip, report.lines.in)},
            {"beside", lineJson(report.lines.in_chip, report.lines.beside)},
            {"real_time", report.real_time_notes.empty()}};
  Json steps = Json::array();
  for (const source::LoopBackStep& step : report.steps) steps.push_back(stepJson(step));
  json["rates"] = std::move(steps);
  if (const source::LoopBackStep* const best = sustained(report)) json["sustained_hz"] = best->driven_hz;
  if (const auto bound = stampBound(report)) json["stamp_err_us"] = bound->stamp_err_us;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace kerfbench::doctor
