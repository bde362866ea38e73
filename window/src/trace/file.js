// SPDX-License-Identifier: Apache-2.0
// @ts-check
// A trace as a file: which chunks it has, at which times, with which topics; and what is in one of them. Nothing is
// read before it is asked for but the summary, so that a file of any length opens at once.

import { McapIndexedReader } from '@mcap/core';
import { BlockCache } from './readable.js';
import {
  channelOf, chunkHeadOf, decompressHandlers, eachRecord, headOf, kMagic_bytes, kOpcode, kRecordHead_bytes, secondsOf,
  unpackedChunk,
} from './records.js';
import { countBefore, countUpTo } from './search.js';
import { unpacked } from './unpacker.js';

/**
 * @typedef {import('./readable.js').Readable} Readable
 * @typedef {import('./records.js').Message} Message
 * @typedef {{start_s: number, end_s: number, offset: number, length: number, channels: number[]}} ChunkPlace
 *   times of its first and last message; bytes of the chunk's record in the file, its head included
 * @typedef {{places: number[], starts_s: Float64Array, ends_s: Float64Array}} TopicChunks
 *   indexes of the chunks that have a topic, in ascending order of their starts; ends_s has the latest end up to each
 */

/** Bytes of a chunk's record up to the name of its compression, with room for any name. */
const kChunkHead_bytes = 64;
/** Two chunks with no more than this between them are read at once: it takes less time than another request. */
const kGap_bytes = 128 * 1024;
const kRun_bytes = 4 * 1024 * 1024;

export class TraceFile {
  /** @type {Map<string, TopicChunks>} */
  #byTopic = new Map();

  /** What was read of chunks so far: requests, their bytes, and chunks that were unpacked. */
  work = { requests: 0, bytes: 0, chunks: 0 };

  /**
   * @param {BlockCache} readable @param {ChunkPlace[]} chunks @param {Map<number, string>} topics by channel
   * @param {boolean} complete false for a trace that was cut off
   */
  constructor(readable, chunks, topics, complete) {
    this.readable = readable;
    this.chunks = chunks;
    this.topics = topics;
    this.complete = complete;
    this.#indexTopics();
  }

  /**
   * Opens a trace by its summary; one that was cut off, by walking over what is there.
   * @param {Readable} readable
   * @throws {Error} that says why the bytes are no trace
   */
  static async open(readable) {
    const cached = new BlockCache(readable);
    return (await byTheSummary(cached)) ?? walked(cached);
  }

  /** Times of the first and the last message, s. */
  get extent_s() {
    let [from, to] = [Infinity, -Infinity];
    for (const chunk of this.chunks) {
      from = Math.min(from, chunk.start_s);
      to = Math.max(to, chunk.end_s);
    }
    return this.chunks.length ? { from, to } : { from: 0, to: 0 };
  }

  /** @param {string} topic */
  has(topic) {
    return this.#byTopic.has(topic);
  }

  /**
   * Indexes of the chunks that have messages of a topic with times in [from_s, to_s]; other chunks may be among them.
   * @param {string} topic @param {number} from_s @param {number} to_s @returns {number[]}
   */
  chunksOf(topic, from_s = -Infinity, to_s = Infinity) {
    const found = this.#byTopic.get(topic);
    if (!found) return [];
    return found.places.slice(countBefore(found.ends_s, from_s), countUpTo(found.starts_s, to_s));
  }

  /**
   * Messages of a chunk by topic.
   * @param {number} index of the chunk @returns {Promise<Map<string, Message[]>>}
   */
  messagesIn(index) {
    return this.messagesOfRun([index])[0];
  }

  /**
   * Chunks in groups that lie so near one another in the file that they are read at once.
   * @param {number[]} indexes @returns {number[][]} each in the order in which they lie there
   */
  runsOf(indexes) {
    const ordered = [...indexes].sort((a, b) => this.chunks[a].offset - this.chunks[b].offset);
    /** @type {number[][]} */
    const runs = [];
    let [from, end] = [0, -Infinity];
    for (const index of ordered) {
      const { offset, length } = this.chunks[index];
      if (offset - end <= kGap_bytes && offset + length - from <= kRun_bytes) runs[runs.length - 1].push(index);
      else {
        runs.push([index]);
        from = offset;
      }
      end = offset + length;
    }
    return runs;
  }

  /**
   * Messages by topic of each chunk of a run, all of it read by one request.
   * @param {number[]} run as runsOf() has it @returns {Promise<Map<string, Message[]>>[]} each fails by itself
   */
  messagesOfRun(run) {
    const from = this.chunks[run[0]].offset;
    const last = this.chunks[run[run.length - 1]];
    const bytes = last.offset + last.length - from;
    this.work.requests += 1;
    this.work.bytes += bytes;
    this.work.chunks += run.length;
    const read = this.readable.readOnce(BigInt(from), BigInt(bytes));
    return run.map(async (index) => {
      const { offset, length } = this.chunks[index];
      return this.#messagesOf((await read).subarray(offset - from, offset - from + length));
    });
  }

  /** @param {Uint8Array} record of a chunk @returns {Promise<Map<string, Message[]>>} */
  async #messagesOf(record) {
    /** @type {Map<string, Message[]>} */
    const byTopic = new Map();
    eachRecord(await unpacked(record.subarray(kRecordHead_bytes)), {
      message: (message) => {
        const topic = this.topics.get(message.channel) ?? '';
        const list = byTopic.get(topic);
        if (list) list.push(message);
        else byTopic.set(topic, [message]);
      },
    });
    return byTopic;
  }

  /**
   * All messages of a topic that is short: the machine, the checks, a level of the overview.
   * @param {string} topic @returns {Promise<Message[]>}
   */
  async messagesOf(topic) {
    const chunks = await Promise.all(this.chunksOf(topic).map((index) => this.messagesIn(index)));
    return chunks.flatMap((byTopic) => byTopic.get(topic) ?? []);
  }

  #indexTopics() {
    /** @type {Map<number, number[]>} */
    const places = new Map();
    const order = this.chunks.map((_, index) => index);
    order.sort((a, b) => this.chunks[a].start_s - this.chunks[b].start_s || a - b);
    for (const index of order) {
      for (const channel of this.chunks[index].channels) {
        const list = places.get(channel);
        if (list) list.push(index);
        else places.set(channel, [index]);
      }
    }
    for (const [channel, list] of places) {
      const starts_s = Float64Array.from(list, (index) => this.chunks[index].start_s);
      let latest = -Infinity;
      const ends_s = Float64Array.from(list, (index) => (latest = Math.max(latest, this.chunks[index].end_s)));
      this.#byTopic.set(this.topics.get(channel) ?? '', { places: list, starts_s, ends_s });
    }
  }
}

/** @param {BlockCache} readable @returns {Promise<TraceFile | undefined>} undefined: it has no summary */
async function byTheSummary(readable) {
  const size = await readable.size();
  if (size < BigInt(2 * kMagic_bytes)) throw new Error('this is no trace: it is too short');
  const magic = await readable.read(0n, BigInt(kMagic_bytes));
  if (!isMagic(magic)) throw new Error('this is no trace: it does not begin as an MCAP file does');
  if (!isMagic(await readable.read(size - BigInt(kMagic_bytes), BigInt(kMagic_bytes)))) return undefined;
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const topics = new Map([...reader.channelsById].map(([id, channel]) => [id, channel.topic]));
  const chunks = reader.chunkIndexes.map((chunk) => ({
    start_s: secondsOf(chunk.messageStartTime),
    end_s: secondsOf(chunk.messageEndTime),
    offset: Number(chunk.chunkStartOffset),
    length: Number(chunk.chunkLength),
    channels: [...chunk.messageIndexOffsets.keys()],
  }));
  return new TraceFile(readable, chunks, topics, true);
}

/** @param {Uint8Array} bytes */
function isMagic(bytes) {
  const magic = [0x89, 0x4d, 0x43, 0x41, 0x50, 0x30, 0x0d, 0x0a];
  return magic.every((value, i) => bytes[i] === value);
}

/**
 * Walks from record to record up to the last whole one.
 * @param {BlockCache} readable @returns {Promise<TraceFile>}
 */
async function walked(readable) {
  const size = Number(await readable.size());
  /** @type {ChunkPlace[]} */
  const chunks = [];
  /** @type {Map<number, string>} */
  const topics = new Map();
  let at = kMagic_bytes;
  while (at + kRecordHead_bytes <= size) {
    const bytes = await readable.read(BigInt(at), BigInt(Math.min(kChunkHead_bytes + kRecordHead_bytes, size - at)));
    const head = headOf(bytes, 0);
    if (!head || at + kRecordHead_bytes + head.length > size || head.opcode === kOpcode.dataEnd) break;
    const length = kRecordHead_bytes + head.length;
    const content = bytes.subarray(kRecordHead_bytes);
    if (head.opcode === kOpcode.chunk) {
      const { start_s, end_s } = chunkHeadOf(content);
      chunks.push({ start_s, end_s, offset: at, length, channels: [] });
    } else if (head.opcode === kOpcode.messageIndex && chunks.length) {
      chunks[chunks.length - 1].channels.push(content[0] + 256 * content[1]);
    } else if (head.opcode === kOpcode.channel) {
      const { id, topic } = channelOf(await readable.read(BigInt(at + kRecordHead_bytes), BigInt(head.length)));
      topics.set(id, topic);
    }
    at += length;
  }
  if (!chunks.length) throw new Error('the trace was cut off before its first chunk was complete');
  await addTopics(readable, chunks, topics);
  return new TraceFile(readable, chunks, topics, false);
}

/**
 * Adds the channels that only the chunks themselves declare. A chunk whose message indexes were cut off is listed by its own
 * messages.
 * @param {Readable} readable @param {ChunkPlace[]} chunks @param {Map<number, string>} topics by channel
 */
async function addTopics(readable, chunks, topics) {
  for (const chunk of chunks) {
    if (chunk.channels.length && chunk.channels.every((channel) => topics.has(channel))) continue;
    const record = await readable.read(BigInt(chunk.offset), BigInt(chunk.length));
    const channels = new Set(chunk.channels);
    eachRecord(unpackedChunk(record.subarray(kRecordHead_bytes)), {
      channel: ({ id, topic }) => topics.set(id, topic),
      message: ({ channel }) => channels.add(channel),
    });
    chunk.channels = [...channels];
  }
}
