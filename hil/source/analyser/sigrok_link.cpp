// SPDX-License-Identifier: Apache-2.0
#include "hil/source/analyser/sigrok_link.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "hil/source/analyser/analyser_stream.h"

namespace kerfbench::source {
namespace {

using Frame = analyser_stream::AnalyserFrame;
using Io = ChildProcess::Io;

constexpr std::chrono::seconds kToStart{30};  // Firmware is loaded into some devices, and they come back.
constexpr std::chrono::seconds kBeyondLimit{15};
constexpr std::chrono::milliseconds kFarewell{2000};

/// The child cannot be understood any more.
class LinkBroken : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Message {
  Frame frame{};
  std::vector<std::uint8_t> payload;
  [[nodiscard]] std::string text() const { return {payload.begin(), payload.end()}; }
};

template <typename T>
T littleEndian(std::span<const std::uint8_t> bytes) {
  T value{};
  for (std::size_t i = 0; i < sizeof(T); ++i) value |= static_cast<T>(static_cast<T>(bytes[i]) << (8 * i));
  return value;
}

class Conversation {
 public:
  Conversation(std::unique_ptr<ByteLink> link, const std::string& request) : link_(std::move(link)) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(request.data());
    if (link_->write({bytes, request.size()}, ByteLink::Clock::now() + kToStart) != Io::kDone) gone();
  }

  /// @throws LinkBroken.
  Message next(ByteLink::Clock::time_point deadline) {
    std::array<std::uint8_t, analyser_stream::kHeadBytes> head{};
    take(head, deadline);
    const auto size = littleEndian<std::uint32_t>(std::span(head).subspan(1));
    if (size > analyser_stream::kMostFrameBytes) throw LinkBroken("what reads the analyser talks nonsense");
    Message message{static_cast<Frame>(head[0]), std::vector<std::uint8_t>(size)};
    take(message.payload, deadline);
    return message;
  }

 private:
  void take(std::span<std::uint8_t> into, ByteLink::Clock::time_point deadline) {
    switch (link_->read(into, deadline)) {
      case Io::kDone:
        return;
      case Io::kTimedOut:
        throw LinkBroken("the analyser does not answer: nothing came from it in time");
      case Io::kClosed:
        break;
    }
    gone();
  }
  [[noreturn]] void gone() { throw LinkBroken("what reads the analyser " + link_->farewell()); }

  std::unique_ptr<ByteLink> link_;
};

/// Calls `take` with key and text of each line.
template <typename Take>
void eachLine(const std::string& text, Take take) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = std::string_view(text).substr(at, end - at);
    const std::size_t blank = std::min(line.find(' '), line.size());
    take(std::string(line.substr(0, blank)), std::string(line.substr(std::min(blank + 1, line.size()))));
    at = end + 1;
  }
}

AnalyserDevice deviceOf(const std::string& text) {
  AnalyserDevice device;
  eachLine(text, [&](const std::string& key, const std::string& value) {
    if (key == "driver") device.driver = value;
    if (key == "name") device.name = value;
    if (key == "serial") device.serial = value;
    if (key == "conn") device.conn = value;
    if (key == "rates") device.samplerates = value;
    if (key == "channel") device.channels.push_back(value);
  });
  return device;
}

std::string requestOf(const AnalyserRequest& request) {
  std::string text = "acquire\n";
  const auto line = [&](const char* key, const std::string& value) {
    if (value.find_first_of(std::string("\n\0", 2)) != std::string::npos)
      throw AnalyserError(fmt::format("a {} with a line break makes no sense", key));
    text += fmt::format("{} {}\n", key, value);
  };
  line("driver", request.driver);
  if (!request.conn.empty()) line("conn", request.conn);
  if (!request.serial.empty()) line("serial", request.serial);
  line("samplerate", std::to_string(request.samplerate_hz));
  line("quiet", std::to_string(request.listen.quiet_samples));
  line("limit", std::to_string(request.listen.limit_samples));
  for (const std::string& channel : request.channels) line("channel", channel);
  for (const auto& [key, value] : request.settings) line("setting", fmt::format("{}={}", key, value));
  return text + "\n";
}

class LinkedFeed final : public AnalyserFeed {
 public:
  LinkedFeed(Conversation conversation, std::string device, ByteLink::Clock::time_point deadline)
      : conversation_(std::move(conversation)), device_(std::move(device)), deadline_(deadline) {}

  [[nodiscard]] std::string device() const override { return device_; }

  bool read(std::vector<LevelRun>& runs) override {
    while (!over_) {
      try {
        const Message message = conversation_->next(deadline_);
        if (message.frame == Frame::kRuns) {
          takeRuns(message.payload, runs);
          return true;
        }
        takeOther(message);
      } catch (const LinkBroken& e) {
        end_.problems.emplace_back(e.what());
        finish(AnalyserEnd::Reason::kBroken);
      }
    }
    return false;
  }

  [[nodiscard]] AnalyserEnd end() const override { return end_; }

 private:
  static void takeRuns(std::span<const std::uint8_t> payload, std::vector<LevelRun>& runs) {
    if (payload.size() % analyser_stream::kRunBytes != 0) throw LinkBroken("half a run of levels came");
    for (; !payload.empty(); payload = payload.subspan(analyser_stream::kRunBytes))
      runs.push_back({littleEndian<std::uint64_t>(payload), littleEndian<std::uint32_t>(payload.subspan(8))});
  }

  void takeOther(const Message& message) {
    if (message.frame == Frame::kProblem) {
      end_.problems.push_back(message.text());
    } else if (message.frame == Frame::kNote) {
      end_.notes.push_back(message.text());
    } else if (message.frame == Frame::kFinished && message.payload.size() == 1 &&
               message.payload[0] < static_cast<std::uint8_t>(AnalyserEnd::Reason::kBroken)) {
      finish(static_cast<AnalyserEnd::Reason>(message.payload[0]));
    } else {
      throw LinkBroken("what reads the analyser talks nonsense");
    }
  }

  void finish(AnalyserEnd::Reason reason) {
    end_.reason = reason;
    over_ = true;
    conversation_.reset();
  }

  std::optional<Conversation> conversation_;
  std::string device_;
  ByteLink::Clock::time_point deadline_;
  AnalyserEnd end_;
  bool over_{};
};

class LinkedAnalysers final : public AnalyserSystem {
 public:
  explicit LinkedAnalysers(std::function<std::unique_ptr<ByteLink>()> start) : start_(std::move(start)) {}

  AnalyserList list() override {
    AnalyserList list;
    converse("list\n\n", [&](Conversation& conversation) {
      for (;;) {
        const Message message = conversation.next(ByteLink::Clock::now() + kToStart);
        if (message.frame == Frame::kListed) return;
        takeListed(message, list);
      }
    });
    return list;
  }

  std::unique_ptr<AnalyserFeed> acquire(const AnalyserRequest& request) override {
    std::unique_ptr<AnalyserFeed> feed;
    converse(requestOf(request), [&](Conversation& conversation) {
      const Message message = conversation.next(ByteLink::Clock::now() + kToStart);
      if (message.frame == Frame::kError) throw AnalyserError(message.text());
      if (message.frame != Frame::kStarted) throw LinkBroken("what reads the analyser talks nonsense");
      const double limit_s = static_cast<double>(request.listen.limit_samples) /
                             static_cast<double>(std::max<std::uint64_t>(request.samplerate_hz, 1));
      const auto limit = std::chrono::duration_cast<ByteLink::Clock::duration>(
          std::chrono::duration<double>(std::min(limit_s, 1e6)));
      feed = std::make_unique<LinkedFeed>(std::move(conversation), message.text(),
                                          ByteLink::Clock::now() + limit + kBeyondLimit);
    });
    return feed;
  }

 private:
  static void takeListed(const Message& message, AnalyserList& list) {
    switch (message.frame) {
      case Frame::kError:
        throw AnalyserError(message.text());
      case Frame::kLibrary:
        eachLine(message.text(), [&](const std::string& key, const std::string& value) {
          if (key == "library") list.library = value;
          if (key == "driver") list.drivers.push_back(value);
        });
        return;
      case Frame::kDevice:
        list.devices.push_back(deviceOf(message.text()));
        return;
      case Frame::kFault:
        list.faults.push_back(message.text());
        return;
      default:
        throw LinkBroken("what reads the analyser talks nonsense");
    }
  }

  template <typename Work>
  void converse(const std::string& request, Work work) const {
    try {
      Conversation conversation(start_(), request);
      work(conversation);
    } catch (const LinkBroken& e) {
      throw AnalyserError(e.what());
    } catch (const std::system_error& e) {
      throw AnalyserError(fmt::format("cannot be started: {}", e.what()));
    }
  }

  std::function<std::unique_ptr<ByteLink>()> start_;
};

class ChildLink final : public ByteLink {
 public:
  explicit ChildLink(const std::filesystem::path& program) : child_({program.string()}) {}
  Io write(std::span<const std::uint8_t> bytes, Clock::time_point deadline) override {
    return child_.write(bytes, deadline);
  }
  Io read(std::span<std::uint8_t> into, Clock::time_point deadline) override {
    return child_.read(into, deadline);
  }
  std::string farewell() override {
    const std::string how = child_.finish(kFarewell);
    const std::string words = child_.lastWords();
    return how + (words.empty() ? "" : ": " + words);
  }

 private:
  ChildProcess child_;
};

}  // namespace

std::shared_ptr<AnalyserSystem> linkedAnalysers(std::function<std::unique_ptr<ByteLink>()> start) {
  return std::make_shared<LinkedAnalysers>(std::move(start));
}

std::shared_ptr<AnalyserSystem> sigrokAnalysers(const std::filesystem::path& bin_dir) {
  return linkedAnalysers(
      [program = bin_dir / "kerfbench-sigrok"] { return std::make_unique<ChildLink>(program); });
}

}  // namespace kerfbench::source
