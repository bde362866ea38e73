// SPDX-License-Identifier: GPL-3.0-or-later
#include "avr_harness_bench.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <tuple>

#include <avr_extint.h>
#include <avr_ioport.h>
#include <avr_uart.h>
#include <sim_hex.h>

namespace kerfbench::avr_bench {
namespace {

/// Interrupt request of a port's pin; simavr's macros make an int of the port.
avr_irq_t* pinOf(avr_t* avr, char port, int pin) {
  return avr_io_getirq(avr, static_cast<std::uint32_t>(AVR_IOCTL_IOPORT_GETIRQ(port)), pin);
}

}  // namespace

void driveInput(Bench& bench, char port, int bit, unsigned level) {
  avr_raise_irq(pinOf(bench.avr, port, bit), level);
}

namespace {

void onPort(Bench& bench, char port, unsigned pins) {
  const unsigned value = pins ^ (port == 'A' ? bench.invert_a : bench.invert_c);
  const std::uint64_t now = bench.avr->cycle;
  const unsigned changed = bench.levels[static_cast<unsigned char>(port)] ^ value;
  bench.levels[static_cast<unsigned char>(port)] = value;
  for (Axis& axis : bench.axes) {
    if (axis.port != port) continue;
    if ((changed >> axis.dir & 1U) != 0) {
      axis.dir_change = now;
      if (axis.rise != kNever) axis.min_hold = std::min(axis.min_hold, now - axis.rise);
    }
    if ((changed >> axis.pul & 1U) == 0) continue;
    if ((value >> axis.pul & 1U) != 0) {
      axis.rise = now;
      bench.min_head = std::min(bench.min_head, now - bench.tick().entry);
      ++axis.steps;
      axis.position += (value >> axis.dir & 1U) != 0 ? 1 : -1;
      if (axis.dir_change != kNever) axis.min_setup = std::min(axis.min_setup, now - axis.dir_change);
      if (axis.fall != kNever) axis.min_space = std::min(axis.min_space, now - axis.fall);
      if (bench.on_step != nullptr) bench.on_step(bench, static_cast<std::size_t>(&axis - bench.axes.data()));
    } else {
      axis.fall = now;
      axis.min_width = std::min(axis.min_width, now - axis.rise);
      axis.max_width = std::max(axis.max_width, now - axis.rise);
    }
  }
  if (port == 'C' && (changed & 4U) != 0) ((value & 4U) != 0 ? bench.gate_rise : bench.gate_fall) = now;
}

void onPortA(avr_irq_t*, std::uint32_t value, void* p) { onPort(*static_cast<Bench*>(p), 'A', value); }
void onPortC(avr_irq_t*, std::uint32_t value, void* p) { onPort(*static_cast<Bench*>(p), 'C', value); }
void onTx(avr_irq_t*, std::uint32_t value, void* p) {
  static_cast<Bench*>(p)->from_controller.push_back(static_cast<std::uint8_t>(value));
}
void onXon(avr_irq_t*, std::uint32_t, void* p) { static_cast<Bench*>(p)->xoff = false; }
void onXoff(avr_irq_t*, std::uint32_t value, void* p) {
  if (value != 0) static_cast<Bench*>(p)->xoff = true;
}
struct Watched {
  Bench* bench;
  Vector* vector;
};

void onAsked(avr_irq_t*, std::uint32_t value, void* p) {
  const auto& w = *static_cast<Watched*>(p);
  if (value != 0) w.vector->asked = w.bench->avr->cycle;
}

void onRunning(avr_irq_t*, std::uint32_t value, void* p) {
  const auto& w = *static_cast<Watched*>(p);
  Bench& bench = *w.bench;
  Vector& vector = *w.vector;
  const std::uint64_t now = bench.avr->cycle;
  if (value == 0) {
    if (&vector == &bench.tick()) {
      bench.tick_end = now;
      for (const Axis& axis : bench.axes) {
        if (axis.dir_change != kNever && axis.dir_change >= vector.entry)
          bench.min_tail = std::min(bench.min_tail, now - axis.dir_change);
      }
    }
    vector.longest = std::max(vector.longest, now - vector.entry);
    vector.sum += now - vector.entry;
    ++vector.count;
    return;
  }
  if (&vector == &bench.tick()) {
    if (bench.running && vector.entry != kNever) {
      bench.min_interval = std::min(bench.min_interval, now - vector.entry);
      bench.max_interval = std::max(bench.max_interval, now - vector.entry);
    }
    bench.first_tick = std::min(bench.first_tick, now);
    if (bench.tick_end != kNever) bench.min_gap = std::min(bench.min_gap, now - bench.tick_end);
    ++bench.ticks;
  }
  if (bench.running && vector.asked != kNever) vector.latest = std::max(vector.latest, now - vector.asked);
  vector.entry = now;
}

avr_cycle_count_t feedByte(avr_t*, avr_cycle_count_t when, void* p) {
  auto& bench = *static_cast<Bench*>(p);
  if (bench.xoff || bench.cut_line) return when + kByteCycles;
  // The wire is never at rest: bytes outside of frames begin none. Only the good release must bear it.
  if (bench.to_controller.empty() && !bench.busy_wire) return when + kByteCycles;
  std::uint8_t byte = 0;
  if (!bench.to_controller.empty()) {
    byte = bench.to_controller.front();
    bench.to_controller.pop_front();
  }
  avr_raise_irq(bench.rx, byte);
  ++bench.bytes;
  return when + kByteCycles;
}

avr_cycle_count_t turnEncoder(avr_t*, avr_cycle_count_t when, void* p) {
  auto& bench = *static_cast<Bench*>(p);
  if (bench.on_count != nullptr) bench.on_count(bench);
  bench.quadrature = (bench.quadrature + 1U) & 3U;  // A B: 10, 11, 01, 00
  driveInput(bench, 'D', 2, bench.quadrature == 1 || bench.quadrature == 2);
  driveInput(bench, 'D', 1, bench.quadrature == 2 || bench.quadrature == 3);
  return when + bench.encoder_period;
}

avr_cycle_count_t raiseMark(avr_t* avr, avr_cycle_count_t, void* p) {
  auto& bench = *static_cast<Bench*>(p);
  bench.mark_rise = avr->cycle;
  driveInput(bench, 'D', 3, 1);
  return 0;
}

void doNotSleep(avr_t*, avr_cycle_count_t) {}

/// Sets the surroundings of a controller that starts: the line, a closed guard, free limits.
void surround(Bench& bench) {
  for (std::uint8_t i = 0; i < 8; ++i) avr_extint_set_strict_lvl_trig(bench.avr, i, 0);
  avr_cycle_timer_register(bench.avr, kByteCycles, feedByte, &bench);
  driveInput(bench, 'L', 0, 0);
  driveInput(bench, 'L', 1, 0);
  driveInput(bench, 'L', 2, 1);
}

/// Runs as avr_run() does, with instructions of the bench's own core: these, what is due, interrupts.
void advance(Bench& bench, std::uint64_t cycle) {
  avr_t* const avr = bench.avr;
  if (avr->state != cpu_Running) {
    avr_run(avr);
    return;
  }
  bench.core->run(cycle);
  avr_cycle_timer_process(avr);
  if (avr->interrupt_state != 0) avr_service_interrupts(avr);
}

int failed = 0;

}  // namespace

void load(Bench& bench, const char* image) {
  bench.levels['A'] = bench.invert_a;
  bench.levels['C'] = bench.invert_c;
  bench.avr = avr_make_mcu_by_name("atmega2560");
  avr_t* const avr = bench.avr;
  avr_init(avr);
  avr->frequency = 16000000;
  avr->sleep = doNotSleep;
  avr->log = LOG_ERROR;
  std::uint32_t size = 0, base = 0;
  std::uint8_t* const bytes = read_ihex_file(image, &size, &base);
  if (bytes == nullptr) {
    std::fprintf(stderr, "cannot read %s\n", image);
    std::exit(66);
  }
  std::memcpy(avr->flash + base, bytes, size);
  std::free(bytes);
  avr->pc = base;
  avr->codeend = avr->flashend;
  std::uint32_t flags = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_GET_FLAGS('0'), &flags);
  flags &= ~static_cast<std::uint32_t>(AVR_UART_FLAG_STDIO | AVR_UART_FLAG_POLL_SLEEP);
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  const auto uart = [&](int i) {
    return avr_io_getirq(avr, static_cast<std::uint32_t>(AVR_IOCTL_UART_GETIRQ('0')), i);
  };
  bench.rx = uart(UART_IRQ_INPUT);
  avr_irq_register_notify(uart(UART_IRQ_OUTPUT), onTx, &bench);
  avr_irq_register_notify(uart(UART_IRQ_OUT_XON), onXon, &bench);
  avr_irq_register_notify(uart(UART_IRQ_OUT_XOFF), onXoff, &bench);
  const auto port = [&](char name) { return pinOf(avr, name, IOPORT_IRQ_REG_PORT); };
  avr_irq_register_notify(port('A'), onPortA, &bench);
  avr_irq_register_notify(port('C'), onPortC, &bench);
  for (std::size_t i = 0; i < bench.vectors.size(); ++i) {
    // The list serves one bench at a time.
    static std::array<Watched, std::tuple_size_v<decltype(Bench::vectors)>> watched;
    watched[i] = {&bench, &bench.vectors[i]};
    avr_irq_t* const irq = avr_get_interrupt_irq(avr, static_cast<std::uint8_t>(bench.vectors[i].number));
    avr_irq_register_notify(irq + AVR_INT_IRQ_PENDING, onAsked, &watched[i]);
    avr_irq_register_notify(irq + AVR_INT_IRQ_RUNNING, onRunning, &watched[i]);
  }
  surround(bench);
  bench.core = std::make_unique<avr_child::Core>(avr);
}

void unload(Bench& bench) {
  bench.core.reset();
  avr_terminate(bench.avr);
  bench.avr = nullptr;
}

void startBelt(Bench& bench, std::uint64_t cycle) {
  avr_cycle_timer_register(bench.avr, cycle, turnEncoder, &bench);
}

void raiseMarkAt(Bench& bench, std::uint64_t cycle) {
  avr_cycle_timer_register(bench.avr, cycle, raiseMark, &bench);
}

void runTo(Bench& bench, std::uint64_t cycle) {
  while (bench.avr->cycle < cycle) {
    advance(bench, cycle);
    if (bench.avr->state == cpu_Crashed || bench.avr->state == cpu_Done) {
      std::printf("crashed at pc %x\n", bench.avr->pc);
      std::exit(1);
    }
    if (bench.avr->run == avr_callback_run_raw) continue;
    bench.avr->run(bench.avr);  // The run lets simavr's watchdog ask for a reset, which releases all pins.
    bench.avr->run = avr_callback_run_raw;
    bench.avr->pc = 0;
    onPort(bench, 'A', bench.invert_a);
    onPort(bench, 'C', bench.invert_c);
    surround(bench);
    ++bench.resets;
  }
}

std::size_t serve(Bench& bench, planner::Link& link, std::uint64_t cycle) {
  runTo(bench, cycle);
  std::vector<std::uint8_t> received;
  received.swap(bench.from_controller);
  const auto bytes = link.step(received, static_cast<double>(cycle) / KB_CPU_HZ);
  bench.to_controller.insert(bench.to_controller.end(), bytes.begin(), bytes.end());
  return bytes.size();
}

void putU32(std::vector<std::uint8_t>& to, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void check(bool good, const std::string& what) {
  std::printf("%s  %s\n", good ? "ok  " : "FAIL", what.c_str());
  if (!good) ++failed;
}

int failures() { return failed; }

}  // namespace kerfbench::avr_bench
