/* SPDX-License-Identifier: Apache-2.0 */
#include "frame.h"

#include "hal.h"
#include "queue.h"

enum state { KB_AT_SYNC, KB_AT_TYPE, KB_AT_SEQ, KB_AT_LENGTH, KB_AT_PAYLOAD, KB_AT_CRC_LOW, KB_AT_CRC_HIGH };
enum { KB_TX_SIZE = 128, KB_HEAD = 4 };

static struct {
  uint8_t state;
  uint8_t taken;
  uint8_t crc_low;
  uint16_t crc;
  struct kb_check check; /* check including this frame */
  struct kb_frame frame;
} rx;

struct kb_check kb_job_check;

static uint8_t tx_bytes[KB_TX_SIZE];
static uint8_t tx_first;
static uint8_t tx_end;
static uint8_t tx_sent; /* bytes sent of the present frame, without its CRC */
static uint8_t tx_length;
static uint8_t tx_crc_bytes; /* CRC bytes still to be sent */
static uint16_t tx_crc;

void kb_frame_init(void) {
  rx.state = KB_AT_SYNC;
  kb_job_check.a = 1;
  kb_job_check.b = 0;
  tx_first = tx_end = 0;
  tx_sent = tx_length = tx_crc_bytes = 0;
}

void kb_frame_commit(void) { kb_job_check = rx.check; }
bool kb_frame_begun(void) { return rx.state != KB_AT_SYNC; }
void kb_frame_forget(void) { rx.state = KB_AT_SYNC; }

static void atLength(uint8_t byte) {
  rx.frame.length = byte;
  rx.frame.nak = 0;
  rx.taken = 0;
  const bool data = rx.frame.type == KB_DATA;
  rx.check = kb_job_check;
  if (byte > (data ? KB_PAYLOAD_MAX : KB_SHORT_PAYLOAD) || (data && byte <= KB_CHECK_LEN)) {
    rx.frame.nak = KB_NAK_LENGTH;
  } else if (data && (uint16_t)(byte - KB_CHECK_LEN) > kb_queue_free()) {
    rx.frame.nak = KB_NAK_FULL; /* sent only once the CRC has proven the length */
  }
  rx.state = byte == 0 ? KB_AT_CRC_LOW : KB_AT_PAYLOAD;
}

static void atData(uint8_t byte) {
  const uint8_t program = (uint8_t)(rx.frame.length - KB_CHECK_LEN);
  if (rx.taken < program) {
    kb_check_add(&rx.check, byte);
    kb_queue_put(rx.taken, byte);
  } else if (!kb_check_holds(&rx.check, (uint8_t)(rx.taken - program), byte)) {
    rx.frame.nak = KB_NAK_CHECK;
  }
}

uint8_t kb_frame_take(uint8_t most) {
  if (rx.state != KB_AT_PAYLOAD || rx.frame.type != KB_DATA || rx.frame.nak != 0) {
    return 0;
  }
  const uint8_t from = rx.taken;
  const uint8_t program = (uint8_t)(rx.frame.length - KB_CHECK_LEN);
  const uint8_t end = program - from > most ? (uint8_t)(from + most) : program;
  uint8_t taken = from;
  uint16_t crc = rx.crc;
  struct kb_check check;
  check = rx.check;
  uint16_t at = kb_queue_end(from);
  uint8_t byte;
  while (taken < end && kb_hal_rx(&byte)) {
    crc = kb_crc16(crc, byte);
    kb_check_add(&check, byte);
    at = kb_queue_store(at, byte);
    taken++;
  }
  rx.crc = crc;
  rx.check = check;
  rx.taken = taken;
  return (uint8_t)(taken - from);
}

bool kb_frame_byte(uint8_t byte, struct kb_frame* frame) {
  if (rx.state != KB_AT_SYNC && rx.state < KB_AT_CRC_LOW) {
    rx.crc = kb_crc16(rx.crc, byte);
  }
  switch (rx.state) {
    case KB_AT_SYNC:
      if (byte == KB_SYNC) {
        rx.crc = 0xFFFF;
        rx.state = KB_AT_TYPE;
      }
      return false;
    case KB_AT_TYPE:
      rx.frame.type = byte;
      rx.state = KB_AT_SEQ;
      return false;
    case KB_AT_SEQ:
      rx.frame.seq = byte;
      rx.state = KB_AT_LENGTH;
      return false;
    case KB_AT_LENGTH:
      atLength(byte);
      if (rx.frame.nak == KB_NAK_LENGTH) { /* no frame is that long: look for the next SYNC */
        rx.state = KB_AT_SYNC;
        *frame = rx.frame;
        return true;
      }
      return false;
    case KB_AT_PAYLOAD:
      if (rx.frame.type != KB_DATA) {
        rx.frame.payload[rx.taken] = byte;
      } else if (rx.frame.nak == 0) {
        atData(byte);
      }
      if (++rx.taken == rx.frame.length) {
        rx.state = KB_AT_CRC_LOW;
      }
      return false;
    case KB_AT_CRC_LOW:
      rx.crc_low = byte;
      rx.state = KB_AT_CRC_HIGH;
      return false;
    default:
      rx.state = KB_AT_SYNC;
      if (rx.crc != (uint16_t)(rx.crc_low | (uint16_t)byte << 8)) {
        rx.frame.nak = KB_NAK_CRC;
      }
      *frame = rx.frame;
      return true;
  }
}

static void put(uint8_t byte) {
  tx_bytes[tx_end] = byte;
  tx_end = (uint8_t)((tx_end + 1U) & (KB_TX_SIZE - 1U));
}

bool kb_frame_send(uint8_t type, uint8_t seq, const uint8_t* payload, uint8_t length) {
  const uint8_t room = (uint8_t)((uint8_t)(tx_first - tx_end - 1) & (KB_TX_SIZE - 1));
  if (room < length + KB_HEAD) {
    return false;
  }
  put(KB_SYNC);
  put(type);
  put(seq);
  put(length);
  for (uint8_t i = 0; i < length; ++i) {
    put(payload[i]);
  }
  return true;
}

/* The CRC is computed byte by byte as the frame is sent: done at once for a long answer, it was measured to
 * delay the next period beyond its time. */
void kb_frame_pump(void) {
  if ((tx_first == tx_end && tx_sent < tx_length) || !kb_hal_tx_ready()) {
    return;
  }
  if (tx_sent == tx_length) {
    if (tx_crc_bytes == 0) {
      if (tx_first == tx_end) {
        return;
      }
      tx_sent = 0;
      tx_length = (uint8_t)(tx_bytes[(tx_first + 3U) & (KB_TX_SIZE - 1U)] + KB_HEAD);
      tx_crc = 0xFFFF;
      tx_crc_bytes = 2;
    } else {
      tx_crc_bytes--;
      kb_hal_tx((uint8_t)tx_crc);
      tx_crc >>= 8;
      return;
    }
  }
  const uint8_t byte = tx_bytes[tx_first];
  tx_first = (uint8_t)((tx_first + 1U) & (KB_TX_SIZE - 1U));
  if (tx_sent != 0) {
    tx_crc = kb_crc16(tx_crc, byte);
  }
  tx_sent++;
  kb_hal_tx(byte);
}
