// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sim_avr.h>

#include <cstdint>
#include <memory>
#include <string>

#include "hil/source/avr_child/core.h"

namespace kerfbench::avr_child {

/// A controller of simavr whose instructions are carried out by our core, or by simavr's own.
class TestedAvr {
 public:
  enum class By : std::uint8_t { kOurs, kSimavr };
  TestedAvr(const std::string& name, By by);
  ~TestedAvr();
  TestedAvr(const TestedAvr&) = delete;
  TestedAvr& operator=(const TestedAvr&) = delete;

  [[nodiscard]] avr_t& avr() const { return *avr_; }
  /// Words of a program, at an address in bytes.
  void put(std::uint32_t pc, const std::uint16_t* words, std::size_t count);
  void setSreg(std::uint8_t value);
  /// One instruction.
  void step();
  /// What is due, interrupts too, and then instructions up to a cycle or to what is due next; as a run of the
  /// child does.
  void advance(Cycle limit);

 private:
  void serve();

  avr_t* avr_;
  By by_;
  bool service_due_{};
  std::unique_ptr<Core> core_;
};

/// In words the first things in which two of them differ; nothing where they are alike.
std::string difference(const TestedAvr& ours, const TestedAvr& theirs);

}  // namespace kerfbench::avr_child
