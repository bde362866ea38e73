// SPDX-License-Identifier: Apache-2.0
// The controller's core on a machine made by the test: the test sets inputs, and outputs are recorded tick by
// tick.
#ifndef KERFBENCH_TESTS_CONTROLLER_FAKE_MACHINE_H
#define KERFBENCH_TESTS_CONTROLLER_FAKE_MACHINE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct fake_tick {
  uint8_t first_a, first_c;  // levels written first, PUL up
  uint8_t low_a, low_c;      // levels with PUL down
  uint8_t dir_a, dir_c;      // DIR of the next tick
};

struct fake_machine {
  double belt_count;  // true position of the belt
  double belt_counts_per_tick;
  double next_mark_count;    // position of the next print mark
  double mark_pitch_counts;  // distance from one mark to the next
  uint64_t marks;
  bool a_lost;        // true if the wire of A is broken
  bool b_lost;        // true if B reads low
  uint8_t rx_errors;  // framing errors and overruns to be reported
  uint64_t fed;       // number of times that the watchdog was reset
  uint8_t inputs;     // levels of port L
  uint64_t tick;
  struct fake_tick last;
  bool (*from_host)(void* context, uint8_t* byte);  // polled at the pace of the baud rate
  void (*to_host)(void* context, uint8_t byte);
  void* context;
};

extern struct fake_machine fake;

void fakeReset(void);
void fakeTick(void);
void fakeWatchdogReset(void);
void fakeEdge(bool a, bool b);  // calls the encoder's interrupt
int32_t fakePosition(int axis);
int32_t fakeBeltAhead256(uint8_t periods);
uint16_t fakeQueueFree(void);
void fakeJobCheck(unsigned* a, unsigned* b);
uint16_t fakeCrc(const uint8_t* bytes, int size);

#ifdef __cplusplus
}
#endif
#endif
