// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/service_steps.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hil/base/atomic_file.h"
#include "hil/base/input_file.h"
#include "hil/base/text.h"
#include "hil/base/yaml_reader.h"
#include "hil/head_service/sheet_on_twin.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using State = ServiceStep::State;

constexpr const char* kSteps = "steps.json";
constexpr int kStepsVersion = 1;

Json jsonOf(const ServiceStep& step) {
  Json files = Json::array();
  for (const ServiceStep::File& file : step.files)
    files.push_back({{"path", file.path}, {"what", file.what}});
  return {{"id", step.id},       {"sheet", step.sheet},         {"title", step.title},
          {"text", step.text},   {"state", nameOf(step.state)}, {"files", files},
          {"found", step.found}, {"wrong", step.wrong}};
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::size_t first = text.find_first_not_of(' ', from);
    if (first < end) lines.push_back(text.substr(first, end - first));
    from = end + 1;
  }
  return lines;
}

std::vector<std::string> foundOn(const MeasuredSheet& sheet) {
  const SheetErrors errors = errorsOf({&sheet, 1});
  std::vector<std::string> found{
      fmt::format("{} of {} marks were found; {} false.", sheet.marks.size(),
                  sheet.marks.size() + static_cast<std::size_t>(sheet.missing), sheet.false_marks),
      fmt::format("The beam was off by {:.4f} mm at most, {:.4f} mm RMS.", errors.max_mm, errors.rms_mm)};
  found.insert(found.end(), sheet.remarks.begin(), sheet.remarks.end());
  return found;
}

}  // namespace

std::string_view nameOf(State state) {
  switch (state) {
    case State::kDone:
      return "done";
    case State::kNow:
      return "now";
    case State::kLater:
      break;
  }
  return "later";
}

void ServiceSteps::addSheet(const SheetOrder& order, State cut, State load, State found) {
  const std::string& name = order.job.name;
  const auto file = [&](const char* leaf, const char* what) {
    return ServiceStep::File{name + "/" + leaf, what};
  };
  ServiceStep cutting{name + ".cut", name,
                      fmt::format("Cut sheet {}: {} marks", name, order.job.marks.size())};
  cutting.state = cut;
  cutting.files = {file("print.pdf", "print of the board, 100 %"), file("print.svg", "the same"),
                   file("job.gcode", "the job"),
                   file("program.txt", "its program for the reference controller"),
                   file("marks.dxf", "the drawing")};
  if (order.table) cutting.files.push_back(file(kSheetTable, "correction table for the controller"));
  ServiceStep photographing{name + ".photograph", name, fmt::format("Photograph or scan sheet {}", name)};
  photographing.state = cut == State::kDone ? State::kDone : State::kLater;
  photographing.files = {file("pictures/tiles.yaml", "the pictures that are expected, with their places")};
  ServiceStep loading{name + ".load", name, "Put the pictures into the folder and run the command again"};
  loading.state = load;
  ServiceStep finding{name + ".found", name, fmt::format("See what was found on sheet {}", name)};
  finding.state = found;
  for (ServiceStep* step : {&cutting, &photographing, &loading, &finding}) sheets_.push_back(*step);
}

void ServiceSteps::wanted(const SheetOrder& order, const std::vector<std::string>& cut,
                          const std::vector<std::string>& photograph,
                          const std::vector<std::string>& missing) {
  const bool some = !missing.empty();
  addSheet(order, some ? State::kDone : State::kNow, some ? State::kNow : State::kLater, State::kLater);
  const std::size_t first = sheets_.size() - 4;
  sheets_[first].text = cut;
  sheets_[first + 1].text = photograph;
  sheets_[first + 2].text = {
      fmt::format("Pictures go to {}/pictures. Then run: {}", order.job.name, facts_.command)};
  sheets_[first + 2].wrong = missing;
}

void ServiceSteps::refused(const SheetOrder& order, const std::string& why) {
  addSheet(order, State::kDone, State::kDone, State::kNow);
  sheets_.back().text = {
      fmt::format("Mend what is wrong, replace the pictures, and run: {}", facts_.command)};
  sheets_.back().wrong = linesOf(why);
}

void ServiceSteps::measured(const SheetOrder& order, const MeasuredSheet& sheet) {
  addSheet(order, State::kDone, State::kDone, State::kDone);
  sheets_.back().found = foundOn(sheet);
  sheets_.back().files = {{order.job.name + "/" + kSheetMeasured, "what was measured"}};
}

void ServiceSteps::ended(std::string verdict, std::string headline) {
  verdict_ = std::move(verdict);
  headline_ = std::move(headline);
}

std::vector<ServiceStep> ServiceSteps::all() const {
  std::vector<ServiceStep> steps = sheets_;
  steps.insert(steps.end(), following_.begin(), following_.end());
  return steps;
}

std::string ServiceSteps::headline() const {
  if (!headline_.empty()) return headline_;
  for (const ServiceStep& step : all()) {
    if (step.state == State::kNow) return (step.wrong.empty() ? "" : "Something is wrong: ") + step.title;
  }
  return "";
}

std::string ServiceSteps::json() const {
  Json json{{"version", kStepsVersion},    {"kind", facts_.kind},    {"machine", facts_.machine},
            {"camera", facts_.camera},     {"date", facts_.date},    {"command", facts_.command},
            {"kerfbench", facts_.version}, {"headline", headline()}, {"verdict", verdict_},
            {"steps", Json::array()}};
  for (const ServiceStep& step : all()) json["steps"].push_back(jsonOf(step));
  return json.dump(2, ' ', false, decltype(json)::error_handler_t::replace) + "\n";
}

void ServiceSteps::write() const {
  fs::create_directories(results_);
  base::writeFileAtomically(results_ / kSteps, json());
  base::writeFileAtomically(results_ / "steps.html", html());
}

std::string readSteps(const fs::path& results) {
  const fs::path path = results / kSteps;
  base::InputContent content = base::readInput(path, base::kLargestRecord_bytes);
  if (!content.bytes) {
    throw base::ConfigError(
        fmt::format("{}: {}; `calibrate head --by-hand` and `calibrate check --by-hand` write it",
                    path.string(), content.refusal));
  }
  std::string text = *std::move(content.bytes);
  const auto fault = [&](const std::string& what) {
    return base::ConfigError(fmt::format("{}: {}", path.string(), what));
  };
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object() || !json.contains("steps") || !json["steps"].is_array())
    throw fault("is not what `calibrate head --by-hand` writes");
  if (json.value("version", 0) != kStepsVersion)
    throw fault(fmt::format("version: this program reads version {}; run the command again", kStepsVersion));
  return text;
}

std::vector<ServiceStep> stepsAhead() {
  return {{"verify",
           "",
           "Verify: other marks are cut with the table that follows, and measured",
           {"The bench asks for these sheets when the first marks are measured, and for a denser grid where "
            "they show "
            "that it takes one."}},
          {"table",
           "",
           "The correction table is written",
           {"Into correction.csv, as soon as it is proven to be good."}},
          {"controller",
           "",
           "Load the table into the controller",
           {"How, is told here as soon as there is one."}}};
}

std::vector<ServiceStep> stepsAfter(const HeadCalibration& result, const HeadPlan& plan,
                                    const std::string& table) {
  std::vector<ServiceStep> steps = stepsAhead();
  ServiceStep &verify = steps[0], &written = steps[1], &controller = steps[2];
  verify.title = "Verify: other marks were cut with the table, and measured";
  verify.text.clear();
  verify.files = {{"report.html", "the calibration's report"}};
  (result.good() ? verify.found : verify.wrong) = {result.endWords(plan)};
  verify.state = result.good() ? State::kDone : State::kNow;
  if (!result.good()) {
    verify.text = {
        "Look at the report: marks that lie aside together point at the sheet's place or the table of the "
        "camera, single ones at the pictures. Begin again in another folder, with a denser grid if need be "
        "(--grids)."};
    written.text = {fmt::format("Not written. The best one, which is not good enough, is correction-{}.csv.",
                                result.best + 1)};
    return steps;
  }
  written.title = "The correction table is written";
  written.text.clear();
  written.state = State::kDone;
  written.files = {{table, "the controller's table"}};
  const calibrate::AimGrid& grid = result.iterations.at(result.best).head.table.grid;
  written.found = {fmt::format("{} x {} nodes.", grid.x_mm().size(), grid.y_mm().size())};
  controller.state = State::kNow;
  controller.text = {
      fmt::format(
          "The bench and the reference controller: in the machine file, controller: {{correction: {}}}. The "
          "planner computes every step with it, nothing goes into the controller's memory.",
          table),
      fmt::format("A controller that keeps a table: ./bench calibrate table {} --to FORMAT --out FILE, where "
                  "FORMAT is "
                  "c-header for firmware, cor1 or cor2 for a .cor, grid-text or nine-points; "
                  "docs/reference/formats.md "
                  "tells how each is loaded and which way round its axes are.",
                  table),
      "Then cut one sheet with it and check it: ./bench calibrate check --by-hand."};
  return steps;
}

}  // namespace kerfbench::head_service
