// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <exception>
#include <limits>
#include <span>

#include "hil/source/analyser/sigrok_child/library.h"
#include "hil/source/analyser/sigrok_child/settings.h"
#include "hil/source/analyser/sigrok_child/sigrok.h"

namespace kerfbench::sigrok_child {
namespace {

sr_dev_inst* findDevice(Library& library, const AcquireRequest& request) {
  const std::vector<sr_dev_inst*> all = library.scan(library.driver(request.driver), request.conn);
  std::vector<sr_dev_inst*> fit = all;
  std::erase_if(fit, [&](sr_dev_inst* device) {
    return !request.serial.empty() && textOf(sr_dev_inst_sernum_get(device)) != request.serial;
  });
  if (fit.size() == 1) return fit.front();
  std::string words = fit.empty() ? "the driver " + request.driver + " finds no analyser"
                                  : "the driver " + request.driver + " finds more than one analyser";
  if (fit.empty() && !request.conn.empty()) words += " at " + request.conn;
  if (fit.empty() && !request.serial.empty()) words += " with the serial " + request.serial;
  words += fit.empty() ? (all.empty() ? ": is it plugged in, and is this user allowed to use it?" : ":")
                       : ", name one by conn or serial:";
  for (sr_dev_inst* const device : all) words += "\n  " + describe(device);
  for (const std::string& error : library.log().takeErrors()) words += "\n  " + error;
  throw SigrokError(words);
}

/// Channels that are not asked for are off: with some analysers that allows a higher rate.
std::vector<unsigned> chooseChannels(Library& library, sr_dev_inst* device, const AcquireRequest& request) {
  const auto logic = logicChannels(device);
  std::string faults;
  std::vector<unsigned> bits;
  std::vector<const sr_channel*> wanted;
  for (const std::string& name : request.channels) {
    const auto found =
        std::ranges::find_if(logic, [&](const sr_channel* channel) { return name == textOf(channel->name); });
    if (found == logic.end()) {
      faults += faults.empty() ? "it has no channel '" + name + "'" : ", '" + name + "'";
    } else {
      bits.push_back(static_cast<unsigned>((*found)->index));
      wanted.push_back(*found);
    }
  }
  if (!faults.empty()) {
    std::string words = describe(device) + ": " + faults + "; it has";
    for (const sr_channel* channel : logic) words += " " + textOf(channel->name);
    throw SigrokError(words);
  }
  for (sr_channel* const channel : elementsOf<sr_channel>(sr_dev_inst_channels_get(device))) {
    const bool on = std::ranges::find(wanted, channel) != wanted.end();
    if (const int code = sr_dev_channel_enable(channel, on ? TRUE : FALSE); code != SR_OK && on)
      throw SigrokError(describe(device) + ": channel " + textOf(channel->name) +
                        " cannot be used: " + library.why(code));
  }
  return bits;
}

void setRate(Library& library, sr_dev_inst* device, std::uint64_t rate_hz) {
  const auto refuse = [&](const std::string& why) {
    const std::string rates = ratesOf(device);
    throw SigrokError(describe(device) + ": does not sample at " + std::to_string(rate_hz) + " Hz: " + why +
                      (rates.empty() ? "" : "; it has " + rates));
  };
  const int code = sr_config_set(device, nullptr, SR_CONF_SAMPLERATE, g_variant_new_uint64(rate_hz));
  if (code != SR_OK) refuse(library.why(code));
  GVariant* raw = nullptr;
  if (sr_config_get(sr_dev_inst_driver_get(device), device, nullptr, SR_CONF_SAMPLERATE, &raw) != SR_OK)
    return;
  const Handle<GVariant> granted(raw);
  const std::uint64_t granted_hz = g_variant_get_uint64(granted.get());
  if (granted_hz != rate_hz) refuse("it grants " + std::to_string(granted_hz) + " Hz");
}

/// An analyser that does not stream takes as many samples as it is set to, and no more than its memory holds.
void setLimit(Library& library, sr_dev_inst* device, std::uint64_t limit) {
  if (sr_dev_has_option(device, SR_CONF_CONTINUOUS) == TRUE ||
      sr_dev_has_option(device, SR_CONF_LIMIT_SAMPLES) == FALSE)
    return;
  GVariant* raw = nullptr;
  std::uint64_t least = 0;
  std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  if (sr_config_list(sr_dev_inst_driver_get(device), device, nullptr, SR_CONF_LIMIT_SAMPLES, &raw) == SR_OK) {
    const Handle<GVariant> range(raw);
    if (g_variant_is_of_type(range.get(), G_VARIANT_TYPE("(tt)"))) {
      g_variant_get(range.get(), "(tt)", &least, &most);
    }
  }
  const std::uint64_t samples = std::max(least, std::min(limit, most));
  const int code = sr_config_set(device, nullptr, SR_CONF_LIMIT_SAMPLES, g_variant_new_uint64(samples));
  if (code != SR_OK)
    throw SigrokError(describe(device) + ": does not take " + std::to_string(samples) +
                      " samples: " + library.why(code));
}

std::string runBytes(std::span<const source::LevelRun> runs) {
  std::string bytes;
  bytes.reserve(runs.size() * source::analyser_stream::kRunBytes);
  for (const source::LevelRun& run : runs) {
    for (unsigned i = 0; i < 8; ++i) bytes += static_cast<char>(run.samples >> (8 * i));
    for (unsigned i = 0; i < 4; ++i) bytes += static_cast<char>(run.levels >> (8 * i));
  }
  return bytes;
}

/// What the session's packets come to. No exception may pass through libsigrok, so one is kept until it has
/// returned.
class Reception {
 public:
  Reception(sr_session* session, std::vector<unsigned> bits, const source::ListenFor& listen,
            const Sink& sink)
      : session_(session), packer_(std::move(bits)), listener_(listen), sink_(sink) {}

  static void receive(const sr_dev_inst* /*device*/, const sr_datafeed_packet* packet, void* self) {
    static_cast<Reception*>(self)->take(*packet);
  }
  [[nodiscard]] source::Listener::State state() const { return state_; }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void take(const sr_datafeed_packet& packet) {
    if (packet.type != SR_DF_LOGIC || failure_ || state_ != source::Listener::State::kListening) return;
    try {
      const auto& logic = *static_cast<const sr_datafeed_logic*>(packet.payload);
      std::vector<source::LevelRun> runs;
      packer_.add({static_cast<const std::uint8_t*>(logic.data), static_cast<std::size_t>(logic.length)},
                  logic.unitsize, runs);
      state_ = listener_.add(runs);
      sink_(Frame::kRuns, runBytes(runs));
    } catch (...) {
      failure_ = std::current_exception();
    }
    if (failure_ || state_ != source::Listener::State::kListening) sr_session_stop(session_);
  }

  sr_session* session_;
  source::SamplePacker packer_;
  source::Listener listener_;
  const Sink& sink_;
  source::Listener::State state_{source::Listener::State::kListening};
  std::exception_ptr failure_;
};

Handle<sr_session> sessionWith(Library& library, sr_dev_inst* device) {
  sr_session* raw = nullptr;
  int code = sr_session_new(library.context(), &raw);
  Handle<sr_session> session(code == SR_OK ? raw : nullptr);
  if (code == SR_OK) code = sr_session_dev_add(session.get(), device);
  if (code != SR_OK) throw SigrokError(describe(device) + ": cannot be read: " + library.why(code));
  return session;
}

char reasonOf(source::Listener::State state) {
  using Reason = source::analyser_stream::AnalyserReason;
  switch (state) {
    case source::Listener::State::kQuiet:
      return static_cast<char>(Reason::kQuiet);
    case source::Listener::State::kLimit:
      return static_cast<char>(Reason::kLimit);
    case source::Listener::State::kListening:
      break;
  }
  return static_cast<char>(Reason::kDevice);
}

}  // namespace

void acquire(const AcquireRequest& request, const Sink& sink) {
  Library library;
  sr_dev_inst* const device = findDevice(library, request);
  if (const int code = sr_dev_open(device); code != SR_OK)
    throw SigrokError(describe(device) + ": cannot be opened: " + library.why(code) +
                      "; is this user allowed to use it, and has no other program taken it?");
  const OpenDevice open(device);
  applySettings(library, device, request.settings);
  const std::vector<unsigned> bits = chooseChannels(library, device, request);
  setRate(library, device, request.samplerate_hz);
  setLimit(library, device, request.listen.limit_samples);
  const Handle<sr_session> session = sessionWith(library, device);
  Reception reception(session.get(), bits, request.listen, sink);
  sr_session_datafeed_callback_add(session.get(), &Reception::receive, &reception);
  std::vector<std::string> notes = library.log().takeWarnings();
  (void)library.log().takeErrors();  // Forgets what drivers said that tried something else first.
  // The first packets can come from within sr_session_start().
  sink(Frame::kStarted, describe(device));
  int code = sr_session_start(session.get());
  if (code == SR_OK) code = sr_session_run(session.get());
  reception.rethrow();
  const auto late = library.log().takeWarnings();
  notes.insert(notes.end(), late.begin(), late.end());
  for (const std::string& note : notes) sink(Frame::kNote, note);
  if (code != SR_OK) sink(Frame::kProblem, "the analyser cannot be read: " + library.why(code));
  for (const std::string& error : library.log().takeErrors())
    sink(Frame::kProblem, "the analyser's driver says: " + error);
  sink(Frame::kFinished, std::string(1, reasonOf(reception.state())));
}

}  // namespace kerfbench::sigrok_child
