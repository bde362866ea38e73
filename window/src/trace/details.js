// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Chunks of a trace that were read, unpacked and decoded, as many as a limit of memory allows: views ask for what is there
// and draw that; what is missing is read, and they are told when it has come.

import { jsonOf } from './records.js';
import { pinTableOf, tableOf } from './tables.js';

/**
 * @typedef {import('./file.js').TraceFile} TraceFile
 * @typedef {import('./records.js').Message} Message
 * @typedef {{messages: Map<string, Message[]>, decoded: Map<string, unknown>, bytes: number}} Loaded
 */

/** An unpacked chunk and its tables take about this much for each of its bytes. */
const kBytesForByte = 2.5;
const kAtOnce = 6;

/** @type {Record<string, (messages: Message[]) => unknown>} */
const decoders = {
  '/motion': tableOf,
  '/commanded': tableOf,
  '/gcode': tableOf,
  '/burnt': tableOf,
  '/spot': tableOf,
  '/pins': pinTableOf,
};
const plain = (/** @type {Message[]} */ messages) => messages.map((message) => jsonOf(message.data));

export class Details {
  /** @type {Map<number, Loaded>} the latest used last */
  #loaded = new Map();
  /** @type {Map<number, Promise<void>>} */
  #coming = new Map();
  /** @type {Map<number, Error>} */
  #failed = new Map();
  /** @type {Set<() => void>} */
  #listeners = new Set();
  /** @type {{index: number, go: () => void}[]} */
  #waiting = [];
  #running = 0;
  #bytes = 0;

  /** @param {TraceFile} file @param {number} limit_bytes */
  constructor(file, limit_bytes = 256 * 1024 * 1024) {
    this.file = file;
    this.limit_bytes = limit_bytes;
  }

  /** Bytes that are held now, as estimated. */
  get bytes() {
    return this.#bytes;
  }

  /** Whether something that was asked for has not come yet. */
  get waiting() {
    return this.#coming.size > 0;
  }

  /** Called after a chunk has come. @param {() => void} listener @returns {() => void} ends it */
  onLoad(listener) {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /**
   * What is there of a topic in a span of time, a decoded part for each chunk in order; what is missing is asked for.
   * @template T
   * @param {string} topic @param {number} from_s @param {number} to_s
   * @returns {{parts: T[], complete: boolean}}
   */
  peek(topic, from_s, to_s) {
    /** @type {T[]} */
    const parts = [];
    let complete = true;
    for (const index of this.file.chunksOf(topic, from_s, to_s)) {
      const part = this.#decoded(index, topic);
      if (part !== undefined) parts.push(/** @type {T} */ (part));
      else if (!this.#failed.has(index)) {
        complete = false;
        void this.#load(index);
      }
    }
    return { parts, complete };
  }

  /**
   * The same once all is there.
   * @template T
   * @param {string} topic @param {number} from_s @param {number} to_s @returns {Promise<T[]>}
   */
  async wait(topic, from_s, to_s) {
    const indexes = this.file.chunksOf(topic, from_s, to_s);
    await Promise.all(indexes.map((index) => this.#load(index)));
    return indexes.map((index) => /** @type {T} */ (this.#decoded(index, topic))).filter((part) => part !== undefined);
  }

  /** One chunk's part of a topic. @param {string} topic @param {number} index of the chunk @returns {Promise<any>} */
  async part(topic, index) {
    await this.#load(index);
    const failed = this.#failed.get(index);
    if (failed) throw failed;
    return this.#decoded(index, topic);
  }

  /** Reads ahead. @param {string} topic @param {number} from_s @param {number} to_s */
  prefetch(topic, from_s, to_s) {
    for (const index of this.file.chunksOf(topic, from_s, to_s)) void this.#load(index);
  }

  /** Chunks that could not be read, with the reasons. */
  get failures() {
    return this.#failed;
  }

  /** @param {number} index @param {string} topic */
  #decoded(index, topic) {
    const loaded = this.#loaded.get(index);
    if (!loaded) return undefined;
    this.#loaded.delete(index);
    this.#loaded.set(index, loaded);
    if (!loaded.decoded.has(topic)) {
      const messages = loaded.messages.get(topic) ?? [];
      loaded.decoded.set(topic, (decoders[topic] ?? plain)(messages));
    }
    return loaded.decoded.get(topic);
  }

  /** @param {number} index @returns {Promise<void>} */
  #load(index) {
    if (this.#loaded.has(index)) return Promise.resolve();
    let coming = this.#coming.get(index);
    if (!coming) {
      coming = this.#read(index).finally(() => this.#coming.delete(index));
      this.#coming.set(index, coming);
    }
    return coming;
  }

  /** @param {number} index */
  async #read(index) {
    await this.#turn(index);
    try {
      const messages = await this.file.messagesIn(index);
      let size = 0;
      for (const list of messages.values()) for (const message of list) size += message.data.byteLength;
      const bytes = kBytesForByte * size;
      this.#loaded.set(index, { messages, decoded: new Map(), bytes });
      this.#bytes += bytes;
      this.#trim();
    } catch (error) {
      this.#failed.set(index, /** @type {Error} */ (error));
    } finally {
      --this.#running;
      this.#next();
      for (const listener of this.#listeners) listener();
    }
  }

  /** Waits until few others are read; the latest wish comes first, because it is what is looked at now. @param {number} index */
  #turn(index) {
    return new Promise((go) => {
      this.#waiting.push({ index, go: () => go(undefined) });
      this.#next();
    });
  }

  #next() {
    while (this.#running < kAtOnce && this.#waiting.length) {
      ++this.#running;
      this.#waiting.pop()?.go();
    }
  }

  #trim() {
    for (const [index, { bytes }] of this.#loaded) {
      if (this.#bytes <= this.limit_bytes || this.#loaded.size <= 2) return;
      this.#loaded.delete(index);
      this.#bytes -= bytes;
    }
  }
}
