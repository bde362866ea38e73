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
 * @typedef {{index: number, needed: boolean, come: Promise<void>, done: () => void}} Wish a chunk that is to be read
 */

/** An unpacked chunk and its tables take about this much for each of its bytes. */
const kBytesForByte = 2.5;
const kAtOnce = 6; // Requests.
const kTogether = 64; // Wishes that are looked at for what lies together: more than all views have at one moment.

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
  /** @type {Map<number, Wish>} */
  #coming = new Map();
  /** @type {Map<number, Error>} */
  #failed = new Map();
  /** @type {Set<() => void>} */
  #listeners = new Set();
  /** Those of #coming that are not read yet, the latest last. @type {Wish[]} */
  #waiting = [];
  #planned = false;
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
        void this.#load(index, false);
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

  /**
   * One chunk's part of a topic, if it is there; else it is asked for.
   * @param {string} topic @param {number} index of the chunk @returns {any} undefined: it comes; null: it cannot be read
   */
  peekPart(topic, index) {
    const part = this.#decoded(index, topic);
    if (part !== undefined) return part;
    if (this.#failed.has(index)) return null;
    void this.#load(index, false);
    return undefined;
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

  /**
   * @param {number} index @param {boolean} [needed] false: whoever looks now wishes for it, and will again if it is left out
   * @returns {Promise<void>}
   */
  #load(index, needed = true) {
    if (this.#loaded.has(index)) return Promise.resolve();
    const known = this.#coming.get(index);
    if (known) {
      known.needed ||= needed;
      return known.come;
    }
    /** @type {() => void} */
    let done = () => undefined;
    const come = new Promise((/** @type {(value: void) => void} */ resolve) => (done = resolve));
    const wish = { index, needed, come, done };
    this.#coming.set(index, wish);
    this.#waiting.push(wish);
    this.#plan();
    return come;
  }

  /** What is wished for in one go is read together. */
  #plan() {
    if (this.#planned) return;
    this.#planned = true;
    queueMicrotask(() => {
      this.#planned = false;
      this.#next();
    });
  }

  /** The latest wishes come first, because they are what is looked at now; those that were overtaken are given up. */
  #next() {
    while (this.#running < kAtOnce && this.#waiting.length) {
      const latest = this.#waiting.splice(-kTogether);
      const byIndex = new Map(latest.map((wish) => [wish.index, wish]));
      for (const run of this.file.runsOf([...byIndex.keys()])) {
        ++this.#running;
        void this.#read(run.map((index) => /** @type {Wish} */ (byIndex.get(index))));
      }
    }
    const late = this.#waiting.length - kTogether;
    if (late <= 0) return;
    const given_up = this.#waiting.slice(0, late).filter((wish) => !wish.needed);
    if (!given_up.length) return;
    this.#waiting = this.#waiting.filter((wish) => !given_up.includes(wish));
    for (const wish of given_up) this.#end(wish);
  }

  /** @param {Wish} wish */
  #end(wish) {
    this.#coming.delete(wish.index);
    wish.done();
  }

  /** @param {Wish[]} run chunks that are read at once */
  async #read(run) {
    const parts = await Promise.allSettled(this.file.messagesOfRun(run.map((wish) => wish.index)));
    parts.forEach((part, i) => {
      if (part.status === 'fulfilled') this.#keep(run[i].index, part.value);
      else this.#failed.set(run[i].index, /** @type {Error} */ (part.reason));
      this.#end(run[i]);
    });
    --this.#running;
    this.#next();
    for (const listener of this.#listeners) listener();
  }

  /** @param {number} index @param {Map<string, Message[]>} messages */
  #keep(index, messages) {
    let size = 0;
    for (const list of messages.values()) for (const message of list) size += message.data.byteLength;
    const bytes = kBytesForByte * size;
    this.#loaded.set(index, { messages, decoded: new Map(), bytes });
    this.#bytes += bytes;
    this.#trim();
  }

  #trim() {
    for (const [index, { bytes }] of this.#loaded) {
      if (this.#bytes <= this.limit_bytes || this.#loaded.size <= 2) return;
      this.#loaded.delete(index);
      this.#bytes -= bytes;
    }
  }
}
