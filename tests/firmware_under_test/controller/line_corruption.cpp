// SPDX-License-Identifier: Apache-2.0
// Disturbed UART: host half and controller core with a bad line between, tick by tick, as many times as
// requested. Either the job comes out of the pins exactly as without corruption, or the laser goes off where
// the pins begin to differ, stays off, and the axes come to rest.
//
//     line_corruption [CASES [FIRST_SEED]]      exit code 0: no case was harmful
//     line_corruption 1 SEED                    prints that one case in full
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

#include "bad_line.h"
#include "runner.h"

namespace kerfbench::controller_test {
namespace {

using planner::Link;
using planner::Program;

constexpr int kQuietTicks = 12000;       // 0.3 s: longer than the host may be silent
constexpr long kMostTicks = 40000L * 6;  // 6 s
constexpr int kRampTicks = 8 * KB_TICKS_PER_PERIOD;
constexpr int kLinkTicks = 20;  // 0.5 ms

/// Program of marks and jumps, all axes, longer than the queue, so that part of it is sent while it runs.
Program jobProgram() {
  std::mt19937 random(11);
  Program program;
  program.config = config(0.0, 5, 5);
  for (int i = 0; i < 1100; ++i) {
    const bool lit = i / 12 % 3 != 2;
    std::vector<std::uint8_t> op{static_cast<std::uint8_t>(KB_OP_MOVE | 0x1F | (lit ? KB_OP_POWER : 0))};
    for (int axis = 0; axis < KB_AXES; ++axis) {
      op.push_back(static_cast<std::uint8_t>(static_cast<std::int8_t>(static_cast<int>(random() % 63) - 31)));
    }
    if (lit) op.push_back(static_cast<std::uint8_t>(64 + random() % 191));
    program.ops.push_back(op);
  }
  program.ops.push_back({KB_OP_END});
  return program;
}

struct Outcome {
  std::vector<std::uint16_t> trace;  ///< Each tick from the first with activity in it to the last.
  Link::State link{};
  std::string message;
  bool at_rest{};
  std::array<std::size_t, 2> bytes{};  ///< Number of bytes to the controller, and from it.
  int check_refusals{};                ///< Number of KB_NAK_CHECK: frames that the CRC accepted.
};

constexpr std::uint16_t kGate = 1U << 10;

/// Code of a tick: steps with their sense, gate, PWM.
std::uint16_t codeOf(const fake_tick& tick) {
  unsigned code = 0;
  for (unsigned axis = 0; axis < KB_AXES; ++axis) {
    const unsigned port = axis < 4 ? tick.first_a : tick.first_c;
    const unsigned pair = port >> (axis < 4 ? 2 * axis : 0) & 3U;
    if ((pair & 1U) != 0) code |= pair << (2 * axis);
  }
  if ((tick.first_c & 4U) != 0) code |= kGate;
  if ((tick.first_c & 8U) != 0) code |= kGate << 1;
  return static_cast<std::uint16_t>(code);
}

class CheckRefusals {
 public:
  void hear(std::uint8_t byte) {
    last_.push_back(byte);
    if (last_.size() > 7) last_.erase(last_.begin());
    if (last_.size() == 7 && last_ == frame(KB_NAK, last_[2], {KB_NAK_CHECK})) ++count;
  }
  int count{};

 private:
  std::vector<std::uint8_t> last_;
};

Outcome run(const Program& program, BadLine to_controller, BadLine to_host) {
  Runner runner;
  Link link(program);
  Outcome outcome;
  CheckRefusals refusals;
  runner.listen = [&](std::uint8_t byte) {
    refusals.hear(byte);
    to_host.put(byte, fake.tick);
  };
  std::size_t alive = 0;  // Length of the trace up to the last tick with activity in it.
  int quiet = 0;
  for (long tick = 0; tick < kMostTicks && quiet < kQuietTicks; ++tick) {
    const bool host_lives = link.state() != Link::State::kDone && link.state() != Link::State::kFailed;
    if (host_lives && tick % kLinkTicks == 0) {
      for (const std::uint8_t byte :
           link.step(to_host.take(fake.tick), static_cast<double>(tick) / 40000.0)) {
        to_controller.put(byte, fake.tick);
      }
    }
    runner.write(to_controller.take(fake.tick));
    runner.tick();
    const std::uint16_t code = codeOf(fake.last);
    if (code != 0 || !outcome.trace.empty()) outcome.trace.push_back(code);
    if (code != 0) alive = outcome.trace.size();
    quiet = code != 0 || host_lives ? 0 : quiet + 1;
  }
  outcome.trace.resize(alive);
  outcome.at_rest = quiet >= kQuietTicks;
  outcome.link = link.state();
  outcome.message = link.message();
  outcome.bytes = {to_controller.bytesIn(), to_host.bytesIn()};
  outcome.check_refusals = refusals.count;
  return outcome;
}

/// Judgement: empty, or what is wrong. `harmed`: the job was stopped.
std::string judge(const Outcome& wanted, const Outcome& seen, bool& harmed) {
  harmed = seen.trace != wanted.trace;
  if (!seen.at_rest) return "it does not come to rest";
  if (!harmed) return {};
  const auto differs =
      std::mismatch(seen.trace.begin(), seen.trace.end(), wanted.trace.begin(), wanted.trace.end()).first;
  const auto first = differs - seen.trace.begin();
  if (std::any_of(differs, seen.trace.end(), [](std::uint16_t code) { return (code & kGate) != 0; })) {
    return "the laser is on after the job differs, " + std::to_string(first) + " ticks from its start";
  }
  if (seen.trace.end() - differs > kRampTicks) return "the axes go on after the laser is off";
  if (seen.link == Link::State::kDone) return "the host takes it for done";
  return {};
}

std::vector<Corruption> drawCorruptions(std::mt19937& random, std::size_t bytes) {
  std::vector<Corruption> events;
  const std::size_t count = 1 + random() % 4;
  for (std::size_t i = 0; i < count; ++i) {
    Corruption event;
    event.kind = static_cast<Corruption::Kind>(random() % Corruption::kKinds);
    event.at_byte = random() % bytes;
    event.length = 1 + random() % 8;
    if (event.kind == Corruption::Kind::kRepeat && random() % 4 == 0) event.length = 134;
    if (event.kind == Corruption::Kind::kDrop && random() % 8 == 0) event.length = 200 + random() % 2000;
    if (event.kind == Corruption::Kind::kReplay) event.length = 6 + random() % 300;
    event.delay = 40 * (1 + random() % 400);  // up to 0.4 s
    event.share = 0.0005 * static_cast<double>(1 + random() % 100);
    events.push_back(event);
  }
  std::ranges::sort(events, {}, &Corruption::at_byte);
  return events;
}

void tell(const char* direction, const std::vector<Corruption>& events) {
  for (const Corruption& event : events) {
    std::printf("  %s: %s at byte %zu, length %zu, %llu ticks, share %.4f\n", direction,
                std::string(kindName(event.kind)).c_str(), event.at_byte, event.length,
                static_cast<unsigned long long>(event.delay), event.share);
  }
}

int runCases(unsigned cases, unsigned first_seed) {
  const Program program = jobProgram();
  const Outcome wanted = run(program, BadLine({}, 0), BadLine({}, 0));
  if (wanted.link != Link::State::kDone || !wanted.at_rest) {
    std::printf("without corruption: %s\n", wanted.message.c_str());
    return 1;
  }
  std::map<std::string, unsigned> stops;
  unsigned unharmed = 0, harmful = 0, not_begun = 0, untold = 0, check_refusals = 0, check_cases = 0;
  for (unsigned seed = first_seed; seed < first_seed + cases; ++seed) {
    std::mt19937 random(seed);
    const auto direction = random() % 3;  // 0: both
    const auto there = direction == 2 ? std::vector<Corruption>{} : drawCorruptions(random, wanted.bytes[0]);
    const auto back = direction == 1 ? std::vector<Corruption>{} : drawCorruptions(random, wanted.bytes[1]);
    const Outcome seen = run(program, BadLine(there, seed), BadLine(back, ~seed));
    bool harmed = false;
    const std::string fault = judge(wanted, seen, harmed);
    check_refusals += static_cast<unsigned>(seen.check_refusals);
    check_cases += seen.check_refusals > 0 ? 1 : 0;
    if (!fault.empty()) ++harmful;
    if (!harmed) {
      ++unharmed;
      if (seen.link != Link::State::kDone) ++untold;
    } else {
      ++stops[seen.message];
      not_begun += seen.trace.empty() ? 1 : 0;
    }
    if (!fault.empty() || cases == 1) {
      std::printf("seed %u: %s; %s; host: %s\n", seed, fault.empty() ? "good" : ("HARM: " + fault).c_str(),
                  harmed ? "stopped" : "unharmed", seen.message.c_str());
      tell("to the controller", there);
      tell("to the host", back);
    }
  }
  std::printf(
      "%u cases: %u unharmed (%u of them given up by the host), %u stopped (%u before they began), %u "
      "harmful\n",
      cases, unharmed, untold, cases - unharmed, not_begun, harmful);
  std::printf("frames that only the job check refused: %u, in %u cases\n", check_refusals, check_cases);
  for (const auto& [why, count] : stops) std::printf("  %6u  %s\n", count, why.c_str());
  return harmful == 0 ? 0 : 1;
}

}  // namespace
}  // namespace kerfbench::controller_test

int main(int argc, char** argv) {
  const auto number = [&](int i, unsigned fallback) {
    return argc > i ? static_cast<unsigned>(std::strtoul(argv[i], nullptr, 10)) : fallback;
  };
  return kerfbench::controller_test::runCases(number(1, 10000), number(2, 1));
}
