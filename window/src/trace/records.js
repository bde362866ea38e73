// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The records of an MCAP file that the viewer walks itself: those within a chunk, and those of a file without a
// summary. Everything else is @mcap/core's work. The layout is that of https://mcap.dev/spec.

import { crc32 } from '@foxglove/crc';
import { decompress } from 'fzstd';

export const kOpcode = { schema: 0x03, channel: 0x04, message: 0x05, chunk: 0x06, messageIndex: 0x07, dataEnd: 0x0f };
export const kRecordHead_bytes = 9; // Opcode and length of what follows.
export const kMagic_bytes = 8;

const kText = new TextDecoder();

/** @type {import('@mcap/core').DecompressHandlers} */
export const decompressHandlers = {
  zstd: (packed, size) => decompress(packed, new Uint8Array(Number(size))),
};

/**
 * @typedef {{channel: number, time_s: number, data: Uint8Array}} Message
 * @typedef {{id: number, topic: string}} Channel
 * @typedef {{start_s: number, end_s: number, size: number, crc: number, compression: string, records: Uint8Array}} Chunk
 */

/** @param {Uint8Array} bytes */
const viewOf = (bytes) => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

/** @param {bigint} ns */
export const secondsOf = (ns) => Number(ns) * 1e-9;

/**
 * The head of a record at an offset, or undefined if the bytes end before it does.
 * @param {Uint8Array} bytes @param {number} at
 */
export function headOf(bytes, at) {
  if (at + kRecordHead_bytes > bytes.byteLength) return undefined;
  const view = viewOf(bytes);
  return { opcode: view.getUint8(at), length: Number(view.getBigUint64(at + 1, true)) };
}

/**
 * A chunk without its records: what a reader needs to know before it reads them.
 * @param {Uint8Array} content content of a chunk record, at least its first 64 bytes
 */
export function chunkHeadOf(content) {
  const view = viewOf(content);
  const name_bytes = view.getUint32(28, true);
  const after = 32 + name_bytes;
  return {
    start_s: secondsOf(view.getBigUint64(0, true)),
    end_s: secondsOf(view.getBigUint64(8, true)),
    size: Number(view.getBigUint64(16, true)),
    crc: view.getUint32(24, true),
    compression: kText.decode(content.subarray(32, after)),
    records_at: after + 8,
  };
}

/**
 * Unpacks the content of a chunk record.
 * @param {Uint8Array} content
 * @throws {Error} for an unknown compression, and where the content's checksum is wrong
 */
export function unpackedChunk(content) {
  const head = chunkHeadOf(content);
  const packed = content.subarray(head.records_at);
  const unpack = decompressHandlers[head.compression];
  if (head.compression !== '' && !unpack) throw new Error(`chunks packed by '${head.compression}' cannot be read`);
  const records = unpack ? unpack(packed, BigInt(head.size)) : packed;
  if (head.crc !== 0 && crc32(records) !== head.crc) throw new Error('a chunk of the trace is damaged: its checksum is wrong');
  return records;
}

/**
 * Calls back for each message and channel of an unpacked chunk, in the file's order. The data of a message are a view
 * of the chunk, not a copy.
 * @param {Uint8Array} records
 * @param {{message?: (message: Message) => void, channel?: (channel: Channel) => void}} take
 */
export function eachRecord(records, take) {
  const view = viewOf(records);
  let at = 0;
  for (let head = headOf(records, at); head; head = headOf(records, at)) {
    const from = at + kRecordHead_bytes;
    const to = from + head.length;
    if (to > records.byteLength) throw new Error('a chunk of the trace ends within a record');
    if (head.opcode === kOpcode.message) {
      take.message?.({
        channel: view.getUint16(from, true),
        time_s: secondsOf(view.getBigUint64(from + 6, true)),
        data: records.subarray(from + 22, to),
      });
    } else if (head.opcode === kOpcode.channel) {
      take.channel?.(channelOf(records.subarray(from, to)));
    }
    at = to;
  }
}

/** @param {Uint8Array} content @returns {Channel} */
export function channelOf(content) {
  const view = viewOf(content);
  const topic_bytes = view.getUint32(4, true);
  return { id: view.getUint16(0, true), topic: kText.decode(content.subarray(8, 8 + topic_bytes)) };
}

/** @param {Uint8Array} data */
export const jsonOf = (data) => JSON.parse(kText.decode(data));
