// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <random>
#include <vector>

#include "fake_machine.h"
#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/program/link.h"
#include "no_field.h"

namespace kerfbench::controller_test {

inline std::vector<std::uint8_t> config(double nominal_counts = 0.0, std::uint8_t on_ticks = 0,
                                        std::uint8_t off_ticks = 0, double most_counts = 0.0) {
  const auto put = [](std::vector<std::uint8_t>& to, double counts) {
    const auto value = static_cast<std::uint32_t>(counts * 65536.0 + 0.5);
    for (unsigned i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  };
  std::vector<std::uint8_t> bytes;
  bytes.reserve(KB_CONFIG_LEN);
  put(bytes, nominal_counts);
  for (const std::uint8_t byte : {on_ticks, off_ticks, std::uint8_t{0}}) bytes.push_back(byte);
  put(bytes, most_counts);
  bytes.resize(17);  // The high bytes of the delays, and drives without requirements, are 0.
  bytes.resize(27, KB_MAX_STEPS_PER_PERIOD);
  appendNoField(bytes);
  return bytes;
}

inline std::vector<std::uint8_t> frame(std::uint8_t type, std::uint8_t seq,
                                       std::vector<std::uint8_t> payload = {}) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(payload.size() + 6);  // GCC 12 sees a write out of bounds in a vector that grows here.
  for (const unsigned byte :
       {static_cast<unsigned>(KB_SYNC), static_cast<unsigned>(type), static_cast<unsigned>(seq)}) {
    bytes.push_back(static_cast<std::uint8_t>(byte));
  }
  bytes.push_back(static_cast<std::uint8_t>(payload.size()));
  for (const std::uint8_t byte : payload) bytes.push_back(byte);
  const std::uint16_t crc = fakeCrc(bytes.data() + 1, static_cast<int>(bytes.size()) - 1);
  bytes.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  bytes.push_back(static_cast<std::uint8_t>(crc >> 8));
  return bytes;
}

/// Host's side of the job check, independent of the link's.
class JobCheck {
 public:
  explicit JobCheck(const std::vector<std::uint8_t>& config) { add(config); }
  /// State of the controller's check.
  static JobCheck accepted() {
    JobCheck check({});
    fakeJobCheck(&check.a_, &check.b_);
    return check;
  }
  void add(const std::vector<std::uint8_t>& bytes) {
    for (const unsigned byte : bytes) {
      a_ = (a_ + byte) & 0xFFFFU;
      b_ = (b_ + a_) & 0xFFFFU;
    }
  }
  [[nodiscard]] std::vector<std::uint8_t> bytes() const {
    return {static_cast<std::uint8_t>(a_), static_cast<std::uint8_t>(a_ >> 8), static_cast<std::uint8_t>(b_),
            static_cast<std::uint8_t>(b_ >> 8)};
  }
  /// Frame KB_DATA with these program bytes, which count from now on.
  std::vector<std::uint8_t> data(std::uint8_t seq, std::vector<std::uint8_t> program) {
    add(program);
    for (const std::uint8_t byte : bytes()) program.push_back(byte);
    return frame(KB_DATA, seq, program);
  }

 private:
  unsigned a_{1}, b_{0};
};

/// Link and core with a line between them, and a record of the pins.
class Runner {
 public:
  Runner() {
    fakeReset();
    fake.context = this;
    fake.from_host = [](void* self, std::uint8_t* byte) {
      return static_cast<Runner*>(self)->takeByte(byte);
    };
    fake.to_host = [](void* self, std::uint8_t byte) {
      auto* const runner = static_cast<Runner*>(self);
      runner->from_controller.push_back(byte);
      if (runner->listen) runner->listen(byte);
    };
  }

  void tick() {
    fakeTick();
    const fake_tick& t = fake.last;
    for (int axis = 0; axis < KB_AXES; ++axis) {
      const unsigned first = axis < 4 ? t.first_a : t.first_c;
      const unsigned low = axis < 4 ? t.low_a : t.low_c;
      const unsigned dir_next = axis < 4 ? t.dir_a : t.dir_c;
      const unsigned pul = axis < 4 ? 1U << (2 * axis) : 1U;
      const unsigned dir = pul << 1;
      // DIR must be the same at the edge, while PUL is high, and since the end of the tick before.
      dir_kept = dir_kept && (first & dir) == (dir_before[static_cast<std::size_t>(axis)] & dir) &&
                 (low & dir) == (first & dir);
      pulse_low = pulse_low && (low & pul) == 0;
      dir_before[static_cast<std::size_t>(axis)] = dir_next;
      if ((first & pul) != 0) {
        pulses[static_cast<std::size_t>(axis)] += (first & dir) != 0 ? 1 : -1;
        ++edges[static_cast<std::size_t>(axis)];
      }
    }
    const bool gate = (t.first_c & 4U) != 0;
    const bool pwm = (t.first_c & 8U) != 0;
    gate_ticks += gate ? 1 : 0;
    pwm_ticks += pwm ? 1 : 0;
    if (gate && !gate_before) gate_rises.push_back(fake.tick);
    if (!gate && gate_before) gate_falls.push_back(fake.tick);
    gate_before = gate;
  }

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }

  void write(const std::vector<std::uint8_t>& bytes) {
    to_controller.insert(to_controller.end(), bytes.begin(), bytes.end());
  }

  /// Answer to a frame within 10 ms.
  std::vector<std::uint8_t> ask(const std::vector<std::uint8_t>& bytes) {
    from_controller.clear();
    write(bytes);
    run(400 + static_cast<int>(bytes.size()) * 2);
    return from_controller;
  }

  /// Runs a program to its end or `max_s`, calling `each_tick` after every tick.
  void runProgram(planner::Link& link, double max_s, const std::function<void()>& each_tick = {}) {
    const auto ticks = static_cast<long>(max_s * 40000.0);
    for (long i = 0; i < ticks; ++i) {
      if (i % 8 == 0) {
        const std::vector<std::uint8_t> received = std::move(from_controller);
        from_controller.clear();
        write(link.step(received, static_cast<double>(fake.tick) / 40000.0));
        if (link.state() == planner::Link::State::kDone || link.state() == planner::Link::State::kFailed)
          return;
      }
      tick();
      if (each_tick) each_tick();
    }
  }

  std::deque<std::uint8_t> to_controller;
  std::vector<std::uint8_t> from_controller;
  std::function<void(std::uint8_t)> listen;  ///< Receives every byte of the controller.
  bool cut_line{false};                      ///< True if nothing of the host arrives but `babble`.
  std::deque<std::uint8_t> babble;           ///< Bytes that arrive although the line is cut.
  double loss{0.0};                          ///< Share of bytes to the controller that are lost or damaged.
  std::mt19937 random{7};
  std::array<long, KB_AXES> pulses{}, edges{};
  std::array<unsigned, KB_AXES> dir_before{};
  bool dir_kept{true}, pulse_low{true}, gate_before{false};
  long gate_ticks{}, pwm_ticks{};
  std::vector<std::uint64_t> gate_rises, gate_falls;

 private:
  bool takeByte(std::uint8_t* byte) {
    if (cut_line) to_controller.clear();
    if (cut_line && !babble.empty()) {
      *byte = babble.front();
      babble.clear();
      return true;
    }
    if (to_controller.empty()) return false;
    *byte = to_controller.front();
    to_controller.pop_front();
    if (loss > 0.0 && std::uniform_real_distribution<>(0.0, 1.0)(random) < loss) {
      *byte = static_cast<std::uint8_t>(random());
      return (random() & 1U) != 0;
    }
    return true;
  }
};

}  // namespace kerfbench::controller_test
