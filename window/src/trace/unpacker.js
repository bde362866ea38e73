// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Unpacks chunks by workers where the page has them, else in the page itself: a page that stands alone may not ask for a script.

import { unpackedChunk } from './records.js';

/* global kWorkerScript */
/** Put in by build.mjs: the worker's script beside the page's own, '' for none. @type {string} */
const script = typeof kWorkerScript === 'undefined' ? '' : kWorkerScript;
const kWorkers = 2;

class Unpacker {
  /** @type {Worker[]} */
  #workers = [];
  /** @type {Map<number, {resolve: (records: Uint8Array) => void, reject: (fault: Error) => void}>} */
  #waiting = new Map();
  #next = 0;

  constructor() {
    if (!script || typeof Worker === 'undefined') return;
    for (let i = 0; i < kWorkers; ++i) {
      const worker = new Worker(new URL(script, import.meta.url), { type: 'module' });
      worker.addEventListener('message', ({ data: { id, records, fault } }) => {
        const waiting = this.#waiting.get(id);
        this.#waiting.delete(id);
        if (records) waiting?.resolve(records);
        else waiting?.reject(new Error(fault));
      });
      // A worker that does not start, as where a policy forbids it, is not missed.
      worker.addEventListener('error', () => this.#giveUp());
      this.#workers.push(worker);
    }
  }

  /** @param {Uint8Array} content of a chunk's record @returns {Promise<Uint8Array>} its records @throws {Error} as unpackedChunk() */
  unpack(content) {
    if (!this.#workers.length) return Promise.resolve().then(() => unpackedChunk(content));
    const id = this.#next++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject });
      // A copy goes over: the content is part of a block that others read.
      const copy = content.slice();
      this.#workers[id % this.#workers.length].postMessage({ id, content: copy }, [copy.buffer]);
    }).catch((fault) => {
      if (fault instanceof GaveUp) return unpackedChunk(content);
      throw fault;
    });
  }

  #giveUp() {
    for (const worker of this.#workers) worker.terminate();
    this.#workers = [];
    for (const { reject } of this.#waiting.values()) reject(new GaveUp());
    this.#waiting.clear();
  }
}

class GaveUp extends Error {}

/** One for the page: workers are few, traces may be several. @type {Unpacker | undefined} */
let unpacker;

/** @param {Uint8Array} content of a chunk's record @returns {Promise<Uint8Array>} */
export function unpacked(content) {
  unpacker ??= new Unpacker();
  return unpacker.unpack(content);
}
