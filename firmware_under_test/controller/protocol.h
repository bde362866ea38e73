/* SPDX-License-Identifier: Apache-2.0 */
/* The controller's language on its UART (8N1, 250 000 baud on the AVR), used by the firmware (C) and by its
 * host half (C++).
 *
 * Frame:  SYNC  TYPE  SEQ  LEN  payload[LEN]  CRC16
 *   SYNC  0xA5.   SEQ counts frames of the host, modulo 256; the answer repeats it.
 *   CRC16 CCITT (poly 0x1021, start 0xFFFF), low byte first, over TYPE … payload.
 * All integers little-endian. The host may have as many program bytes under way as the last answer's free
 * bytes allow, and one frame at a time; a NAK or a silence of KB_REPLY_TIMEOUT_MS repeats the frame.
 */
#ifndef KERFBENCH_CONTROLLER_PROTOCOL_H
#define KERFBENCH_CONTROLLER_PROTOCOL_H

#include "firmware_under_test/controller/target.h"

#define KB_SYNC 0xA5
#define KB_PAYLOAD_MAX 128
#define KB_REPLY_TIMEOUT_MS 50

enum kb_axis { KB_GALVO_X, KB_GALVO_Y, KB_GANTRY_X, KB_GANTRY_Y, KB_FEED, KB_AXES };

/* Host -> controller. Each is answered by KB_ACK or KB_NAK. */
enum kb_request {
  KB_HELLO = 0x01,  /* -                                        -> ACK, then INFO */
  KB_CONFIG = 0x02, /* struct kb_config, field by field */
  KB_DATA = 0x03,   /* program bytes, whole operations only, then u32 job check up to their end */
  KB_START = 0x04,  /* u32 job check: run the queue */
  KB_STOP = 0x05,   /* stop now, laser off, queue emptied */
  KB_STATUS = 0x06, /* -                                        -> ACK, then STATE */
  KB_POWER = 0x20   /* the loop on the measured power, after CONFIG, which ends it; empty: no loop */
};

/* Controller -> host. */
enum kb_reply {
  KB_ACK = 0x81,  /* u16 free bytes of the queue */
  KB_NAK = 0x82,  /* u8 reason */
  KB_INFO = 0x83, /* u8 protocol version, u16 queue size, u16 tick cycles, u8 ticks per period, then the block
                     of release.h */
  KB_STATE = 0x84, /* u8 state, u8 fault, u16 free bytes, i32 belt counts, i32 steps of each axis */
  KB_EVENT = 0x85  /* u8 state, u8 fault: sent by itself whenever the state changes (SEQ = 0) */
};

enum kb_nak {
  KB_NAK_CRC = 1,
  KB_NAK_TYPE = 2,
  KB_NAK_LENGTH = 3,
  KB_NAK_FULL = 4,
  KB_NAK_STATE = 5,
  KB_NAK_VALUE = 6,
  KB_NAK_CHECK = 7 /* the job check differs: not the program that the host has sent */
};
enum kb_state { KB_IDLE, KB_RUNNING, KB_DONE, KB_STOPPED };
enum kb_fault {
  KB_OK,
  KB_FAULT_DRY,       /* the queue ran out inside the program: laser off at once, the axes ramp down */
  KB_FAULT_INTERLOCK, /* the guard opened while running */
  KB_FAULT_LIMIT,     /* an end-of-travel switch while running */
  KB_FAULT_PROGRAM,   /* an operation that does not exist */
  KB_FAULT_OVERSPEED, /* a move of more than KB_MAX_STEPS_PER_PERIOD */
  KB_FAULT_LATE,      /* the controller itself did not prepare a period in time */
  KB_FAULT_MARKS,     /* more print marks waited than KB_MARKS_MAX - 1: a unit would be lost */
  KB_FAULT_SILENT,    /* no frame was accepted for KB_SILENCE_PERIODS while running */
  KB_FAULT_UART,      /* KB_LINE_ERRORS_MAX line errors without an accepted frame between, while running */
  KB_FAULT_ENCODER,   /* the belt that is followed does not move as it should, or A misses edges */
  KB_FAULT_BELT_FAST, /* the belt is too fast for the job, or the axis cannot keep up with it */
  KB_FAULT_WATCHDOG,  /* the main loop stood still; the controller was reset */
  KB_FAULT_FIELD      /* the beam would leave its field */
};

/* Limits that lead to KB_STOPPED; their timing and the reaction of the axes: docs/reference/controller.md. */
#define KB_SILENCE_MS 250UL /* a host repeats and asks more often than that */
#define KB_SILENCE_PERIODS ((uint16_t)KB_PERIODS_IN_MS(KB_SILENCE_MS))
#define KB_LINE_ERRORS_MAX 8U /* framing errors, overruns, damaged frames */
/* nominal travel of a window, and at least 2 periods: a quarter must be seen */
#define KB_ENCODER_WINDOW_COUNTS 16U
#define KB_ENCODER_ERRORS_MAX 8U /* edges of A without a change of A, since START */
#define KB_BELT_FAST_PERIODS ((uint8_t)KB_PERIODS_IN_MS(7)) /* periods in a row */

/* States for requests. HELLO (unless running) and CONFIG empty the queue and lead to KB_IDLE; CONFIG and
 * START are refused while running (KB_NAK_STATE), START also without a configuration or a queue, DATA in
 * KB_DONE and KB_STOPPED: a new program begins with CONFIG. STOP leads from running to KB_STOPPED with KB_OK,
 * from any other state to KB_IDLE. A frame with the type and SEQ of the last one accepted since HELLO is
 * answered again and not executed again. A frame that pauses for more than 20 ms is forgotten. A
 * configuration holds for one START.
 *
 * Job check: u16 a = 1, b = 0; for each byte of CONFIG's payload, of POWER's if there is one, and then of
 * the program, a += byte, b += a; the check is a | b << 16. So a frame that passes the CRC by accident,
 * and one that only one side believes to have been accepted, are refused before any of it is run. */
#define KB_PROTOCOL_VERSION 3
#define KB_CHECK_LEN 4
#define KB_MARKS_MAX 8

/* Program: a stream of operations.
 *
 * KB_OP_MOVE | mask  one interpolation period. mask bits 0…4: an int8 count of steps follows for each
 *                    axis named, in axis order.
 *                    KB_OP_POWER: a u8 power follows and the laser gate is open for this period.
 *                    KB_OP_GAIN: an i16 follow gain follows (it holds for later periods too).
 *                    Order of the bytes after the op: steps, power, gain.
 *
 * Follow: at each period boundary the controller takes the tracked belt position b (counts since the
 * reference) and the nominal one n (which advances by config.nominal_per_period), and moves the follow axis
 * by the change of round((b - n) * gain / 4096) in addition to the program's own steps.
 *
 * In detail: period i ends at n = offset + (i + 1) * nominal, and the correction at its end is that of the
 * belt position predicted for that instant with its gain: at constant belt speed there is no lag. Steps
 * that do not fit into KB_MAX_STEPS_PER_PERIOD together with the program's own follow in the next periods.
 * Before a WAIT_MARK the reference is the belt at START. While a WAIT_MARK waits, and after END, the
 * correction returns to zero, so that at KB_DONE each axis is where the program's own steps have led it.
 * Counts follow from edges of A and the time since. */
#define KB_OP_MOVE 0x80
#define KB_OP_POWER 0x20
#define KB_OP_GAIN 0x40
enum kb_op {
  KB_OP_END = 0x00, /* - : done */
  /* i32 offset in belt counts: wait for the next print mark, then until the belt is that far beyond it; this
   * instant is the belt reference n = 0 + offset of the periods that follow */
  KB_OP_WAIT_MARK = 0x01,
  KB_OP_WAIT = 0x02,  /* u16 periods: stand still */
  KB_OP_FOLLOW = 0x03 /* u8 axis + 1, or 0: follow off, the correction returns to zero */
};

/* KB_CONFIG payload: u32 nominal_per_period (belt counts, 16.16 fixed point), u8 gate_on_delay_ticks,
 * u8 gate_off_delay_ticks, u8 idle_power, u32 max_per_period (as nominal; 0: any speed), u8 high byte of
 * gate_on_delay_ticks, u8 of gate_off_delay_ticks. Delays count from the period boundary and let the laser
 * wait for the mirrors' tracking delay; power follows with the same delay as the gate.
 *
 * Then for the drives, all derived from what they need: u8 pins of port A that are inverted (PUL: active low;
 * DIR: low is the positive direction), u8 the same of port C, bits 0 and 1; u8 mask of the axes whose PUL
 * stays active for as many ticks as the next u8 says, 1 … KB_WIDE_TICKS_MAX (the others' falls within the
 * tick); u8 × 5 steps of each axis in a period, at most, which leave a tick between such pulses; u8 × 5 steps
 * of each axis in a period before and after DIR changes, at most. A reversal from more waits for a period at
 * rest; what more steps there are follow in the next periods.
 *
 * Then the field: i32 × 5 lowest and i32 × 5 highest step of each axis, as KB_STATE counts them. With the
 * laser on, no axis begins or ends a period beyond them: the controller stops before such a period. */
#define KB_CONFIG_LEN 67
#define KB_WIDE_TICKS_MAX 15 /* most ticks; one less than a power of two */

/* KB_POWER payload: u8 gain (1/256), u8 least and u8 most power, u16 ticks from the start of a period until
 * the meter's edges for its energy (gate delay included), then of the powers 0, 16, … 240, 255 a u16 each:
 * rising edges of the meter in a period, in 1/16; they must not fall. The controller counts modulo 256. */
#define KB_POWER_POINTS 17
#define KB_POWER_LEN (5 + 2 * KB_POWER_POINTS)
#define KB_POWER_DELAY_MAX 352 /* ticks */

/* Pins of the ATmega2560 release (the native release uses the same numbers):
 * port A: galvo_x PUL A0 DIR A1, galvo_y PUL A2 DIR A3, gantry_x PUL A4 DIR A5, gantry_y PUL A6 DIR A7
 * port C: feed PUL C0 DIR C1, laser gate C2, laser PWM C3
 * inputs: encoder A D2 (INT2), encoder B D1, print mark D3 (INT3), limit X L0, limit Y L1,
 *         interlock L2 (high: closed), power meter H7 (T4)
 * DIR high is the positive direction; the rising edge of PUL steps.
 *
 * Laser PWM is a first-order sigma-delta: each tick (40 kHz) carries one bit, a power p gives p high ticks in
 * each 255, and p = 255 is always high. Why not OC0A: fast PWM at 62.5 kHz works in simavr 1.6, but makes
 * 125 000 edges/s where this makes at most 40 000, gives p + 1 cycles of 256 (a spike at 0), and its edges
 * move with the phase of Timer0; these are written with the gate, in one store. */
#endif
