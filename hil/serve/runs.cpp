// SPDX-License-Identifier: Apache-2.0
#include "hil/serve/runs.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "hil/base/exit_codes.h"
#include "hil/base/stopwatch.h"
#include "hil/base/temporary.h"
#include "hil/batch/job_process.h"
#include "hil/serve/event_stream.h"
#include "hil/serve/file_body.h"
#include "hil/serve/refusal.h"
#include "hil/trace/topics.h"

namespace kerfbench::serve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// So often it is read what a run has said.
constexpr int kLook_ms = 50;
/// Below this share nobody can tell how long the rest takes.
constexpr double kLeastShare = 0.02;
constexpr std::size_t kLongestSerialNumber = 64;
constexpr std::size_t kMostProblems = 20;
/// Events that say how something stands now.
constexpr std::array kStanding{"progress", "pins", "operator"};

std::string textIn(const Json& json, const char* key) {
  if (!json.contains(key) || json[key].is_null()) return {};
  if (!json[key].is_string()) throw Refusal(400, fmt::format("'{}' is no text.", key));
  return json[key].get<std::string>();
}

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

RunWish runWishFrom(const Json& json) {
  RunWish wish;
  wish.scenario = textIn(json, "scenario");
  wish.image = textIn(json, "image");
  wish.serial_number = textIn(json, "serial_number");
  if (wish.scenario.empty()) throw Refusal(400, "The request does not say which scenario is to be run.");
  if (json.contains("trace")) {
    if (!json["trace"].is_boolean()) throw Refusal(400, "'trace' is neither true nor false.");
    wish.trace = json["trace"].get<bool>();
  }
  if (json.contains("seed") && !json["seed"].is_null()) {
    if (!json["seed"].is_number_unsigned()) throw Refusal(400, "'seed' is no whole number from 0 on.");
    wish.seed = json["seed"].get<std::uint64_t>();
  }
  const auto is_plain = [](char c) { return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f; };
  if (wish.serial_number.size() > kLongestSerialNumber || !std::ranges::all_of(wish.serial_number, is_plain))
    throw Refusal(400, fmt::format("A serial number has at most {} bytes, and no control characters.",
                                   kLongestSerialNumber));
  return wish;
}

std::string shellLine(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    const auto is_plain = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '/' ||
             c == '.' || c == '_' || c == '-' || c == '=' || c == ':' || c == ',';
    };
    if (!line.empty()) line += ' ';
    if (!word.empty() && std::ranges::all_of(word, is_plain)) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

/// A run from its wish to its end. What clients read of it is behind its mutex.
class Runs::Run {
 public:
  enum class State { kWaiting, kRunning, kEnded, kStopped };

  Run(std::string id, RunWish wish, std::vector<std::string> words, const WorkFolder& files)
      : id_(std::move(id)), wish_(std::move(wish)), words_(std::move(words)), files_(files) {
    tellState();
  }

  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] const RunWish& wish() const { return wish_; }
  [[nodiscard]] std::string command() const { return "kerfbench " + shellLine(words_); }
  [[nodiscard]] std::shared_ptr<EventStream> stream() const { return stream_; }
  [[nodiscard]] bool isOver() const {
    const std::lock_guard lock(mutex_);
    return state_ == State::kEnded || state_ == State::kStopped;
  }
  [[nodiscard]] bool isWaiting() const {
    const std::lock_guard lock(mutex_);
    return state_ == State::kWaiting;
  }

  [[nodiscard]] Json json() const {
    const std::lock_guard lock(mutex_);
    return jsonLocked();
  }

  /// The trace as it is now; invalid: there is none yet.
  [[nodiscard]] base::UniqueFd openTrace() const {
    const std::lock_guard lock(mutex_);
    return base::UniqueFd(trace_file_.valid() ? ::fcntl(trace_file_.get(), F_DUPFD_CLOEXEC, 3) : -1);
  }

  void stop() {
    const std::lock_guard lock(mutex_);
    is_stop_wanted_ = true;
    if (state_ == State::kWaiting) endLocked(State::kStopped, std::nullopt, "");
  }

  /// Runs it, in the thread that calls; `is_ending`: it is to be ended at once.
  void execute(const fs::path& program, const std::function<bool()>& is_ending) {
    {
      const std::lock_guard lock(mutex_);
      if (state_ != State::kWaiting) return;
      state_ = State::kRunning;
    }
    tellState();
    try {
      runProcess(program, is_ending);
    } catch (const std::exception& broken) {
      const std::lock_guard lock(mutex_);
      endLocked(State::kEnded, base::kExitBroken, broken.what());
    }
  }

 private:
  static const char* nameOf(State state) {
    switch (state) {
      case State::kWaiting:
        return "waiting";
      case State::kRunning:
        return "running";
      case State::kEnded:
        return "ended";
      case State::kStopped:
        return "stopped";
    }
    return "";
  }

  [[nodiscard]] Json jsonLocked() const {
    Json json = facts_;
    json["id"] = id_;
    json["scenario"] = wish_.scenario;
    json["state"] = nameOf(state_);
    json["command"] = command();
    json["serial_number"] = wish_.serial_number;
    json["progress"] = progress_;
    json["live"] = live_;
    return json;
  }

  void tellState() { stream_->add("state", dumped(json()), true); }

  void endLocked(State state, std::optional<int> code, const std::string& problem) {
    state_ = state;
    if (code) facts_["exit_code"] = *code;
    if (!problem.empty()) facts_["problem"] = problem;
    stream_->add("state", dumped(jsonLocked()), true);
    stream_->end();
  }

  void runProcess(const fs::path& program, const std::function<bool()>& is_ending) {
    const base::TemporaryFolder told(fs::temp_directory_path(), "kerfbench-run");
    const std::string events = told.path() / "events.jsonl", log = told.path() / "log.txt";
    std::vector<std::string> words{program.string()};
    words.insert(words.end(), words_.begin(), words_.end());
    words.insert(words.end(), {"--events", events});
    batch::JobProcess process(words, log, files_.folder());
    LineTail event_lines(events), log_lines(log);
    std::optional<base::Stopwatch> since_stop;
    bool is_killed = false;
    const auto readAll = [&](bool to_the_end) {
      event_lines.read([this](const std::string& line) { hear(line); }, to_the_end);
      log_lines.read(
          [this](const std::string& line) {
            stream_->add("log", dumped({{"line", line}}), false);
          },
          to_the_end);
    };
    for (pollfd poller{process.fd(), POLLIN, 0}; ::poll(&poller, 1, kLook_ms) <= 0;) {
      readAll(false);
      const bool ends = is_ending();
      if (!since_stop && (ends || isStopWanted())) {
        since_stop.emplace();
        process.signal(SIGINT);
      } else if (since_stop && !is_killed && since_stop->total_s() > (ends ? kGraceAtEnd_s : kGrace_s)) {
        is_killed = true;
        process.signal(SIGKILL);
      }
    }
    const batch::JobEnd end = process.finish();
    readAll(true);
    const bool is_exit = end.how == batch::JobEnd::How::kExited;
    const std::lock_guard lock(mutex_);
    const bool was_stopped = is_stop_wanted_ && !facts_.contains("verdict");
    endLocked(was_stopped ? State::kStopped : State::kEnded, is_exit ? std::optional(end.code) : std::nullopt,
              is_exit || was_stopped ? "" : "The run " + batch::describe(end) + ".");
  }

  [[nodiscard]] bool isStopWanted() const {
    const std::lock_guard lock(mutex_);
    return is_stop_wanted_;
  }

  /// An event of the run itself.
  void hear(const std::string& line) {
    Json event = Json::parse(line, nullptr, false);
    if (!event.is_object() || !event.contains("event") || !event["event"].is_string()) return;
    const std::string name = event["event"].get<std::string>();
    event.erase("event");
    bool is_state = false;
    {
      const std::lock_guard lock(mutex_);
      is_state = noteLocked(name, event);
      openTraceLocked();
    }
    const bool is_standing = std::ranges::find(kStanding, name) != kStanding.end();
    stream_->add(name, dumped(event), is_standing);
    if (is_state) tellState();
  }

  /// Whether it changes what json() says besides the progress.
  bool noteLocked(const std::string& name, Json& event) {
    if (name == "progress") {
      addTimeLeft(event);
      progress_ = event;
      return false;
    }
    if (name == "scenario") facts_["name"] = event.value("name", "");
    if (name == "verdict") facts_["verdict"] = event.value("verdict", "");
    if (name == "results") {
      const std::string folder = files_.nameOf(event.value("folder", ""));
      facts_["results"] = folder;
      facts_["report"] = "/" + percentEncoded(folder) + "/report.html";
      if (fs::exists(files_.folder() / folder / trace::kTraceFile))
        facts_["trace"] = folder + "/" + trace::kTraceFile;
      event["folder"] = folder;
    }
    if (name == "trace") noteTrace(event);
    if (name == "pins") live_["pins"] = event;
    if (name == "operator") live_["operator"] = event.value("text", "");
    if (name == "problem" && live_["problems"].size() < kMostProblems)
      live_["problems"].push_back(event.value("text", ""));
    return name == "scenario" || name == "verdict" || name == "results" || name == "trace";
  }

  void noteTrace(Json& event) {
    const std::string file = event.value("file", "");
    event["file"] = files_.nameOf(file);
    trace_place_ = file;
  }

  /// A run names its trace before it has written any of it.
  void openTraceLocked() {
    if (!trace_file_.valid() && !trace_place_.empty())
      trace_file_ = base::UniqueFd(::open(trace_place_.c_str(), O_RDONLY | O_CLOEXEC));
  }

  void addTimeLeft(Json& event) {
    const double share = event.value("share", 0.0);
    if (!event.contains("now_s")) return;
    if (!since_first_) since_first_.emplace();
    if (share >= kLeastShare) event["left_s"] = since_first_->total_s() * (1.0 - share) / share;
  }

  std::string id_;
  RunWish wish_;
  std::vector<std::string> words_;  ///< Arguments of the command.
  const WorkFolder& files_;
  std::shared_ptr<EventStream> stream_{std::make_shared<EventStream>()};
  mutable std::mutex mutex_;
  State state_{State::kWaiting};
  bool is_stop_wanted_{};
  Json facts_ = Json::object();
  Json progress_ = {{"what", ""}};
  Json live_ = {{"problems", Json::array()}};
  std::string trace_place_;
  base::UniqueFd trace_file_;
  std::optional<base::Stopwatch> since_first_;
};

Runs::Runs(const WorkFolder& files, fs::path program)
    : files_(files), program_(std::move(program)), thread_([this] { work(); }) {}

Runs::~Runs() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

std::shared_ptr<Runs::Run> Runs::nextOne() {
  std::unique_lock lock(mutex_);
  std::shared_ptr<Run> next;
  changed_.wait(lock, [&] {
    const auto found = std::ranges::find_if(runs_, [](const auto& run) { return run->isWaiting(); });
    next = found == runs_.end() ? nullptr : *found;
    return ending_ || next != nullptr;
  });
  return ending_ ? nullptr : next;
}

void Runs::work() {
  const auto is_ending = [this] {
    const std::lock_guard lock(mutex_);
    return ending_;
  };
  while (const std::shared_ptr<Run> run = nextOne()) run->execute(program_, is_ending);
}

Json Runs::add(const RunWish& wish) {
  const fs::path scenario = files_.pathOf(wish.scenario);
  const bool is_shipped = wish.scenario.starts_with(kShipped);
  // As one types it in the folder; "./" keeps a name that begins with '-' from being an option.
  std::vector<std::string> words{
      "run", is_shipped ? scenario.string() : (wish.scenario.starts_with('-') ? "./" : "") + wish.scenario};
  if (!wish.image.empty()) words.insert(words.end(), {"--image", files_.pathOf(wish.image).string()});
  if (wish.seed) words.insert(words.end(), {"--seed", std::to_string(*wish.seed)});
  if (!wish.serial_number.empty()) words.push_back("--serial-number=" + wish.serial_number);
  if (wish.trace) words.emplace_back("--trace");
  const std::lock_guard lock(mutex_);
  const auto waiting = std::ranges::count_if(runs_, [](const auto& run) { return run->isWaiting(); });
  if (static_cast<std::size_t>(waiting) >= kMostWaiting)
    throw Refusal(409, fmt::format("{} runs are waiting already.", waiting));
  if (runs_.size() >= kMostKept) {
    const auto over = std::ranges::find_if(runs_, [](const auto& run) { return run->isOver(); });
    if (over != runs_.end()) runs_.erase(over);
  }
  runs_.push_back(std::make_shared<Run>(std::to_string(++last_id_), wish, std::move(words), files_));
  changed_.notify_all();
  return {{"id", runs_.back()->id()}, {"command", runs_.back()->command()}};
}

std::shared_ptr<Runs::Run> Runs::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(runs_, [&id](const auto& run) { return run->id() == id; });
  if (found == runs_.end()) throw Refusal(404, "There is no such run.");
  return *found;
}

Json Runs::list() const {
  const std::lock_guard lock(mutex_);
  Json list = Json::array();
  for (auto run = runs_.rbegin(); run != runs_.rend(); ++run) list.push_back((*run)->json());
  return list;
}

Json Runs::of(const std::string& id) const { return find(id)->json(); }

void Runs::stop(const std::string& id) { find(id)->stop(); }

std::unique_ptr<AnswerBody> Runs::events(const std::string& id, std::uint64_t after) const {
  return eventBody(find(id)->stream(), after);
}

std::unique_ptr<AnswerBody> Runs::trace(const std::string& id, std::uint64_t from) const {
  const std::shared_ptr<Run> run = find(id);
  if (!run->wish().trace || (run->isOver() && !run->openTrace().valid()))
    throw Refusal(404, "Of this run there is no trace.");
  return std::make_unique<GrowingFileBody>([run] { return run->openTrace(); }, from,
                                           [run] { return run->isOver(); });
}

}  // namespace kerfbench::serve
