// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/run_trace.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "hil/base/version.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/pin_wiring.h"
#include "hil/scenario/camera_files.h"
#include "hil/trace/run/clip_page.h"
#include "hil/trace/run/judged_messages.h"
#include "hil/trace/run/machine_message.h"
#include "twin/scene/moving_scene.h"

namespace kerfbench::trace {
namespace {

namespace fs = std::filesystem;

/// Shortest time between two rows of /motion.
constexpr double kRow_s = 0.5e-3;
/// Batches in a chunk of the file that grows: 40 ms.
constexpr int kBatchesInChunk = 2;
constexpr double kRowRounding_s = 1e-7;
/// From which share of its full power on the laser counts as lit.
constexpr double kLitShare = 0.01;

/// Moments of a report that get a page of their own: each has all of the viewer in it.
constexpr std::size_t kMomentPages = 3;

constexpr int kDebug = 1, kInfo = 2, kError = 4;  // Levels of foxglove.Log.

std::uint64_t nanoseconds(double time_s) {
  return static_cast<std::uint64_t>(std::llround(1e9 * std::max(0.0, time_s)));
}

std::string hexOf(std::span<const std::uint8_t> bytes) {
  std::string hex;
  hex.reserve(2 * bytes.size());
  constexpr std::string_view kDigits = "0123456789abcdef";
  for (const std::uint8_t byte : bytes) {
    hex.push_back(kDigits[byte >> 4U]);
    hex.push_back(kDigits[byte & 15U]);
  }
  return hex;
}

/// Columns that are plotted over hours.
std::vector<std::string> overviewColumns(const std::vector<twin::PoseColumn>& columns) {
  std::vector<std::string> names;
  for (const twin::PoseColumn column : columns)
    if (column != twin::PoseColumn::kRoller) names.emplace_back(twin::poseColumnName(column));
  for (const char* name : {"spot_x_mm", "spot_y_mm", "power_w"}) names.emplace_back(name);
  return names;
}

}  // namespace

struct RunTrace::Parts {
  TickRate rate;
  std::vector<twin::PoseColumn> columns;
  WiredSignals signals;
  twin::Surface surface;
  Eigen::Vector2d start_mm;  ///< Origin of S of unit 0 while the belt has not moved, W.
  double lit_w{};

  MotionBatch motion;
  PinBatch pins;
  JsonColumn commanded_t, commanded_x, commanded_y;
  JsonColumn gcode_t, gcode_line, gcode_unit;
  double gcode_first_s{};
  std::optional<evidence::StepCounter> steps;
  std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)> place_of_steps;
  evidence::StepCounter::Steps placed_steps{};
  std::optional<Eigen::Vector2d> placed_mm;
  ProgramFollower follower;
  ProgramFollower::Place on_line;
  BurntPath burnt;
  Overview overview;
  controller::UartListener ear;
  std::size_t reports{};

  double row_s{-1.0};  ///< Time of the last row.
  double row_j{};      ///< Energy until then.
  double quantum_s{};  ///< End of the last quantum.
  double quantum_j{};
  int batches{};                 ///< In the chunk.
  std::size_t sensor{}, word{};  ///< Next of a recording.
};

fs::path growingTrace(const fs::path& results_dir, const std::string& name, const fs::path& output) {
  if (!output.empty()) {
    const fs::path whole = fs::absolute(output).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).string() + ".mcap.part";
  }
  return fs::absolute(results_dir) / name / fmt::format("running-{}.mcap.part", ::getpid());
}

RunTrace::RunTrace(TraceSource source)
    : source_(std::move(source)),
      frames_(source_.frames_every, source_.test_case.machine.spot_camera.width_px,
              source_.test_case.machine.spot_camera.height_px) {
  if (source_.part.has_parent_path()) fs::create_directories(source_.part.parent_path());
  file_ = std::make_unique<TraceFile>(source_.part, runFacts());
}

RunTrace::~RunTrace() = default;

std::map<std::string, std::string> RunTrace::runFacts() const {
  const scenario::Scenario& scenario = source_.test_case.scenario;
  return {{"scenario", scenario.name},
          {"title", scenario.title},
          {"machine", source_.machine.name},
          {"firmware", source_.firmware},
          {"source", source_.source_id},
          {"seed", std::to_string(scenario.seed)},
          {"twin", scenario::nameOf(scenario.fidelity)},
          {"imperfections", scenario::nameOf(scenario.imperfections)},
          {"tick_num", std::to_string(source_.rate.num)},
          {"tick_den", std::to_string(source_.rate.den)},
          {"quantum_s", fmt::format("{}", kRow_s)},
          {"version", base::version()}};
}

void RunTrace::begins(const run::MachineState& state, TickRate rate) {
  const scenario::Case& test_case = source_.test_case;
  const evidence::PinWiring wiring = judge::pinWiring(test_case);
  const planner::JobParameters job = scenario::plannerJob(test_case);
  WiredSignals signals(wiring.signals);
  const std::vector<twin::PoseColumn> columns = twin::poseColumnsOf(source_.machine);
  const auto overview = [this](Topic topic, double from_s, const std::string& json) {
    file_->add(topic, nanoseconds(from_s), json);
  };
  const std::size_t wires = signals.signals().size();
  parts_.reset(
      new Parts{.rate = rate,
                .columns = columns,
                .signals = std::move(signals),
                .surface = twin::Surface(source_.machine.surface),
                .start_mm = {scenario::webOn(source_.machine, test_case).start_x_mm, 0.0},
                .lit_w = kLitShare * source_.machine.laser.full_power_w,
                .motion = MotionBatch(columns),
                .steps = evidence::StepCounter::from(wiring),
                .place_of_steps = judge::placeOfSteps(test_case),
                .follower = ProgramFollower(source_.program.gcode, {job.units, job.pitch_mm, job.alternate}),
                .overview = Overview(overviewColumns(columns), wires, overview)});
  file_->add(Topic::kMachine, 0,
             machineMessage({test_case, source_.machine, parts_->signals, rate, kRow_s, source_.program}));
  if (parts_->steps) parts_->placed_mm = parts_->place_of_steps(Eigen::Vector2d::Zero());
  takeRow(state);
}

std::vector<SensorEdge> RunTrace::recordedSensors(Tick until) {
  std::vector<SensorEdge> edges;
  const auto& sensors = source_.recorded->sensors;
  for (; parts_->sensor < sensors.size() && sensors[parts_->sensor].tick <= until; ++parts_->sensor)
    edges.push_back(sensors[parts_->sensor]);
  return edges;
}

std::span<const std::uint8_t> RunTrace::recordedWords(Tick until) {
  const auto& words = source_.recorded->uart;
  if (parts_->word >= words.size() || words[parts_->word].tick > until) return {};
  return words[parts_->word++].bytes;
}

void RunTrace::takeEdges(const run::Quantum& quantum) {
  Parts& parts = *parts_;
  std::vector<SensorEdge> recorded;
  if (source_.recorded != nullptr) recorded = recordedSensors(quantum.until);
  const std::span<const SensorEdge> sensors =
      source_.recorded != nullptr ? std::span(recorded) : quantum.sensors;
  for (const PinEdge& edge : parts.signals.edgesOf(quantum.events, sensors)) {
    parts.pins.add(edge);
    parts.overview.addEdge(edge.id, edge.level);
  }
  if (!parts.steps) return;
  for (const PinEvent& event : quantum.events) parts.steps->take(event);
}

void RunTrace::say(double time_s, const char* who, int level, const std::string& words,
                   std::span<const std::uint8_t> bytes) {
  const std::uint64_t time_ns = nanoseconds(time_s);
  std::string text = "{";
  appendTimestamp(text, time_ns);
  text += fmt::format(R"(,"level":{},"message":)", level);
  appendQuoted(text, words);
  text += fmt::format(R"(,"name":"{}","file":"","line":0,"hex":"{}"}})", who, hexOf(bytes));
  file_->add(Topic::kUart, time_ns, text);
}

void RunTrace::takeWords(const run::Quantum& quantum) {
  Parts& parts = *parts_;
  const double now_s = parts.rate.seconds(quantum.until);
  const bool speaks =
      source_.test_case.scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kKerfbench;
  const auto words = [&](std::span<const std::uint8_t> bytes) {
    return speaks ? fmt::format("{} bytes", bytes.size())
                  : std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  const auto heard = [&](std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return;
    if (speaks) parts.ear.hear(bytes, now_s);
    say(now_s, "controller", kDebug, words(bytes), bytes);
    for (; parts.reports < parts.ear.reports().size(); ++parts.reports) {
      const inspect::ControllerState& state = parts.ear.reports()[parts.reports];
      say(now_s, "controller", state.stopped ? kError : kInfo,
          fmt::format("{}: {}", state.stopped ? "stopped" : "state", state.fault), {});
    }
  };
  if (source_.recorded == nullptr) {
    heard(quantum.heard);
  } else {
    for (auto bytes = recordedWords(quantum.until); !bytes.empty(); bytes = recordedWords(quantum.until))
      heard(bytes);
  }
  if (!quantum.said.empty()) say(now_s, "bench", kDebug, words(quantum.said), quantum.said);
}

void RunTrace::takeRow(const run::MachineState& state) {
  Parts& parts = *parts_;
  const double time_s = state.pose.time_s;
  MotionRow row;
  row.time_s = time_s;
  for (std::size_t i = 0; i < parts.columns.size(); ++i)
    row.columns.at(i) = twin::poseColumnOf(state.pose, parts.columns[i]);
  const bool hits = state.spot_W_mm.allFinite();
  row.spot_W_mm << state.spot_W_mm, hits ? parts.surface.height_mm(state.spot_W_mm, time_s) : std::nan("");
  if (parts.row_s >= 0.0) row.power_w = (state.emitted_j - parts.row_j) / (time_s - parts.row_s);
  row.lit = row.power_w > parts.lit_w;
  parts.motion.add(row);
  parts.row_s = time_s;
  parts.row_j = state.emitted_j;
  takeCommanded(state);
  const Eigen::Vector2d p_WS_mm =
      parts.start_mm + Eigen::Vector2d(state.pose.belt_travel_mm, 0.0) + state.pose.sheet_slip_mm;
  if (auto message = parts.burnt.add(time_s, state.spot_W_mm - p_WS_mm, row.lit))
    file_->add(Topic::kBurnt, nanoseconds(message->from_s), message->json);
}

void RunTrace::takeCommanded(const run::MachineState& state) {
  Parts& parts = *parts_;
  if (!parts.steps) return;
  const evidence::StepCounter::Steps& steps = parts.steps->now();
  if (steps != parts.placed_steps) {
    parts.placed_steps = steps;
    parts.placed_mm = parts.place_of_steps(Eigen::Vector2d(steps[0], steps[1]));
  }
  const Eigen::Vector2d p_W_mm = parts.placed_mm.value_or(Eigen::Vector2d::Constant(std::nan("")));
  const double time_s = state.pose.time_s;
  parts.commanded_t.add(time_s, kSeconds);
  parts.commanded_x.add(p_W_mm.x(), kMm);
  parts.commanded_y.add(p_W_mm.y(), kMm);
  if (parts.follower.empty()) return;
  const Eigen::Vector2d p_WS_mm =
      parts.start_mm + Eigen::Vector2d(state.pose.belt_travel_mm, 0.0) + state.pose.sheet_slip_mm;
  const ProgramFollower::Place place = parts.follower.follow(p_W_mm - p_WS_mm);
  if (place == parts.on_line) return;
  parts.on_line = place;
  if (parts.gcode_t.empty()) parts.gcode_first_s = time_s;
  parts.gcode_t.add(time_s, kSeconds);
  parts.gcode_line.add(place.line);
  parts.gcode_unit.add(place.unit);
}

void RunTrace::saw(const run::Quantum& quantum, const run::MachineState& state) {
  Parts& parts = *parts_;
  takeEdges(quantum);
  takeWords(quantum);
  const double time_s = parts.rate.seconds(quantum.until);
  const double elapsed_s = time_s - parts.quantum_s;
  const double power_w = elapsed_s > 0.0 ? (state.emitted_j - parts.quantum_j) / elapsed_s : 0.0;
  std::vector<double> values;
  for (const twin::PoseColumn column : parts.columns)
    if (column != twin::PoseColumn::kRoller) values.push_back(twin::poseColumnOf(state.pose, column));
  values.insert(values.end(), {state.spot_W_mm.x(), state.spot_W_mm.y(), power_w});
  parts.overview.addRow(time_s, values, power_w > parts.lit_w ? elapsed_s : 0.0);
  parts.quantum_s = time_s;
  parts.quantum_j = state.emitted_j;
  if (state.pose.time_s < parts.row_s + kRow_s - kRowRounding_s) return;
  if (parts.motion.rows() > 0 && state.pose.time_s > parts.motion.first_s() + kBatch_s - kRowRounding_s)
    endBatch();
  takeRow(state);
}

void RunTrace::sawFrame(const Frame& frame) { frames_.add(frame); }

void RunTrace::endBatch() {
  Parts& parts = *parts_;
  const double first_s = parts.motion.first_s();
  file_->add(Topic::kMotion, nanoseconds(first_s), parts.motion.take());
  if (!parts.commanded_t.empty()) {
    std::string text = "{";
    for (const auto& [name, column] :
         {std::pair{"t_s", &parts.commanded_t}, {"x_mm", &parts.commanded_x}, {"y_mm", &parts.commanded_y}}) {
      appendColumn(text, name, *column);
      column->clear();
    }
    file_->add(Topic::kCommanded, nanoseconds(first_s), text + "}");
  }
  if (!parts.gcode_t.empty()) {
    std::string text = "{";
    for (const auto& [name, column] :
         {std::pair{"t_s", &parts.gcode_t}, {"line", &parts.gcode_line}, {"unit", &parts.gcode_unit}}) {
      appendColumn(text, name, *column);
      column->clear();
    }
    file_->add(Topic::kGcode, nanoseconds(parts.gcode_first_s), text + "}");
  }
  if (!parts.pins.empty()) {
    const double tick0_s = parts.rate.seconds(parts.pins.tick0());
    file_->add(Topic::kPins, nanoseconds(tick0_s), parts.pins.take());
  }
  if (++parts.batches < kBatchesInChunk) return;
  parts.batches = 0;
  for (const TopicGroup group :
       {TopicGroup::kMotion, TopicGroup::kPins, TopicGroup::kBurnt, TopicGroup::kOverview})
    file_->flush(group);
}

void RunTrace::endParts() {
  if (parts_->motion.rows() > 0) endBatch();
  if (auto message = parts_->burnt.end())
    file_->add(Topic::kBurnt, nanoseconds(message->from_s), message->json);
  parts_->overview.end();
}

void RunTrace::addJudgement(const report::RunReport& report, TraceFile& whole) const {
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> pixel;
  const scenario::BenchCameras cameras = scenario::readCalibrations(source_.test_case);
  if (cameras.spot)
    pixel = [&cameras](const Eigen::Vector2d& p_W_mm) { return cameras.spot->pixelFromPlane(p_W_mm); };
  const auto take = [&whole](Topic topic) {
    return [&whole, topic](double time_s, const std::string& json) {
      whole.add(topic, nanoseconds(time_s), json);
      whole.flushIfFull(groupOf(topic));
    };
  };
  spotMessages(report, pixel, take(Topic::kSpot));
  whole.flush(TopicGroup::kCamera);
  std::uint64_t before_ns = 0;
  frames_.forEach([&](std::uint64_t time_ns, std::string_view json) {
    // The windows of one frame stay together.
    if (time_ns != before_ns) whole.flushIfFull(TopicGroup::kCamera);
    whole.add(Topic::kFrames, time_ns, json);
    before_ns = time_ns;
  });
  whole.flush(TopicGroup::kCamera);
  checkMessages(report, take(Topic::kChecks));
}

void RunTrace::finish(report::RunReport& report, const report::Digests& digests, const fs::path& folder,
                      const fs::path& clip_page) {
  if (!parts_) throw std::logic_error("RunTrace: nothing was run");
  endParts();
  file_->close();
  const fs::path path = folder / kTraceFile;
  TraceFile whole(path, runFacts());
  if (const Copied copied = copyMessages(source_.part, whole); !copied.problems.empty())
    throw McapError(fmt::format("{}, {}", source_.part.string(), copied.problems.front()));
  addJudgement(report, whole);
  whole.addAttachment("scenario.yaml", "application/yaml", source_.test_case.scenario.text);
  const std::string& gcode = source_.program.gcode;
  if (!gcode.empty()) whole.addAttachment("job.gcode", "text/plain", gcode);
  whole.addMetadata("verdict", {{"verdict", std::string(inspect::verdictName(report.result.verdict))},
                                {"digest", digests.results},
                                {"end_s", fmt::format("{}", report.virtual_s)}});
  whole.close();
  fs::remove(source_.part);
  report.trace = kTraceFile;
  if (!fs::exists(clip_page)) return;
  for (std::size_t i = 0; i < std::min(report.moments.size(), kMomentPages); ++i) {
    report::Moment& moment = report.moments[i];
    moment.page = fmt::format("moment-{}.html", i + 1);
    const fs::path clip = folder / "moment.mcap";
    rewriteTrace(path, clip, {moment.time_s - kClipAround_s, moment.time_s + kClipAround_s});
    writeClipPage(clip_page, clip, {report.scenario, moment.time_s}, folder / moment.page);
    fs::remove(clip);
  }
}

std::unique_ptr<RunTrace> tracing(TraceSource source, const judge::RunOptions& options,
                                  base::Console& console) {
  if (!options.trace) return nullptr;
  source.part = growingTrace(options.results_dir, source.folder_name, options.output);
  source.frames_every = options.trace_frames;
  const std::string part = fs::absolute(source.part).string();
  auto traced = std::make_unique<RunTrace>(std::move(source));
  console.say(fmt::format("trace: {}", part));
  console.event("trace", {{"file", part}});
  return traced;
}

std::function<void(report::RunReport&, const report::Digests&, const fs::path&)> finishing(
    RunTrace* traced, const judge::RunOptions& options, base::Console& console) {
  if (traced == nullptr) return {};
  return [traced, page = clipPage(options.bin_dir), &console](
             report::RunReport& report, const report::Digests& digests, const fs::path& folder) {
    console.endProgress();
    traced->finish(report, digests, folder, page);
  };
}

}  // namespace kerfbench::trace
