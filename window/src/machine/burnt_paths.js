// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Burnt paths as segments, from what the trace tells of them or, before it does, from the motion.

import { countUpTo } from '../trace/search.js';

/** @typedef {import('../trace/tables.js').Table} Table */

const kAbove_mm = 0.12; // Over the board's face, so that the line is not lost in it.

/**
 * Segments of burnt paths: pairs of points, in order of time.
 * @param {Table[]} tables of `/burnt`
 * @returns {{ends_s: Float64Array, starts_s: Float64Array, points: Float32Array}} points: x, y, z of both ends of each, in S of unit 0
 */
export function segmentsOf(tables) {
  const rows = tables.reduce((sum, table) => sum + table.t_s.length, 0);
  const starts_s = new Float64Array(rows);
  const ends_s = new Float64Array(rows);
  const points = new Float32Array(6 * rows);
  let n = 0;
  for (const { t_s, columns: { x_mm, y_mm, start } } of tables) {
    for (let i = 1; i < t_s.length; ++i) {
      if (start[i]) continue;
      starts_s[n] = t_s[i - 1];
      ends_s[n] = t_s[i];
      points.set([x_mm[i - 1], y_mm[i - 1], kAbove_mm, x_mm[i], y_mm[i], kAbove_mm], 6 * n);
      ++n;
    }
  }
  return { starts_s: starts_s.subarray(0, n), ends_s: ends_s.subarray(0, n), points: points.subarray(0, 6 * n) };
}

/**
 * Burnt paths as the motion has them, for the time of which the trace does not tell them yet.
 * @param {Table[]} motion @param {number} from_s @param {number} start_x_mm place of S of unit 0 in W at belt 0
 * @returns {Table}
 */
export function burntFrom(motion, from_s, start_x_mm) {
  /** @type {{t: number[], x: number[], y: number[], start: number[]}} */
  const rows = { t: [], x: [], y: [], start: [] };
  let lit = false;
  for (const { t_s, columns } of motion) {
    for (let i = countUpTo(t_s, from_s); i < t_s.length; ++i) {
      const x = columns.spot_x_mm[i] - start_x_mm - (columns.belt_mm?.[i] ?? 0) - (columns.slip_x_mm?.[i] ?? 0);
      const y = columns.spot_y_mm[i] - (columns.slip_y_mm?.[i] ?? 0);
      const burns = columns.lit[i] > 0.5 && Number.isFinite(x + y);
      if (burns) {
        rows.t.push(t_s[i]);
        rows.x.push(x);
        rows.y.push(y);
        rows.start.push(lit ? 0 : 1);
      }
      lit = burns;
    }
  }
  return { t_s: Float64Array.from(rows.t), columns: { x_mm: Float64Array.from(rows.x), y_mm: Float64Array.from(rows.y), start: Float64Array.from(rows.start) } };
}
