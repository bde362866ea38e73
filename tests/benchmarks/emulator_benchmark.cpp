// SPDX-License-Identifier: Apache-2.0
// Speed of the emulators as the bench runs them, each behind its pipe in quanta of half a millisecond: how
// many times as fast as the silicon, by the wall's clock and by the time that the processors spend on both
// sides of the pipe, which does not depend on what else they do. Rows "ahead" are jobs in which no input
// depends on an output (`dialog: none`, no sensor wired), rows "in_turns" all others. Beside the AVR's stands
// simavr by itself, without a pipe, as it comes and tuned.
#include <benchmark/benchmark.h>
#include <time.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>

#include "hil/base/one_processor.h"
#include "hil/source/open.h"
#include "tests/benchmarks/simavr_runner.h"
#include "tests/hil/source/mcs51/oracle.h"
#include "tests/hil/source/mcs51/program.h"

namespace kerfbench {
namespace {

namespace fs = std::filesystem;

const fs::path kBuild(KERFBENCH_BINARY_DIR);

struct Subject {
  const char* child;
  fs::path image;
  const char* mcu;
  std::uint64_t clock_hz;
  std::uint32_t baud;
  bool is_foreseen{};
};

/// Processor time of this thread and of the child.
class SpentTime {
 public:
  explicit SpentTime(pid_t child) {
    if (::clock_getcpuclockid(child, &child_) != 0) child_ = CLOCK_THREAD_CPUTIME_ID;
  }
  [[nodiscard]] double now_s() const { return seconds(CLOCK_THREAD_CPUTIME_ID) + seconds(child_); }

 private:
  static double seconds(clockid_t clock) {
    timespec time{};
    (void)::clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  clockid_t child_{};
};

void run(benchmark::State& state, const Subject& subject) {
  source::ChildSourceOptions options;
  options.child = kBuild / "bin" / subject.child;
  options.image = subject.image;
  options.mcu = subject.mcu;
  options.clock_hz = subject.clock_hz;
  options.baud = subject.baud;
  if (!fs::exists(options.child) || !fs::exists(options.image)) {
    state.SkipWithError("emulator or image was not built");
    return;
  }
  constexpr unsigned kQuanta = 200;
  constexpr double kQuantum_s = 0.5e-3;
  constexpr double kSpan_s = kQuanta * kQuantum_s;
  const std::unique_ptr<source::SignalSource> source = source::openChild(options);
  const Tick quantum = source->info().rate.ticksAt(kQuantum_s);
  base::OneProcessor together(source->info().process);  // As in a run.
  if (subject.is_foreseen) source->foresee(quantum, std::numeric_limits<Tick>::max());
  const SpentTime spent(source->info().process);
  source::Batch batch;
  Tick until = 0;
  const double spent_before_s = spent.now_s();
  for (auto step : state) {
    (void)step;
    for (unsigned i = 0; i < kQuanta; ++i) {
      until += quantum;
      together.turn();
      if (source->advance(until, batch) != source::Stop::kReached) {
        state.SkipWithError(source->message().c_str());
        return;
      }
    }
  }
  state.counters["times_the_silicon"] =
      benchmark::Counter(kSpan_s, benchmark::Counter::kIsIterationInvariantRate);
  const double spent_s =
      (spent.now_s() - spent_before_s) / (static_cast<double>(until) / static_cast<double>(quantum));
  state.counters["times_by_processor_time"] = kQuantum_s / spent_s;
  state.counters["us_a_quantum"] = 1e6 * spent_s;
}

/// Timer 0 makes a pulse of P1.0 in every 50 cycles, as fast as a controller of this kind can; meanwhile the
/// program adds numbers.
fs::path pulsesOf8051() {
  mcs51_child::Program p;
  p.ljmp(0x40).at(0x0B).setb(mcs51_child::kP1_0).nop(4).clr(mcs51_child::kP1_0).reti();
  p.at(0x40).mov(mcs51_child::kTmod, 0x02).mov(mcs51_child::kTl0, 206).mov(mcs51_child::kTh0, 206);
  p.mov(mcs51_child::kIe, 0x82).setb(mcs51_child::kTr0);
  const unsigned loop = p.here();
  p.put({0x28, 0x39, 0xF5, 0x30, 0x26}).djnzR(7, loop).sjmp(loop);
  const fs::path image = kBuild / "tests/benchmarks/pulses-8051.hex";
  std::ofstream(image) << mcs51_child::intelHex(p.code());
  return image;
}

void add(const char* name, const Subject& subject) {
  for (const bool is_foreseen : {false, true}) {
    Subject each = subject;
    each.is_foreseen = is_foreseen;
    benchmark::RegisterBenchmark((std::string(name) + (is_foreseen ? "/ahead" : "/in_turns")).c_str(),
                                 [each](benchmark::State& state) { run(state, each); })
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  }
}

void addSimavr(const char* name, const SimavrRun& subject) {
  benchmark::RegisterBenchmark(name, [subject](benchmark::State& state) { runSimavr(state, subject); })
      ->UseRealTime()
      ->Unit(benchmark::kMillisecond);
}

void addAll() {
  const fs::path firmware = kBuild / "firmware";
  const fs::path images = kBuild / "tests/hil/source/cortex_m/firmware";
  const fs::path pulses = pulsesOf8051();
  add("avr_controller_idle",
      {"kerfbench-avr", firmware / "controller-avr.hex", "atmega2560", 16'000'000, 250'000});
  for (const bool is_tuned : {false, true})
    addSimavr(is_tuned ? "avr_controller_idle/simavr_alone_tuned" : "avr_controller_idle/simavr_alone",
              {firmware / "controller-avr.hex", "atmega2560", 16'000'000, is_tuned});
  add("8051_12_clocks_pulses", {"kerfbench-mcs51", pulses, "at89s52", 12'000'000, 9600});
  add("8051_1_clock_pulses", {"kerfbench-mcs51", pulses, "stc15f2k60s2", 24'000'000, 125'000});
  add("8051_controller_idle",
      {"kerfbench-mcs51", firmware / "controller-mcs51.hex", "stc15w4k32s4", 24'000'000, 125'000});
  add("stm32_interrupt_100_kHz",
      {"kerfbench-cortex-m", images / "systick.elf", "stm32f103c8", 72'000'000, 250'000});
  add("stm32_controller_idle",
      {"kerfbench-cortex-m", firmware / "controller-stm32.hex", "stm32f103c8", 72'000'000, 250'000});
}

}  // namespace
}  // namespace kerfbench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  kerfbench::addAll();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
