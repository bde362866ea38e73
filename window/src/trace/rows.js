// SPDX-License-Identifier: Apache-2.0
// @ts-check
// One moment out of tables of columns.

import { countBefore, countUpTo } from './search.js';

/** @typedef {import('./tables.js').Table} Table */

/** Columns that hold since the row before, up to their own: they are not on a line between two rows. */
const kSteps = new Set(['power_w', 'lit']);

/**
 * The rows just before a time (or at it) and from it on, in tables that follow each other.
 * @param {Table[]} tables @param {number} t_s
 * @returns {{before?: [Table, number], after?: [Table, number]}}
 */
export function rowsAround(tables, t_s) {
  /** @type {[Table, number] | undefined} */
  let before;
  for (const table of tables) {
    const at = countBefore(table.t_s, t_s);
    if (at > 0) before = [table, at - 1];
    if (at < table.t_s.length) return { before, after: [table, at] };
  }
  return { before };
}

/**
 * All columns at a time: places and angles on the straight line between the rows around it, power and light as they were
 * in that interval. Before the first row and after the last one it is that row.
 * @param {Table[]} tables @param {number} t_s @returns {Record<string, number> | undefined} undefined: no rows
 */
export function momentOf(tables, t_s) {
  const { before, after } = rowsAround(tables, t_s);
  const [table, at] = after ?? before ?? [];
  if (!table || at === undefined) return undefined;
  /** @type {Record<string, number>} */
  const moment = {};
  const share = before && after ? (t_s - before[0].t_s[before[1]]) / (table.t_s[at] - before[0].t_s[before[1]]) : 1;
  for (const [name, column] of Object.entries(table.columns)) {
    const to = column[at];
    const from = before && after && !kSteps.has(name) ? before[0].columns[name]?.[before[1]] ?? NaN : to;
    moment[name] = share === 1 ? to : from + share * (to - from);
  }
  return moment;
}

/**
 * The last row at or before a time, of tables whose rows hold until the next.
 * @param {Table[]} tables @param {number} t_s @returns {Record<string, number> | undefined}
 */
export function lastUpTo(tables, t_s) {
  for (let i = tables.length - 1; i >= 0; --i) {
    const at = countUpTo(tables[i].t_s, t_s) - 1;
    if (at < 0) continue;
    /** @type {Record<string, number>} */
    const row = { t_s: tables[i].t_s[at] };
    for (const [name, column] of Object.entries(tables[i].columns)) row[name] = column[at];
    return row;
  }
  return undefined;
}
