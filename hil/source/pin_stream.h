/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later */
/* clang-format off */
/* The pin-stream protocol between the bench and a child process that runs a firmware image: an emulator, a
 * native build, or any program that speaks this page. Plain C, no dependency, so that a child under any
 * licence can use it.
 *
 * The child reads requests from file descriptor 0 and writes replies to file descriptor 1 (its diagnostics go
 * to 2). A message is
 *
 *     u32 length of the payload | u8 type | payload
 *
 * All integers are little-endian; texts are UTF-8 with a u16 length before them.
 *
 *   bench -> child
 *     OPEN     u32 version, u64 clock_hz, u32 baud, u64 max_events, text mcu, text image path,
 *              and where a scenario says what the EEPROM holds: text EEPROM file, or "blank"
 *              -> HELLO or ERROR; baud 0: nobody listens to the UART, at whatever rate it speaks
 *     DRIVE    u64 tick, u16 port, u16 bit, u8 level
 *              an input pin takes this level at this tick (> watermark)
 *     UART     bytes for the controller, sent at its baud rate, flow control honoured; no reply
 *     ADVANCE  u64 until                                   run until this tick -> BATCH; several may come
 *              before the first is answered, and are answered in order
 *     QUIT     the child exits with 0
 *     DESCRIBE text mcu           in place of OPEN, for the bench's own emulators -> DESCRIPTION
 *
 *   child -> bench
 *     HELLO    u32 version, u64 tick_num, u64 tick_den (seconds per tick), u32 stamp_err_ticks,
 *              text configuration
 *     ERROR    text               the image cannot be run; the child exits
 *     BATCH    u8 stop, u64 watermark, u32 n, n events, u32 m, m UART bytes, text message
 *              event: u64 tick, u16 port, u16 changed, u16 level, u16 flags (twin/base/pin_event.h)
 *     DESCRIPTION
 *              text               the controller that was named, or all where none is called so, a line each:
 *              names with blanks between them, tab, bytes of flash, tab, of SRAM, tab, of EEPROM, tab, letters or
 *              digits of its ports, tab, digits of its timers, tab, of its UARTs, and where it is not 8: tab, bits
 *              of a port
 *
 * A BATCH with stop other than KB_PS_REACHED is the last one. Ticks in a batch ascend and lie in
 * (last watermark, watermark], and no pin changes twice in one tick. The level of a pin before its first event
 * is 0.
 */
/* clang-format on */
#ifndef KERFBENCH_PIN_STREAM_H
#define KERFBENCH_PIN_STREAM_H

#define KB_PS_VERSION 1u
#define KB_PS_MAX_PAYLOAD (64u * 1024u * 1024u)

enum kb_ps_request {
  KB_PS_OPEN = 1,
  KB_PS_DRIVE = 2,
  KB_PS_UART = 3,
  KB_PS_ADVANCE = 4,
  KB_PS_QUIT = 5,
  KB_PS_DESCRIBE = 6
};
enum kb_ps_reply { KB_PS_HELLO = 65, KB_PS_ERROR = 66, KB_PS_BATCH = 67, KB_PS_DESCRIPTION = 68 };
enum kb_ps_stop {
  KB_PS_REACHED = 0,
  KB_PS_ENDED = 1,
  KB_PS_CRASHED = 2,
  KB_PS_FLOODED = 3,
  KB_PS_MISHEARD = 4
};

#endif
