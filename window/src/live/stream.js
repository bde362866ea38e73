// SPDX-License-Identifier: Apache-2.0
// @ts-check
// A trace that grows, read as it comes. What is too old to be shown is forgotten.

import { McapStreamReader } from '@mcap/core';
import { decompressHandlers, jsonOf, secondsOf } from '../trace/records.js';
import { tableOf } from '../trace/tables.js';

/**
 * @typedef {import('../trace/machine.js').Machine} Machine
 * @typedef {import('../trace/tables.js').Table} Table
 */

const kMotion_s = 12; // What is kept of the motion before the newest.
const kBurnt_s = 90;

export class LiveTrace {
  /** @type {Machine | undefined} */
  machine;
  /** @type {Table[]} */
  motion = [];
  /** @type {Table[]} */
  burnt = [];
  /** Up to here `burnt` has all. */
  burnt_s = 0;
  newest_s = NaN;
  bytes = 0;
  #reader = new McapStreamReader({ decompressHandlers });
  /** @type {Map<number, string>} */
  #topics = new Map();

  /** Takes the next bytes of the file. @param {Uint8Array} bytes @returns {boolean} whether there is something new to show */
  append(bytes) {
    this.bytes += bytes.byteLength;
    if (this.#reader.done()) return false;
    this.#reader.append(bytes);
    let news = false;
    for (let record = this.#reader.nextRecord(); record; record = this.#reader.nextRecord()) {
      if (record.type === 'Channel') this.#topics.set(record.id, record.topic);
      if (record.type === 'Message') news = this.#take(this.#topics.get(record.channelId) ?? '', secondsOf(record.logTime), record.data) || news;
    }
    this.#forget();
    return news;
  }

  /** The file has its end: the run has ended. */
  get ended() {
    return this.#reader.done();
  }

  /** @param {string} topic @param {number} time_s @param {Uint8Array} data */
  #take(topic, time_s, data) {
    if (topic === '/machine') this.machine = jsonOf(data);
    else if (topic === '/motion') {
      const table = tableOf([{ channel: 0, time_s, data }]);
      if (!table.t_s.length) return false;
      this.motion.push(table);
      this.newest_s = table.t_s[table.t_s.length - 1];
      return true;
    } else if (topic === '/burnt') {
      const table = tableOf([{ channel: 0, time_s, data }]);
      this.burnt.push(table);
      // The message holds a second from its time on; only what comes later is to be taken from the motion.
      this.burnt_s = Math.max(this.burnt_s, time_s + 1);
    }
    return false;
  }

  #forget() {
    while (this.motion.length > 1 && this.motion[0].t_s[0] < this.newest_s - kMotion_s) this.motion.shift();
    while (this.burnt.length > 1 && (this.burnt[0].t_s[0] ?? 0) < this.newest_s - kBurnt_s) this.burnt.shift();
  }
}

/**
 * Follows an address to its end. Where the line breaks, it goes on from the byte that it has got to.
 * @param {(from: number) => string} urlFrom @param {LiveTrace} trace
 * @param {{news: () => void, signal: AbortSignal}} options
 * @returns {Promise<void>} when there is nothing more @throws {Error} where the server refuses
 */
export async function follow(urlFrom, trace, { news, signal }) {
  let broken = 0;
  while (!signal.aborted) {
    const before = trace.bytes;
    try {
      const answer = await fetch(urlFrom(trace.bytes), { signal, cache: 'no-store' });
      if (!answer.ok || !answer.body) throw new Refused(await reason(answer));
      const reader = answer.body.getReader();
      for (let part = await reader.read(); !part.done; part = await reader.read()) if (trace.append(part.value)) news();
      return;
    } catch (fault) {
      if (signal.aborted) return;
      broken = trace.bytes > before ? 0 : broken + 1;
      if (fault instanceof Refused || broken > 4) throw fault;
      await new Promise((resolve) => setTimeout(resolve, 300 * broken));
    }
  }
}

class Refused extends Error {}

/** @param {Response} answer */
async function reason(answer) {
  const said = await answer.json().catch(() => ({}));
  return said.error ?? `The server answered ${answer.status}.`;
}
