// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <stdexcept>
#include <utility>

#include "hil/base/digest.h"
#include "hil/base/text.h"
#include "hil/source/child_connection.h"
#include "hil/source/confinement.h"
#include "hil/source/open.h"
#include "hil/source/pin_stream.h"

namespace kerfbench::source {
namespace {

constexpr std::size_t kHeadBytes = 5;
constexpr std::size_t kEventBytes = 16;
constexpr std::size_t kLongestMessage = 1000;
constexpr std::size_t kMaxUartBlock = 1U << 20U;
constexpr std::chrono::milliseconds kFarewell{500};
/// A UART behind USB at full speed sends so much at most; more is a flood, which would fill the memory.
constexpr double kUartBytesPerS = 1.25e6;
constexpr std::uint64_t kUartBurst = 1U << 20U;
/// Most quanta that a child is asked for at once: their requests and answers fit into a pipe, and the turn
/// from one process to the other, which takes longer than some of them run, is shared by many.
constexpr std::size_t kMostAhead = 16;

/// Frames of the protocol, little-endian.
class Request {
 public:
  explicit Request(std::vector<std::uint8_t>& out, kb_ps_request type) : out_(out), start_(out.size()) {
    out.resize(start_ + kHeadBytes);
    out[start_ + 4] = static_cast<std::uint8_t>(type);
  }
  ~Request() {
    const auto size = static_cast<std::uint32_t>(out_.size() - start_ - kHeadBytes);
    for (std::size_t i = 0; i < 4; ++i) out_[start_ + i] = static_cast<std::uint8_t>(size >> (8 * i));
  }
  Request(const Request&) = delete;
  Request& operator=(const Request&) = delete;
  template <typename T>
  Request& put(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      out_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
    return *this;
  }
  Request& text(const std::string& value) {
    if (value.size() > 0xFFFF) throw std::runtime_error("a text for the child is too long");
    put(static_cast<std::uint16_t>(value.size()));
    return bytes({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
  }
  Request& bytes(std::span<const std::uint8_t> value) {
    out_.insert(out_.end(), value.begin(), value.end());
    return *this;
  }

 private:
  std::vector<std::uint8_t>& out_;
  std::size_t start_;
};

/// The child broke the protocol: whatever it says next cannot be trusted.
class Malformed : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Gone : public Malformed {
  using Malformed::Malformed;
};

class Reply {
 public:
  explicit Reply(std::span<const std::uint8_t> bytes) : rest_(bytes) {}
  template <typename T>
  T take() {
    const auto bytes = block(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
    return static_cast<T>(value);
  }
  std::span<const std::uint8_t> block(std::size_t size) {
    if (rest_.size() < size) throw Malformed("a reply is too short");
    const auto taken = rest_.first(size);
    rest_ = rest_.subspan(size);
    return taken;
  }
  std::string text() {
    const auto bytes = block(take<std::uint16_t>());
    return {bytes.begin(), bytes.end()};
  }
  /// Words for people: what a terminal or a report would trip over is taken out.
  std::string words() { return base::printable(text(), kLongestMessage); }
  void finish() const {
    if (!rest_.empty()) throw Malformed("a reply has bytes left over");
  }

 private:
  std::span<const std::uint8_t> rest_;
};

Stop stopFrom(std::uint8_t code) {
  switch (code) {
    case KB_PS_REACHED:
      return Stop::kReached;
    case KB_PS_ENDED:
      return Stop::kEnded;
    case KB_PS_CRASHED:
      return Stop::kCrashed;
    case KB_PS_FLOODED:
      return Stop::kFlooded;
    case KB_PS_MISHEARD:
      return Stop::kMisheard;
    default:
      throw Malformed("unknown stop code " + std::to_string(code));
  }
}

/// False: not within the deadline. @throws Malformed if the child has gone or talks nonsense.
bool readReply(ChildChannel& child, std::uint8_t& type, std::vector<std::uint8_t>& payload,
               ChildChannel::Clock::time_point deadline) {
  std::array<std::uint8_t, kHeadBytes> head{};
  const auto check = [&child](ChildChannel::Io io) {
    if (io != ChildChannel::Io::kClosed) return io == ChildChannel::Io::kDone;
    const auto end = child.finish(kFarewell);
    const auto words = child.lastWords();
    throw Gone(end + (words.empty() ? "" : "; it said: " + words));
  };
  if (!check(child.read(head, deadline))) return false;
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i) size |= std::uint32_t{head[i]} << (8 * i);
  if (size > KB_PS_MAX_PAYLOAD) throw Malformed("a reply of " + std::to_string(size) + " bytes is too long");
  type = head[4];
  payload.resize(size);
  return check(child.read(payload, deadline));
}

ChildChannel::Clock::time_point in(double seconds) {
  return ChildChannel::Clock::now() +
         std::chrono::duration_cast<ChildChannel::Clock::duration>(std::chrono::duration<double>(seconds));
}

Confinement confinementFor(const ChildSourceOptions& options) {
  // A program that is not there is better told by its own name.
  const bool runs = ::access(options.child.c_str(), X_OK) == 0;
  if (!options.confined || isConnection(options.child) || !runs) return {};
  std::vector<std::filesystem::path> readable{std::filesystem::absolute(options.image)};
  if (!options.eeprom.empty() && options.eeprom != kBlankEeprom)
    readable.push_back(std::filesystem::absolute(options.eeprom));
  return confinementOf(std::filesystem::absolute(options.child), readable);
}

class ChildSource final : public SignalSource {
 public:
  explicit ChildSource(const ChildSourceOptions& options) : options_(options) {
    Confinement confinement = confinementFor(options);
    info_.unconfined = std::move(confinement.open_because);
    child_ = openChannel(options.child, std::move(confinement.launcher));
    open();
  }

  ~ChildSource() override {
    if (stop_ != Stop::kReached) return;
    try {
      { const Request quit(outgoing_, KB_PS_QUIT); }
      (void)child_->write(outgoing_, ChildChannel::Clock::now() + kFarewell);
      (void)child_->finish(kFarewell);
    } catch (...) {
      // Only the farewell is lost: its destructor kills and reaps the child.
    }
  }

  [[nodiscard]] SourceInfo info() const override { return info_; }

  Stop advance(Tick until, Batch& batch) override {
    batch.events.clear();
    batch.uart.clear();
    batch.watermark = batch.uart_received = watermark_;
    if (stop_ != Stop::kReached) return stop_;
    if (until <= watermark_) throw std::invalid_argument("advance() must go forward");
    const auto begun = ChildChannel::Clock::now();
    const auto deadline = quantumDeadline();
    if (!ask(until, deadline)) return hung();
    asked_.pop_front();
    // A child that no longer reads may still have said why.
    try {
      readBatch(until, batch, deadline);
    } catch (const Gone& fault) {
      batch = {{}, {}, watermark_, watermark_};
      fail(Stop::kCrashed, std::string("the child ") + fault.what());
    } catch (const Malformed& fault) {
      batch = {{}, {}, watermark_, watermark_};
      child_->kill();
      fail(Stop::kCrashed, std::string("the child broke the protocol: ") + fault.what());
    }
    waited_s_ += std::chrono::duration<double>(ChildChannel::Clock::now() - begun).count();
    return stop_;
  }

  void drive(PinId pin, bool level, Tick at) override {
    if (at <= (asked_.empty() ? watermark_ : asked_.back()) || at < last_drive_) {
      throw std::invalid_argument(
          "drive() must be after the watermark, and what was foreseen, in order of tick");
    }
    last_drive_ = at;
    Request(outgoing_, KB_PS_DRIVE)
        .put(at)
        .put(pin.port)
        .put(pin.bit)
        .put(static_cast<std::uint8_t>(level ? 1 : 0));
  }

  void foresee(Tick step, Tick until) override {
    step_ = step;
    foreseen_ = until;
  }

  void uartWrite(std::span<const std::uint8_t> bytes) override {
    if (!asked_.empty()) throw std::invalid_argument("bytes for a time that was foreseen without them");
    while (!bytes.empty()) {
      const auto part = bytes.first(std::min(bytes.size(), kMaxUartBlock));
      Request(outgoing_, KB_PS_UART).bytes(part);
      bytes = bytes.subspan(part.size());
    }
  }

  [[nodiscard]] std::string message() const override { return message_; }

 private:
  /// Asks for a quantum that has not been asked for, and for those that are foreseen behind it. False: the
  /// child takes nothing. One that has gone may still have said why.
  bool ask(Tick until, ChildChannel::Clock::time_point deadline) {
    if (asked_.empty()) askFor(until);
    if (asked_.front() != until) throw std::invalid_argument("advance() is not as it was foreseen");
    if (step_ > 0 && asked_.size() <= kMostAhead / 2) {
      while (asked_.size() < kMostAhead && asked_.back() + step_ <= foreseen_) askFor(asked_.back() + step_);
    }
    if (outgoing_.empty()) return true;
    const auto sent = child_->write(outgoing_, deadline);
    outgoing_.clear();
    return sent != ChildChannel::Io::kTimedOut;
  }

  void askFor(Tick until) {
    Request(outgoing_, KB_PS_ADVANCE).put(until);
    asked_.push_back(until);
  }

  void open() {
    {
      Request request(outgoing_, KB_PS_OPEN);
      request.put(std::uint32_t{KB_PS_VERSION}).put(options_.clock_hz).put(options_.baud);
      request.put(options_.max_events_per_quantum).text(options_.mcu);
      request.text(std::filesystem::absolute(options_.image).string());
      if (!options_.eeprom.empty()) request.text(options_.eeprom);
    }
    const auto deadline = quantumDeadline();
    const auto where = options_.child.string() + ": ";
    std::vector<std::uint8_t> payload;
    std::uint8_t type = 0;
    try {
      if (child_->write(std::exchange(outgoing_, {}), deadline) == ChildChannel::Io::kTimedOut ||
          !readReply(*child_, type, payload, deadline)) {
        child_->kill();
        (void)child_->finish(kFarewell);
        throw std::runtime_error(where + "gave no answer within its wall-clock guard");
      }
      Reply reply(payload);
      if (type == KB_PS_ERROR) {
        const auto text = reply.words();
        (void)child_->finish(kFarewell);
        throw std::runtime_error(text);
      }
      if (type != KB_PS_HELLO) throw Malformed("the first reply is neither HELLO nor ERROR");
      const auto version = reply.take<std::uint32_t>();
      if (version != KB_PS_VERSION) throw Malformed("speaks protocol version " + std::to_string(version));
      info_.rate.num = reply.take<std::uint64_t>();
      info_.rate.den = reply.take<std::uint64_t>();
      info_.stamp_err_ticks = reply.take<std::uint32_t>();
      info_.config_id = reply.words() + "; image sha256 " + base::sha256File(options_.image);
      if (options_.eeprom == kBlankEeprom) info_.config_id += "; EEPROM blank";
      if (!options_.eeprom.empty() && options_.eeprom != kBlankEeprom)
        info_.config_id += "; EEPROM sha256 " + base::sha256File(options_.eeprom);
      reply.finish();
      if (info_.rate.num == 0 || info_.rate.den == 0) throw Malformed("declares a tick rate of zero");
    } catch (const Malformed& fault) {
      throw std::runtime_error(where + fault.what());
    }
    info_.deterministic = true;
    info_.accepts_input = true;
    info_.process = child_->id();
  }

  [[nodiscard]] ChildChannel::Clock::time_point quantumDeadline() const {
    const double patience_s = options_.patience_s + options_.patience_per_s * seconds(watermark_);
    return in(std::clamp(patience_s - waited_s_, 0.0, options_.hang_guard_s));
  }

  [[nodiscard]] double seconds(Tick tick) const {
    return info_.rate.den == 0 ? 0.0 : info_.rate.seconds(tick);
  }

  /// Stops a child whose UART sends more than any line could carry.
  bool floodsUart(std::size_t bytes, Tick watermark) {
    uart_bytes_ += bytes;
    const double most = static_cast<double>(kUartBurst) + kUartBytesPerS * seconds(watermark);
    if (static_cast<double>(uart_bytes_) <= most) return false;
    child_->kill();
    (void)child_->finish(kFarewell);
    fail(Stop::kFlooded, "its UART has sent more than 1.25 MB a second");
    return true;
  }

  void readBatch(Tick until, Batch& batch, ChildChannel::Clock::time_point deadline) {
    std::uint8_t type = 0;
    if (!readReply(*child_, type, payload_, deadline)) {
      (void)hung();
      return;
    }
    if (type == KB_PS_ERROR) throw Malformed(Reply(payload_).words());
    if (type != KB_PS_BATCH) throw Malformed("unknown reply " + std::to_string(type));
    Reply reply(payload_);
    const Stop stop = stopFrom(reply.take<std::uint8_t>());
    const auto watermark = reply.take<Tick>();
    if (watermark > until || watermark < watermark_ || (stop == Stop::kReached && watermark != until)) {
      throw Malformed("watermark " + std::to_string(watermark) + " is not where the run was to end");
    }
    const std::size_t count = reply.take<std::uint32_t>();
    if (count > options_.max_events_per_quantum) throw Malformed("more events than allowed");
    Reply events(reply.block(count * kEventBytes));
    batch.events.reserve(count);
    Tick last = watermark_ + 1;
    for (std::size_t i = 0; i < count; ++i) {
      PinEvent event;
      event.tick = events.take<Tick>();
      event.port = events.take<std::uint16_t>();
      event.changed = events.take<std::uint16_t>();
      event.level = events.take<std::uint16_t>();
      event.flags = events.take<std::uint16_t>();
      if (event.tick < last || event.tick > watermark)
        throw Malformed("the ticks of its events do not ascend");
      last = event.tick;
      if (event.port >= pins_.size()) pins_.resize(event.port + std::size_t{1});
      auto& [level, changed_at, changed] = pins_[event.port];
      if ((event.flags & PinEvent::kGap) == 0 && (level ^ event.changed) != event.level) {
        throw Malformed("an event's levels contradict the one before it");
      }
      if (event.tick != changed_at) changed = 0;
      if ((changed & event.changed) != 0) {
        throw Malformed("a pin changes twice at tick " + std::to_string(event.tick));
      }
      changed_at = event.tick;
      changed = static_cast<std::uint16_t>(changed | event.changed);
      level = event.level;
      batch.events.push_back(event);
    }
    const auto uart = reply.block(reply.take<std::uint32_t>());
    batch.uart.assign(uart.begin(), uart.end());
    const auto text = reply.words();
    reply.finish();
    if (floodsUart(uart.size(), watermark)) {
      batch = {{}, {}, watermark_, watermark_};
      return;
    }
    batch.watermark = batch.uart_received = watermark_ = watermark;
    if (stop != Stop::kReached) {
      (void)child_->finish(kFarewell);
      fail(stop, text);
    }
  }

  Stop hung() {
    child_->kill();
    (void)child_->finish(kFarewell);
    return fail(Stop::kHung, "the child did not answer within its wall-clock guard, and was given up");
  }

  Stop fail(Stop stop, std::string message) {
    asked_.clear();
    message_ = std::move(message);
    return stop_ = stop;
  }

  ChildSourceOptions options_;
  std::unique_ptr<ChildChannel> child_;
  SourceInfo info_;
  std::vector<std::uint8_t> outgoing_;
  std::vector<std::uint8_t> payload_;
  struct Port {
    std::uint16_t level{};
    Tick changed_at{};
    std::uint16_t changed{};  ///< At that tick.
  };
  std::vector<Port> pins_;
  std::deque<Tick> asked_;  ///< Ends of quanta that were asked for and not answered.
  Tick step_{};
  Tick foreseen_{};
  Tick watermark_{};
  Tick last_drive_{};
  std::uint64_t uart_bytes_{};  ///< All that its UART has sent.
  double waited_s_{};           ///< Wall time for its answers, in all.
  Stop stop_{Stop::kReached};
  std::string message_;
};

}  // namespace

std::string describeChild(const std::filesystem::path& child, const std::string& mcu) {
  const std::unique_ptr<ChildChannel> process = openChannel(child);
  std::vector<std::uint8_t> outgoing;
  Request(outgoing, KB_PS_DESCRIBE).text(mcu);
  std::uint8_t type = 0;
  std::vector<std::uint8_t> payload;
  const auto deadline = in(ChildSourceOptions{}.hang_guard_s);
  if (process->write(outgoing, deadline) == ChildChannel::Io::kTimedOut ||
      !readReply(*process, type, payload, deadline) || type != KB_PS_DESCRIPTION)
    throw std::runtime_error(child.string() + ": does not say what it emulates");
  Reply reply(payload);
  std::string text = reply.text();
  reply.finish();
  return text;
}

std::unique_ptr<SignalSource> openChild(const ChildSourceOptions& options) {
  return std::make_unique<ChildSource>(options);
}

}  // namespace kerfbench::source
