// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Messages of columns (docs/reference/trace.md) as tables: one for all messages of a topic in a chunk.

import { jsonOf } from './records.js';
import { countBefore, countUpTo } from './search.js';

/**
 * @typedef {{t_s: Float64Array, columns: Record<string, Float64Array>}} Table rows in ascending order of time; NaN: not known
 * @typedef {{ticks: Float64Array, firstLevel: number}} PinEdges level after the first edge; edges toggle
 * @typedef {Map<number, PinEdges>} PinTable by signal
 * @typedef {import('./records.js').Message} Message
 */

/** Joins messages of columns. @param {Message[]} messages @returns {Table} */
export function tableOf(messages) {
  const parsed = messages.map((message) => jsonOf(message.data));
  const rows = parsed.reduce((sum, one) => sum + one.t_s.length, 0);
  /** @type {Table} */
  const table = { t_s: new Float64Array(rows), columns: {} };
  let at = 0;
  for (const one of parsed) {
    for (const [name, values] of Object.entries(one)) {
      if (!Array.isArray(values)) continue;
      const column = name === 't_s' ? table.t_s : (table.columns[name] ??= new Float64Array(rows).fill(NaN));
      for (let i = 0; i < values.length; ++i) column[at + i] = values[i] ?? NaN;
    }
    at += one.t_s.length;
  }
  return table;
}

/** Sorts the edges of messages of `/pins` by signal. @param {Message[]} messages @returns {PinTable} */
export function pinTableOf(messages) {
  const parsed = messages.map((message) => jsonOf(message.data));
  /** @type {Map<number, number>} */
  const counts = new Map();
  for (const { id } of parsed) for (const signal of id) counts.set(signal, (counts.get(signal) ?? 0) + 1);
  /** @type {PinTable} */
  const pins = new Map();
  for (const [signal, count] of counts) pins.set(signal, { ticks: new Float64Array(count), firstLevel: -1 });
  /** @type {Map<number, number>} */
  const filled = new Map();
  for (const { tick0, dt, id, level } of parsed) {
    let tick = tick0;
    for (let i = 0; i < id.length; ++i) {
      tick += dt[i];
      const edges = /** @type {PinEdges} */ (pins.get(id[i]));
      const at = filled.get(id[i]) ?? 0;
      if (at === 0) edges.firstLevel = level[i];
      edges.ticks[at] = tick;
      filled.set(id[i], at + 1);
    }
  }
  return pins;
}

/**
 * Joins the rows of several tables that follow each other in time.
 * @param {Table[]} tables @param {string[]} names columns wanted; one that a table lacks is NaN there
 * @returns {Table}
 */
export function joined(tables, names) {
  const rows = tables.reduce((sum, table) => sum + table.t_s.length, 0);
  /** @type {Table} */
  const all = { t_s: new Float64Array(rows), columns: {} };
  for (const name of names) all.columns[name] = new Float64Array(rows).fill(NaN);
  let at = 0;
  for (const table of tables) {
    all.t_s.set(table.t_s, at);
    for (const name of names) if (table.columns[name]) all.columns[name].set(table.columns[name], at);
    at += table.t_s.length;
  }
  return all;
}

/** Rows with times in [from_s, to_s]: first index and one past the last. @param {Table} table @param {number} from_s @param {number} to_s */
export function rowsIn(table, from_s, to_s) {
  return { first: countBefore(table.t_s, from_s), end: countUpTo(table.t_s, to_s) };
}
