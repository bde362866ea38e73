// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <utility>

#include "hil/base/digest.h"
#include "hil/source/open.h"
#include "hil/source/vcd.h"

namespace kerfbench::source {
namespace {

class RecordingSource final : public SignalSource {
 public:
  RecordingSource(PinRecording recording, std::string config_id) : recording_(std::move(recording)) {
    info_.rate = recording_.rate;
    info_.stamp_err_ticks = recording_.stamp_err_ticks;
    info_.deterministic = true;
    info_.accepts_input = false;
    info_.config_id = std::move(config_id);
  }

  [[nodiscard]] SourceInfo info() const override { return info_; }

  Stop advance(Tick until, Batch& batch) override {
    batch.events.clear();
    batch.uart.clear();
    if (until <= watermark_ && !ended_) throw std::invalid_argument("advance() must go forward");
    for (; next_ != recording_.outputs.end() && next_->tick <= until; ++next_) batch.events.push_back(*next_);
    ended_ = ended_ || until >= recording_.end;
    watermark_ = ended_ ? recording_.end : until;
    batch.watermark = batch.uart_received = watermark_;
    return ended_ ? Stop::kEnded : Stop::kReached;
  }

  void drive(PinId /*pin*/, bool /*level*/, Tick /*at*/) override {}
  void uartWrite(std::span<const std::uint8_t> /*bytes*/) override {}
  [[nodiscard]] std::string message() const override { return ended_ ? "the recording is at its end" : ""; }

 private:
  PinRecording recording_;
  SourceInfo info_;
  PinEvents::Iterator next_{recording_.outputs.begin()};
  Tick watermark_{};
  bool ended_{};
};

}  // namespace

std::unique_ptr<SignalSource> openVcd(const std::filesystem::path& path, const SignalMap& map) {
  return openRecording(readVcd(path, map), "recording sha256 " + base::sha256File(path));
}

std::unique_ptr<SignalSource> openRecording(PinRecording recording, std::string config_id) {
  return std::make_unique<RecordingSource>(std::move(recording), std::move(config_id));
}

}  // namespace kerfbench::source
