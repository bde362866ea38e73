// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hil/source/avr_core/tested_avr.h"

#include <avr_extint.h>
#include <avr_uart.h>
#include <sim_core.h>
#include <sim_io.h>

#include <cstdarg>
#include <cstring>
#include <sstream>
#include <stdexcept>

#ifdef KERFBENCH_SANITIZED
// simavr frees little of what it takes.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the name that the sanitizer gives it.
extern "C" const char* __lsan_default_suppressions() { return "leak:libsimavr\n"; }
#endif

namespace kerfbench::avr_child {
namespace {

void sayNothing(avr_t* /*avr*/, int /*level*/, const char* /*format*/, va_list /*arguments*/) {}

void makeUartsQuiet(const avr_t& avr) {
  for (avr_io_t* io = avr.io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "uart") == 0) reinterpret_cast<avr_uart_t*>(io)->flags = 0;
  }
}

unsigned sregOf(const avr_t& avr) {
  unsigned value = 0;
  for (unsigned bit = 0; bit < 8; ++bit) value |= std::uint32_t{avr.sreg[bit]} << bit;
  return value;
}

}  // namespace

TestedAvr::TestedAvr(const std::string& name, By by) : avr_(avr_make_mcu_by_name(name.c_str())), by_(by) {
  if (avr_ == nullptr) throw std::runtime_error("simavr has no " + name);
  avr_global_logger_set(sayNothing);
  avr_init(avr_);
  avr_->frequency = 16'000'000;
  avr_->gdb_port = 0;
  avr_->log = LOG_NONE;
  avr_->codeend = avr_->flashend;
  avr_->run_cycle_limit = 1;
  makeUartsQuiet(*avr_);
  for (std::uint8_t i = 0; i < EXTINT_COUNT; ++i) avr_extint_set_strict_lvl_trig(avr_, i, 0);
  boundMemories(*avr_);
  core_ = std::make_unique<Core>(avr_);
}

TestedAvr::~TestedAvr() { avr_terminate(avr_); }

void TestedAvr::put(std::uint32_t pc, const std::uint16_t* words, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    avr_->flash[pc + 2 * i] = static_cast<std::uint8_t>(words[i]);
    avr_->flash[pc + 2 * i + 1] = static_cast<std::uint8_t>(words[i] >> 8U);
  }
  core_->forgetCode(pc, static_cast<std::uint32_t>(2 * count));
}

void TestedAvr::setSreg(std::uint8_t value) {
  for (unsigned bit = 0; bit < 8; ++bit) avr_->sreg[bit] = value >> bit & 1U;
}

void TestedAvr::step() {
  if (by_ == By::kOurs) return core_->run(avr_->cycle);
  avr_->run_cycle_count = 1;
  avr_->pc = avr_run_one(avr_);
}

void TestedAvr::serve() {
  while (avr_->cycle_timers.timer != nullptr && avr_->cycle_timers.timer->when <= avr_->cycle)
    avr_cycle_timer_process(avr_);
  if (service_due_ && avr_->interrupt_state != 0) avr_service_interrupts(avr_);
}

void TestedAvr::advance(Cycle limit) {
  serve();
  if (by_ == By::kOurs) {
    core_->run(limit);
  } else {
    step();
  }
  service_due_ = true;
}

std::string difference(const TestedAvr& ours, const TestedAvr& theirs) {
  const avr_t& a = ours.avr();
  const avr_t& b = theirs.avr();
  std::ostringstream text;
  text << std::hex;
  const auto compare = [&](const char* name, std::uint64_t one, std::uint64_t other) {
    if (one != other) text << name << " " << one << " and simavr " << other << "\n";
  };
  compare("PC", a.pc, b.pc);
  compare("cycle", a.cycle, b.cycle);
  compare("SREG", sregOf(a), sregOf(b));
  compare("state", static_cast<unsigned>(a.state), static_cast<unsigned>(b.state));
  compare("interrupts", static_cast<unsigned>(a.interrupt_state), static_cast<unsigned>(b.interrupt_state));
  const auto* const timer = a.cycle_timers.timer;
  const auto* const other_timer = b.cycle_timers.timer;
  compare("timer", timer == nullptr ? 0 : timer->when, other_timer == nullptr ? 0 : other_timer->when);
  if (std::memcmp(a.data, b.data, a.ramend + 1U) != 0) {
    std::uint32_t address = 0;
    while (a.data[address] == b.data[address]) ++address;
    text << "at " << address << ": " << int{a.data[address]} << " and simavr " << int{b.data[address]}
         << "\n";
  }
  return text.str();
}

}  // namespace kerfbench::avr_child
