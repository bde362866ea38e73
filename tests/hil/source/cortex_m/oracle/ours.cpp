// SPDX-License-Identifier: GPL-2.0-or-later
#include "hil/source/cortex_m_child/core.h"
#include "tests/hil/source/cortex_m/oracle/cores.h"

namespace kerfbench::cortex_m_child {
namespace {

class NoDevices final : public CoreBus {
 public:
  std::optional<std::uint32_t> readDevice(std::uint32_t /*address*/, unsigned /*bytes*/) override {
    return {};
  }
  bool writeDevice(std::uint32_t /*address*/, unsigned /*bytes*/, std::uint32_t /*value*/) override {
    return false;
  }
  bool writeFlash(std::uint32_t /*offset*/, unsigned /*bytes*/, std::uint32_t /*value*/) override {
    return false;
  }
};

class Ours final : public TestedCore {
 public:
  Ours(std::vector<std::uint8_t>& code, Cycle slice)
      : sram_(kDataBytes), core_(present_, bus_, code, sram_, {}), slice_(slice) {
    core_.setFlashTiming(2, true);
  }

  /// The instruction at `end` is a breakpoint.
  std::string run(std::uint32_t begin, std::uint32_t end, MachineState& state) override {
    sram_ = state.sram;
    core_.forgetCode(kDataBase, kDataBytes);
    for (unsigned i = 0; i < state.r.size(); ++i) core_.set(i, state.r[i]);
    core_.jump(begin);
    core_.setFlags(state.flags);
    const Cycle start = present_.cycle;
    constexpr Cycle kMost = 100'000;
    Stop stop = Stop::kLimit;
    while (stop == Stop::kLimit && present_.cycle < start + kMost) {
      core_.setLimit(slice_ == 0 ? start + kMost : present_.cycle + slice_);
      stop = core_.run();
    }
    state.cycles = present_.cycle - start;
    for (unsigned i = 0; i < state.r.size(); ++i) state.r[i] = core_.get(i);
    state.flags = core_.flags();
    state.sram = sram_;
    if (stop == Stop::kTrap && core_.pc() == end) return {};
    return "ours stops for reason " + std::to_string(static_cast<int>(stop)) + " at " + hex32(core_.pc());
  }

 private:
  Present present_;
  NoDevices bus_;
  std::vector<std::uint8_t> sram_;
  Core core_;
  Cycle slice_;
};

}  // namespace

std::unique_ptr<TestedCore> makeOurs(std::vector<std::uint8_t>& code, std::uint64_t slice) {
  return std::make_unique<Ours>(code, slice);
}

}  // namespace kerfbench::cortex_m_child
