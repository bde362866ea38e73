// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/benchmarks/simavr_runner.h"

#include <avr_extint.h>
#include <avr_uart.h>
#include <sim_avr.h>
#include <sim_io.h>
#include <time.h>

#include <cstdarg>
#include <cstring>
#include <memory>

#include "hil/source/emulator/image_file.h"
#include "hil/source/emulator/intel_hex.h"

namespace kerfbench {
namespace {

constexpr double kSpan_s = 0.1;

void sayNothing(avr_t* /*avr*/, int /*level*/, const char* /*format*/, va_list /*arguments*/) {}
void doNotSleep(avr_t* /*avr*/, avr_cycle_count_t /*cycles*/) {}

double threadTime_s() {
  timespec time{};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void tune(avr_t& avr) {
  avr.run_cycle_limit = 16'000;
  for (std::uint8_t i = 0; i < EXTINT_COUNT; ++i) avr_extint_set_strict_lvl_trig(&avr, i, 0);
  for (avr_io_t* io = avr.io_port; io != nullptr; io = io->next) {
    if (std::strcmp(io->kind, "uart") == 0) reinterpret_cast<avr_uart_t*>(io)->flags = 0;
  }
}

using Controller = std::unique_ptr<avr_t, void (*)(avr_t*)>;

Controller loaded(const SimavrRun& subject) {
  avr_global_logger_set(sayNothing);
  Controller avr(avr_make_mcu_by_name(subject.mcu.c_str()), avr_terminate);
  if (avr == nullptr) return avr;
  avr_init(avr.get());
  avr->frequency = subject.clock_hz;
  avr->sleep = doNotSleep;
  if (subject.is_tuned) tune(*avr);
  avr->codeend = avr->flashend;
  const std::string text = emulator::imageContent(subject.image.string());
  emulator::readIntelHex(text, subject.image.string(),
                         [&avr](std::uint64_t address, auto bytes, const auto&) {
                           if (address + bytes.size() <= avr->flashend)
                             std::memcpy(avr->flash + address, bytes.data(), bytes.size());
                         });
  return avr;
}

}  // namespace

void runSimavr(benchmark::State& state, const SimavrRun& subject) {
  if (!std::filesystem::exists(subject.image)) {
    state.SkipWithError("image was not built");
    return;
  }
  const Controller avr = loaded(subject);
  if (avr == nullptr) {
    state.SkipWithError("simavr has no such controller");
    return;
  }
  const auto span = static_cast<avr_cycle_count_t>(kSpan_s * subject.clock_hz);
  avr_cycle_count_t until = 0;
  const double spent_before_s = threadTime_s();
  for (auto step : state) {
    (void)step;
    until += span;
    while (avr->cycle < until) {
      const int now = avr_run(avr.get());
      if (now == cpu_Done || now == cpu_Crashed) {
        state.SkipWithError("the firmware ended");
        return;
      }
    }
  }
  const double spent_s = threadTime_s() - spent_before_s;
  state.counters["times_the_silicon"] =
      benchmark::Counter(kSpan_s, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["times_by_processor_time"] = static_cast<double>(until) / subject.clock_hz / spent_s;
}

}  // namespace kerfbench
