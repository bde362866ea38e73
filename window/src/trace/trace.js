// SPDX-License-Identifier: Apache-2.0
// @ts-check
// A trace as the views ask for it: the machine once, the overview at once, and details by moment or span of time. What is
// asked for and not yet read is undefined, and a listener hears when it has come.

import { Details } from './details.js';
import { TraceFile } from './file.js';
import { Overview } from './overview.js';
import { joinedPins } from './pins.js';
import { jsonOf } from './records.js';
import { lastUpTo, momentOf } from './rows.js';

/**
 * @typedef {import('./machine.js').Machine} Machine
 * @typedef {import('./machine.js').Check} Check
 * @typedef {import('./tables.js').Table} Table
 * @typedef {import('./pins.js').PinWindow} PinWindow
 * @typedef {import('./readable.js').Readable} Readable
 */

/** A message holds less than this from its first row on (docs/reference/trace.md). */
export const kMessage_s = 0.02;
const kBurntMessage_s = 1;
const kBack = 3; // Chunks before a moment in which what was last is looked for.
const kPinWindows = 4;
const kGrid_s = 0.1; // The finest overview: it has the levels of all pins at these times.

export class Trace {
  /** @param {TraceFile} file @param {Machine} machine @param {Check[]} checks @param {Overview} overview @param {Details} details */
  constructor(file, machine, checks, overview, details) {
    this.file = file;
    this.machine = machine;
    this.checks = checks;
    this.overview = overview;
    this.details = details;
    this.extent_s = extentOf(file, overview);
    /** Windows of pins that were joined lately, the latest last. @type {Map<string, PinWindow>} */
    this.pinWindows = new Map();
  }

  /** @param {Readable} readable @returns {Promise<Trace>} @throws {Error} that says why it cannot be shown */
  static async open(readable) {
    const file = await TraceFile.open(readable);
    const [first] = await file.messagesOf('/machine');
    if (!first) throw new Error('the trace does not say what machine it is of');
    const checks = (await file.messagesOf('/checks')).map((message) => jsonOf(message.data));
    const details = new Details(file);
    const overview = new Overview(details);
    await overview.open();
    return new Trace(file, jsonOf(first.data), checks, overview, details);
  }

  /** @param {() => void} listener @returns {() => void} */
  onLoad(listener) {
    return this.details.onLoad(listener);
  }

  /** Machine and laser at a moment. @param {number} t_s */
  motionAt(t_s) {
    return momentOf(this.#tables('/motion', t_s, t_s + 2 * this.machine.quantum_s), t_s);
  }

  /** Where the pulses have led the beam. @param {number} t_s */
  commandedAt(t_s) {
    return momentOf(this.#tables('/commanded', t_s, t_s + 2 * this.machine.quantum_s), t_s);
  }

  /** Rows of a topic of columns, as far as they have come. @param {string} topic @param {number} from_s @param {number} to_s @returns {Table[]} */
  rows(topic, from_s, to_s) {
    return this.#tables(topic, from_s, to_s);
  }

  /** The line of the program and the unit at a moment; line 0: none. @param {number} t_s */
  lineAt(t_s) {
    const row = this.#lastRow('/gcode', t_s);
    return row && { line: row.line, unit: row.unit, since_s: row.t_s };
  }

  /** The spot as it was measured last. @param {number} t_s */
  spotAt(t_s) {
    return this.#lastRow('/spot', t_s);
  }

  /**
   * Edges of all pins in a span of time that begins and ends on the overview's grid; undefined until all of it has come.
   * @param {number} from_s @param {number} to_s @returns {PinWindow | undefined}
   */
  pins(from_s, to_s) {
    const from = kGrid_s * Math.floor(from_s / kGrid_s + 1e-9);
    const to = kGrid_s * Math.ceil(to_s / kGrid_s - 1e-9);
    const { parts, complete } = this.details.peek('/pins', from - kMessage_s, to);
    const levels = this.overview.levelsAt(from);
    if (!complete || !levels) return undefined;
    const key = `${from} ${to} ${parts.length}`;
    const hz = this.machine.tick_hz;
    const window = this.pinWindows.get(key) ?? joinedPins(parts, levels, Math.round(from * hz), Math.round(to * hz));
    this.pinWindows.delete(key);
    this.pinWindows.set(key, window);
    if (this.pinWindows.size > kPinWindows) this.pinWindows.delete(this.pinWindows.keys().next().value ?? '');
    return window;
  }

  /** Burnt paths of a span of time. @param {number} from_s @param {number} to_s */
  burnt(from_s, to_s) {
    const { parts, complete } = this.details.peek('/burnt', from_s - kBurntMessage_s, to_s);
    return { tables: /** @type {Table[]} */ (parts), complete };
  }

  /** Messages that are no columns (words, frames), by time. @param {string} topic @param {number} from_s @param {number} to_s */
  messages(topic, from_s, to_s) {
    return /** @type {any[]} */ (this.details.peek(topic, from_s, to_s).parts.flat());
  }

  /** @param {string} topic @param {number} from_s @param {number} to_s @returns {Table[]} */
  #tables(topic, from_s, to_s) {
    return this.details.peek(topic, from_s - kMessage_s, to_s).parts;
  }

  /** @param {string} topic @param {number} t_s */
  #lastRow(topic, t_s) {
    return this.lastIn(topic, t_s, (part) => lastUpTo([part], t_s));
  }

  /**
   * What was last up to a moment, in the last chunk that has it. A chunk that begins before the moment may have it only later: then
   * it is in one before.
   * @template T
   * @param {string} topic @param {number} t_s @param {(part: any) => T | undefined} find in a chunk's part
   * @returns {T | undefined} undefined also while it comes
   */
  lastIn(topic, t_s, find) {
    for (const index of this.file.chunksOf(topic, -Infinity, t_s).slice(-kBack).reverse()) {
      const part = this.details.peekPart(topic, index);
      if (part === undefined) return undefined;
      const found = part === null ? undefined : find(part);
      if (found !== undefined) return found;
    }
    return undefined;
  }
}

/** @param {TraceFile} file @param {Overview} overview */
function extentOf(file, overview) {
  return { from: 0, to: overview.end_s || file.extent_s.to };
}
