// SPDX-License-Identifier: Apache-2.0
#include "tests/scenarios/released_pins.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include "hil/machine_file/machine_file.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {

namespace fs = std::filesystem;

ReleasedPins::ReleasedPins(const fs::path& folder, const std::string& name, const std::string& planner)
    : folder_(folder),
      name_(name),
      planner_(planner),
      map_(machine_file::readMachine(fixture("machines/two-mirror-slow.yaml")).signals) {
  fs::create_directories(folder);
  const ProgramRun run = kerfbench(fmt::format("run '{}' --twin fast -q --no-pictures --results-dir '{}'",
                                               scenario("{source: native}").string(), folder.string()));
  const fs::path vcd = folder / (name + "-pins") / "latest" / "pins.vcd";
  if (!fs::exists(vcd)) throw std::runtime_error(run.output);
  recording_ = source::readVcd(vcd, map_);
}

const std::vector<Signal>& ReleasedPins::wired() {
  static const std::vector<Signal> signals{Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kGalvoYPul,
                                           Signal::kGalvoYDir, Signal::kLaserGate, Signal::kLaserPwm};
  return signals;
}

fs::path ReleasedPins::scenario(const std::string& firmware) const {
  const fs::path path = folder_ / (name_ + ".yaml");
  std::ofstream(path) << fmt::format(
      "extends: {}\nname: {}-pins\nselect: {{entities: 0-4}}\nplanner: {}\nfirmware: {}\n",
      fixture("scenarios/native/button.yaml").string(), name_, planner_, firmware);
  return path;
}

std::shared_ptr<source::ScriptedKernel> ReleasedPins::kernel(std::uint32_t merged) const {
  // The first edge comes long after the lines are requested.
  constexpr std::uint64_t kFirst_ns = source::ScriptedKernel::kStart_ns + 500'000'000;
  auto kernel = std::make_shared<source::ScriptedKernel>();
  std::array<std::uint32_t, 8> line_seqno{};
  std::uint32_t seqno = 0;
  std::uint64_t levels = 0;
  const Tick first = recording_.outputs.front().tick;
  for (const PinEvent& event : recording_.outputs) {
    const auto stamp_ns = kFirst_ns + static_cast<std::uint64_t>(
                                          std::llround(1e9 * recording_.rate.seconds(event.tick - first)));
    for (std::uint32_t line = 0; line < wired().size(); ++line) {
      const PinId pin = *map_.pin(wired()[line]);
      if (pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
      const bool high = (event.level >> pin.bit & 1U) != 0;
      levels = high ? levels | 1U << line : levels & ~(std::uint64_t{1} << line);
      ++seqno;
      // The edge was counted in the interrupt, but the line's thread never saw it.
      if (seqno == merged) continue;
      kernel->edge(stamp_ns, line, high, seqno, ++line_seqno.at(line), stamp_ns);
    }
  }
  // The levels at the start are read before the first wait.
  kernel->before_poll = [levels, raw = kernel.get()](std::uint64_t) { raw->level_bits = levels; };
  return kernel;
}

std::vector<source::LevelRun> ReleasedPins::sampled(std::uint64_t samplerate_hz) const {
  std::vector<source::LevelRun> runs;
  const Tick first = recording_.outputs.front().tick;
  std::uint64_t done = 0;
  std::uint32_t levels = 0;
  const auto until = [&](std::uint64_t sample) {
    if (sample > done) runs.push_back({sample - done, levels});
    done = std::max(done, sample);
  };
  for (const PinEvent& event : recording_.outputs) {
    // The change shows in the first sample that is not before the edge.
    const double time_s = 0.5 + recording_.rate.seconds(event.tick - first);
    until(static_cast<std::uint64_t>(std::ceil(time_s * static_cast<double>(samplerate_hz))));
    for (std::uint32_t line = 0; line < wired().size(); ++line) {
      const PinId pin = *map_.pin(wired()[line]);
      if (pin.port != event.port || (event.changed >> pin.bit & 1U) == 0) continue;
      const std::uint32_t mask = 1U << line;
      levels = (event.level >> pin.bit & 1U) != 0 ? levels | mask : levels & ~mask;
    }
  }
  until(done + 1);
  until(done + 5 * samplerate_hz);
  return runs;
}

}  // namespace kerfbench::test
