// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/preview/preview.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "firmware_under_test/planner/gcode/gcode.h"
#include "firmware_under_test/planner/program/check.h"
#include "firmware_under_test/planner/program/job_issues.h"
#include "firmware_under_test/planner/program/program.h"
#include "firmware_under_test/planner/program/unit_motion.h"
#include "hil/base/text.h"
#include "page_files.h"

namespace kerfbench::planner {
namespace {

using Eigen::Vector2d;
using nlohmann::json;

/// Number of periods above which they are thinned: 160 s at 0.8 ms keep the page below 8 MB.
constexpr std::size_t kMostPeriods = 200'000;

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

/// End of a period of the film.
struct Picture {
  Vector2d p_S_mm{Vector2d::Zero()};
  double planned_mm{};  ///< Way over the sheet since the picture before, as planned.
  int power{};          ///< Share of full power, in 255ths; 0: dark.
  int line{};
};

/// One unit period by period, waits included.
struct Film {
  std::vector<Picture> pictures;  ///< The first is the start.
  double period_s{};
  std::size_t catch_up{};  ///< How many pictures, the start left out, bring the beam to the sheet's speed.
};

double fullPower(const MachineParameters& machine, const JobParameters& job) {
  return job.power ? job.power->laser().most_w : machine.full_power_w;
}

/// Share of full power of a PWM byte. A gate that is open shines, however little.
int shareOf(double byte, const MachineParameters& machine, const JobParameters& job) {
  byte = std::min(byte, 255.0);
  const double share =
      job.power ? 255.0 * job.power->powerOf(static_cast<std::uint8_t>(byte)) / fullPower(machine, job)
                : byte;
  return static_cast<int>(std::max(1L, std::lround(share)));
}

/// Leaves out periods of a film that is too long; ways add up, and the light of what is left out counts.
Film thinned(const Film& film) {
  const std::size_t stride = film.pictures.size() / kMostPeriods + 1;
  if (stride == 1) return film;
  Film thin{.pictures = {film.pictures.front()},
            .period_s = film.period_s * static_cast<double>(stride),
            .catch_up = film.catch_up / stride};
  double way_mm = 0.0;
  for (std::size_t i = 1; i < film.pictures.size(); ++i) {
    way_mm += film.pictures[i].planned_mm;
    if (i % stride != 0 && i + 1 != film.pictures.size()) continue;
    thin.pictures.push_back(film.pictures[i]);
    thin.pictures.back().planned_mm = std::exchange(way_mm, 0.0);
  }
  return thin;
}

/// What the program does.
Film filmOf(const UnitMotion& motion, const MachineParameters& machine, const JobParameters& job) {
  Film film{.period_s = motion.period_s, .catch_up = static_cast<std::size_t>(motion.catch_up)};
  const UnitPeriod* before = &motion.start;
  film.pictures.push_back({.p_S_mm = before->p_S_mm});
  for (const UnitPeriod& period : motion.periods) {
    film.pictures.push_back({.p_S_mm = period.p_S_mm,
                             .planned_mm = (period.planned_S_mm - before->planned_S_mm).norm(),
                             .power = period.power ? shareOf(*period.power, machine, job) : 0,
                             .line = period.line});
    before = &period;
  }
  return thinned(film);
}

/// What is planned, where there is no program.
Film filmOf(const UnitPath& unit, const MachineParameters& machine, const JobParameters& job) {
  Film film{.period_s = unit.period_s};
  film.pictures.push_back({.p_S_mm = unit.start_S_mm});
  for (const Block& block : unit.blocks) {
    for (const Sample& sample : block.samples) {
      const bool is_lit = sample.marked_mm > 0.0;
      film.pictures.push_back({.p_S_mm = sample.p_S_mm,
                               .planned_mm = (sample.p_S_mm - film.pictures.back().p_S_mm).norm(),
                               .power = is_lit ? shareOf(powerByte(sample, machine, job), machine, job) : 0,
                               .line = sample.line});
    }
  }
  return thinned(film);
}

/// Differences in units of 1e-9 mm, which add up without rounding.
json differences(const Film& film, int axis) {
  json list = json::array();
  long long before = 0;
  for (const Picture& picture : film.pictures) {
    const long long now = std::llround(picture.p_S_mm[axis] * 1e9);
    list.push_back(now - before);
    before = now;
  }
  return list;
}

template <typename Value>
json listOf(const Film& film, const Value& value) {
  json list = json::array();
  for (const Picture& picture : film.pictures) list.push_back(value(picture));
  return list;
}

/// Runs as [line, number of periods]…
json runsOf(const Film& film) {
  json list = json::array();
  for (std::size_t i = 1; i < film.pictures.size();) {
    std::size_t end = i;
    while (end < film.pictures.size() && film.pictures[end].line == film.pictures[i].line) ++end;
    list.push_back({film.pictures[i].line, end - i});
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

std::string faultList(const CheckResult& checked) {
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

/// The film, and what the page says of the sheet beside it.
struct Shown {
  Film film;
  double belt_mm_s{};
  json field{};  ///< Reach of the beam; null where there is no program.
};

Shown shownOf(const CheckResult& checked, const std::string& gcode, const MachineParameters& machine,
              const JobParameters& job, const PlannerFaults& faults) {
  const Axes axes(machine, faults);
  if (!checked.solution) {
    const std::optional<UnitPath> unit = nearestMotion(unitOf(readGcode(gcode)), job, axes);
    if (!unit) throw PlanError("the axes allow no motion at all");
    return {.film = filmOf(*unit, machine, job), .belt_mm_s = unit->belt_speed_mm_s};
  }
  // The first unit's steps do not depend on the units behind it, but where they are chosen together with what
  // follows, for rotors that swing.
  JobParameters sent = job;
  if (machine.steppers.resonance_hz <= 0.0) sent.units = 1;
  const Program program = planFromChecked(checked, gcode, machine, sent, faults).program;
  const UnitMotion motion = unitMotion(program, 0, *checked.solution, machine, job, axes);
  return {
      .film = filmOf(motion, machine, job),
      .belt_mm_s = motion.belt_mm_s,
      .field = {{"beta_mm", motion.x_ref_mm}, {"min", machine.field_min_mm}, {"max", machine.field_max_mm}}};
}

}  // namespace

std::string previewHtml(const std::string& title, const std::string& gcode, const MachineParameters& machine,
                        const JobParameters& job, const PlannerFaults& faults) {
  const std::vector<Segment> path = unitOf(readGcode(gcode));
  if (const auto issues = jobIssues(machine, job); !issues.empty()) {
    throw PlanError(fmt::format("{}", fmt::join(issues, "\n")));
  }
  const CheckResult checked = checkJob(gcode, machine, job, faults);
  const Shown shown = shownOf(checked, gcode, machine, job, faults);
  const Film& film = shown.film;

  const json data{{"period_s", film.period_s},
                  {"full_power_w", fullPower(machine, job)},
                  {"belt_mm_s", shown.belt_mm_s},
                  {"catch_up", film.catch_up},
                  {"x", differences(film, 0)},
                  {"y", differences(film, 1)},
                  {"way_nm", listOf(film, [](const Picture& p) { return std::llround(p.planned_mm * 1e6); })},
                  {"power", listOf(film, [](const Picture& p) { return p.power; })},
                  {"runs", runsOf(film)},
                  {"segments", segmentsOf(path)},
                  {"lines", linesOf(gcode)},
                  {"field", shown.field}};
  const bool fits = checked.errors.empty();
  const double duration_s = static_cast<double>(film.pictures.size() - 1) * film.period_s;
  std::string body(kPageHtml);
  replace(body, "%VERDICT_CLASS%", fits ? "pass" : "fail");
  replace(body, "%VERDICT%", fits ? "fits" : "does not fit");
  replace(body, "%WRONG%", faultList(checked));
  replace(body, "%FACTS%", base::escapeHtml(factsOf(job, duration_s, shown.belt_mm_s)));
  replace(
      body, "%FIELD_KEY%",
      checked.solution ? "<span class=key><i class=fieldbox></i>reach of the beam on the sheet</span>" : "");
  const double period_s = machine.target.periodS();
  replace(body, "%NOTE%",
          film.period_s > period_s ? fmt::format("Every {:.0f}th period is drawn.", film.period_s / period_s)
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
