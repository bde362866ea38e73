// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/digest.h"
#include "hil/base/text.h"
#include "hil/base/version.h"
#include "hil/fold/fold_report.h"
#include "hil/inspect/verdict/verdict.h"

namespace kerfbench::fold {
namespace {

using nlohmann::ordered_json;

/// A tenth of a nanometre, so that no rounding of the last bit shows; null for what is no number.
ordered_json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::round(1e7 * value) / 1e7;
}

ordered_json vectorJson(const Eigen::Vector3d& v) { return {number(v.x()), number(v.y()), number(v.z())}; }

ordered_json checkJson(const inspect::Check& check) {
  return {{"name", check.name},
          {"title", check.title},
          {"subject", check.subject},
          {"unit", check.unit},
          {"value", number(check.value)},
          {"U", number(check.u)},
          {"limit", number(check.limit)},
          {"guard", number(check.guard)},
          {"verdict", inspect::verdictName(check.verdict)},
          {"explanation", check.explanation}};
}

ordered_json faceJson(const inspect::SpaceFace& face, const inspect::FaceEvidence& evidence) {
  ordered_json json{{"name", face.name}};
  if (!evidence.pose) return json;
  const vision::FacePose& pose = *evidence.pose;
  const double turn_rad = Eigen::AngleAxisd(pose.X_WF.linear() * face.X_WF.linear().transpose()).angle();
  json["marks_seen"] = pose.marks;
  json["rms_px"] = number(pose.rms_px);
  json["origin_W_mm"] = vectorJson(pose.X_WF.translation());
  json["x_W"] = vectorJson(pose.X_WF.linear().col(0));
  json["normal_W"] = vectorJson(pose.X_WF.linear().col(2));
  json["turned_from_drawing_deg"] = number(turn_rad * 180.0 / std::numbers::pi);
  return json;
}

const char* zoneName(inspect::EdgeZone zone) {
  if (zone == inspect::EdgeZone::kAlong) return "along";
  return zone == inspect::EdgeZone::kJoint ? "joint" : "end";
}

ordered_json readingJson(const inspect::EdgeReading& reading) {
  return {{"line", reading.line + 1},
          {"way_mm", number(reading.way_mm)},
          {"zone", zoneName(reading.zone)},
          {"open", reading.open},
          {"beside_mm", number(reading.beside_mm)},
          {"above_mm", number(reading.above_mm)},
          {"edge_W_mm", reading.found ? vectorJson(reading.edge_W_mm) : ordered_json(nullptr)}};
}

ordered_json worstJson(const inspect::WorstDistance& worst) {
  constexpr std::array kSources{"survey", "kerf_pose", "kerf_width", "kerf_scale", "flanks"};
  ordered_json sources;
  for (std::size_t i = 0; i < kSources.size(); ++i) sources[kSources[i]] = number(worst.source_u_mm.at(i));
  return {{"value_mm", number(worst.value.value)},
          {"U_mm", number(worst.value.U)},
          {"as_read_mm", number(worst.as_read_mm)},
          {"readings", worst.readings},
          {"noise_u_mm", number(worst.noise_u_mm)},
          {"shared_u_mm", number(worst.shared_u_mm)},
          {"source_u_mm", sources}};
}

}  // namespace

std::string foldSentence(const FoldReport& report) {
  const inspect::SpaceResult& result = report.judgement.result;
  const std::string verdict(inspect::verdictName(result.verdict));
  if (!result.problems.empty()) return fmt::format("{}: {}.", verdict, result.problems.front());
  const inspect::Check* shown = nullptr;
  for (const inspect::Check& check : result.checks) {
    if (check.verdict == result.verdict && shown == nullptr) shown = &check;
  }
  if (shown == nullptr) return verdict + ".";
  const std::string where = shown->subject.empty() ? "" : fmt::format(" ({})", shown->subject);
  return fmt::format("{}: {}: {:.4f} mm, U {:.4f}, limit {:g}{}.", verdict, shown->title, shown->value,
                     shown->u, shown->limit, where);
}

std::string foldJson(const FoldReport& report) {
  const inspect::SpaceResult& result = report.judgement.result;
  ordered_json measured{{"verdict", inspect::verdictName(result.verdict)}};
  measured["problems"] = result.problems;
  for (const inspect::Check& check : result.checks) measured["checks"].push_back(checkJson(check));
  measured["worst"] = worstJson(result.worst);
  const inspect::SpaceJob& job = report.scenario.job;
  for (std::size_t i = 0; i < job.faces.size(); ++i)
    measured["faces"].push_back(faceJson(job.faces[i], report.judgement.faces[i]));
  measured["readings"] = ordered_json::array();
  for (const inspect::EdgeReading& reading : result.readings)
    measured["readings"].push_back(readingJson(reading));

  ordered_json json{
      {"format", "kerfbench-fold"},
      {"version", 1},
      {"kerfbench", base::version()},
      {"scenario", report.scenario.name},
      {"machine", report.scenario.machine.name},
      {"seed", report.scenario.seed},
      {"command", report.command_line},
      {"program_sha256", base::sha256(report.scenario.program)},
      {"digest", base::sha256(measured.dump(-1, ' ', false, decltype(measured)::error_handler_t::replace))}};
  json["missed_mm"] = number(report.missed_mm);
  json.update(measured);
  return json.dump(1, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

std::string foldJunit(const FoldReport& report) {
  const inspect::SpaceResult& result = report.judgement.result;
  std::string cases;
  int failures = 0;
  int errors = 0;
  const auto add = [&](const std::string& name, inspect::Verdict verdict, const std::string& message) {
    cases +=
        fmt::format(R"(  <testcase classname="{}" name="{}")", base::escapeHtml(report.scenario.name), name);
    if (verdict == inspect::Verdict::kPass) {
      cases += "/>\n";
      return;
    }
    const bool error = verdict == inspect::Verdict::kInvalid;
    ++(error ? errors : failures);
    const char* const tag = error ? "error" : "failure";
    cases += fmt::format("><{0} type=\"{1}\" message=\"{2}\"/></testcase>\n", tag,
                         inspect::verdictName(verdict), base::escapeHtml(message));
  };
  for (const inspect::Check& check : result.checks)
    add(check.name, check.verdict, check.title + ". " + check.explanation);
  std::string problems;
  for (const std::string& problem : result.problems) problems += problem + ". ";
  add("evidence", problems.empty() ? inspect::Verdict::kPass : inspect::Verdict::kInvalid, problems);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" "
      "errors=\"{}\">\n{}</testsuite>\n",
      base::escapeHtml(report.scenario.name), result.checks.size() + 1, failures, errors, cases);
}

}  // namespace kerfbench::fold
