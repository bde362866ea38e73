// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "hil/source/analyser/sr_file.h"
#include "hil/source/vcd.h"
#include "tests/fuzz/targets.h"
#include "twin/base/signal_map.h"

namespace kerfbench::fuzz {
namespace {

const SignalMap& wires() {
  static const SignalMap kWires = [] {
    SignalMap map;
    map.assign(Signal::kGalvoXPul, {0, 0});
    map.assign(Signal::kGalvoXDir, {0, 1});
    map.assign(Signal::kGalvoYPul, {0, 2});
    map.assign(Signal::kLaserGate, {2, 2});
    map.assign(Signal::kEncoderA, {3, 2});
    map.assign(Signal::kPrintMark, {3, 3});
    return map;
  }();
  return kWires;
}

}  // namespace

bool recordingVcd(Bytes bytes) {
  return takes<std::runtime_error>([&] {
    const auto file = asFile("pins.vcd", bytes);
    (void)source::vcdSum(file);
    (void)source::readVcd(file, wires());
  });
}

bool recordingSr(Bytes bytes) {
  return takes<std::runtime_error>([&] { (void)source::readSr(asFile("pins.sr", bytes), wires(), {}); });
}

}  // namespace kerfbench::fuzz
