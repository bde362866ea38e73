// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/preview/preview.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "firmware_under_test/planner/program/program.h"
#include "hil/base/text.h"
#include "page_files.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using nlohmann::json;

/// Number of periods above which they are thinned: 160 s at 0.8 ms keep the page below 4 MB.
constexpr std::size_t kMostSamples = 200'000;

/// JSON inside <script>: no "<" that could end it or begin a comment. Bytes that are not UTF-8 become U+FFFD.
std::string scriptSafe(const json& value) {
  std::string out;
  for (const char c : value.dump(-1, ' ', false, json::error_handler_t::replace)) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, to - from));
    if (!lines.back().empty() && lines.back().back() == '\r') lines.back().pop_back();
    from = to + 1;
  }
  return lines;
}

/// One unit period by period, waits included.
struct Film {
  std::vector<Sample> samples;  ///< Samples; the first is the start.
  double period_s{};
};

Film filmOf(const UnitPath& unit, const std::vector<int>& waits) {
  Film film;
  film.period_s = unit.period_s;
  film.samples.push_back({unit.start_S_mm, 0.0, 0});
  for (std::size_t i = 0; i < unit.blocks.size(); ++i) {
    const Block& block = unit.blocks[i];
    const int wait = i < waits.size() ? waits[i] : 0;
    const Sample resting{film.samples.back().p_S_mm, 0.0, block.samples.front().line};
    film.samples.insert(film.samples.end(), std::size_t(wait), resting);
    film.samples.insert(film.samples.end(), block.samples.begin(), block.samples.end());
  }
  const std::size_t stride = film.samples.size() / kMostSamples + 1;
  if (stride == 1) return film;
  Film thin;
  thin.period_s = film.period_s * static_cast<double>(stride);
  for (std::size_t i = 0; i + 1 < film.samples.size(); i += stride) thin.samples.push_back(film.samples[i]);
  thin.samples.push_back(film.samples.back());
  return thin;
}

/// Differences in units of the G-code's last decimal.
json differences(const Film& film, int axis) {
  json list = json::array();
  long before = 0;
  for (const Sample& sample : film.samples) {
    const long now = std::lround(sample.p_S_mm[axis] * 1e4);
    list.push_back(now - before);
    before = now;
  }
  return list;
}

double fullPower(const MachineParameters& machine, const JobParameters& job) {
  return job.power ? job.power->laser().most_w : machine.full_power_w;
}

json powersOf(const Film& film, const MachineParameters& machine, const JobParameters& job) {
  json list = json::array();
  for (const Sample& sample : film.samples) {
    long share = 0;  // Share of full power, in 255ths.
    if (sample.marked_mm > 0.0) {
      const double byte = std::min(powerByte(sample, machine, job), 255.0);
      share = std::lround(job.power ? 255.0 * job.power->powerOf(static_cast<std::uint8_t>(byte)) /
                                          fullPower(machine, job)
                                    : byte);
      share = std::max(1L, share);
    }
    list.push_back(share);
  }
  return list;
}

/// Runs as [line, number of periods]…
json runsOf(const Film& film) {
  json list = json::array();
  for (std::size_t i = 1; i < film.samples.size();) {
    std::size_t end = i;
    while (end < film.samples.size() && film.samples[end].line == film.samples[i].line) ++end;
    list.push_back({film.samples[i].line, end - i});
    i = end;
  }
  return list;
}

json segmentsOf(const std::vector<Segment>& path) {
  const auto rounded = [](double value) { return std::round(value * 1e4) / 1e4; };
  json list = json::array();
  for (const Segment& s : path) {
    list.push_back({s.line, s.jump || s.z == 0.0 ? 1 : 0, s.z, rounded(s.start_mm.x()),
                    rounded(s.start_mm.y()), rounded(s.end_mm.x()), rounded(s.end_mm.y()),
                    rounded(s.centre_mm.x()), rounded(s.centre_mm.y()), s.sweep_rad});
  }
  return list;
}

void replace(std::string& page, std::string_view what, const std::string& by) {
  const std::size_t at = page.find(what);
  if (at != std::string::npos) page.replace(at, what.size(), by);
}

/// Motion of a job that does not fit: at the belt's speed, or on a resting sheet where the axes are too slow.
std::optional<UnitPath> nearestMotion(const std::vector<Segment>& path, const JobParameters& job,
                                      const Axes& axes) {
  std::optional<UnitPath> unit = planUnit(path, job, axes, speedWhileCutting(job));
  return unit ? unit : planUnit(path, job, axes, 0.0);
}

std::string listOf(const CheckResult& checked) {
  std::string items;
  for (const std::string& error : checked.errors) items += "<li>" + base::escapeHtml(error) + "</li>";
  for (const std::string& warning : checked.warnings)
    items += "<li class=warn>" + base::escapeHtml(warning) + "</li>";
  return items.empty() ? std::string() : "<ul class=wrong aria-label='What is wrong'>" + items + "</ul>";
}

std::string factsOf(const JobParameters& job, double duration_s, double shown_speed_mm_s) {
  std::string facts = fmt::format("one unit: {:.3f} s · ", duration_s);
  if (job.belt_speed_mm_s > 0.0) {
    facts +=
        fmt::format("belt {:g} mm/s{}", job.belt_speed_mm_s, job.stop_and_go ? ", stops for the cut" : "");
  } else {
    facts += "resting sheet";
  }
  if (shown_speed_mm_s < job.belt_speed_mm_s && !job.stop_and_go) facts += " (shown as on a resting sheet)";
  return facts +
         fmt::format(" · marks to {:g} mm/s, jumps to {:g} mm/s", job.mark_speed_mm_s, job.jump_speed_mm_s);
}

}  // namespace

std::string previewHtml(const std::string& title, const std::string& gcode, const MachineParameters& machine,
                        const JobParameters& job) {
  const std::vector<Segment> path = unitOf(readGcode(gcode));
  if (const auto faults = jobIssues(machine, job); !faults.empty()) {
    throw PlanError(fmt::format("{}", fmt::join(faults, "\n")));
  }
  const CheckResult checked = checkJob(gcode, machine, job);
  const Axes axes(machine, {});
  const std::optional<UnitPath> unit =
      checked.solution ? checked.solution->pathOf(0) : nearestMotion(path, job, axes);
  if (!unit) throw PlanError("the axes allow no motion at all");
  const double v = unit->belt_speed_mm_s;
  const Film film =
      filmOf(*unit, checked.solution ? checked.solution->layoutOf(0).waits : std::vector<int>());

  json data{{"period_s", film.period_s},
            {"full_power_w", fullPower(machine, job)},
            {"belt_mm_s", v},
            {"x", differences(film, 0)},
            {"y", differences(film, 1)},
            {"power", powersOf(film, machine, job)},
            {"runs", runsOf(film)},
            {"segments", segmentsOf(path)},
            {"lines", linesOf(gcode)},
            {"field", nullptr}};
  if (checked.solution) {
    const UnitLayout& layout = checked.solution->layoutOf(0);
    const double before_s =
        layout.catch_up_periods * axes.periodS() + (v > 0.0 ? machine.tracking_delay_s : 0.0);
    data["field"] = {{"beta_mm", layout.x_ref_mm + v * before_s},
                     {"min", machine.field_min_mm},
                     {"max", machine.field_max_mm}};
  }
  const bool fits = checked.errors.empty();
  const double duration_s = static_cast<double>(film.samples.size() - 1) * film.period_s;
  std::string body(kPageHtml);
  replace(body, "%VERDICT_CLASS%", fits ? "pass" : "fail");
  replace(body, "%VERDICT%", fits ? "fits" : "does not fit");
  replace(body, "%WRONG%", listOf(checked));
  replace(body, "%FACTS%", base::escapeHtml(factsOf(job, duration_s, v)));
  replace(
      body, "%FIELD_KEY%",
      checked.solution ? "<span class=key><i class=fieldbox></i>reach of the beam on the sheet</span>" : "");
  replace(body, "%NOTE%",
          film.period_s > axes.periodS()
              ? fmt::format("Every {:.0f}th period is drawn.", film.period_s / axes.periodS())
              : std::string());
  replace(body, "%TITLE%", base::escapeHtml(title));
  std::string page =
      "<!DOCTYPE html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
      "content='width=device-width'>"
      "<meta name=color-scheme content='light dark'><title>" +
      base::escapeHtml(title) + " – preview</title><style>";
  page += kPageCss;
  page += "</style></head><body>\n" + body + "<script id=job type='application/json'>" + scriptSafe(data) +
          "</script>\n<script id=player>";
  page += kPageJs;
  return page + "</script></body></html>\n";
}

}  // namespace kerfbench::planner
