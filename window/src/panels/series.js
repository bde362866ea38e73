// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Curves over time out of the trace, thinned to what a picture can show: the least and the greatest of each column of it.

/** @typedef {{t_s: Float64Array | number[], value: Float64Array | number[]}} Curve NaN: a gap */

/**
 * Keeps first, least, greatest and last of each of `columns` equal spans of time.
 * @param {Curve} curve @param {{from: number, to: number}} span @param {number} columns
 * @returns {{t_s: number[], value: (number | null)[]}} null: a gap
 */
export function thinned({ t_s, value }, span, columns) {
  /** @type {{t_s: number[], value: (number | null)[]}} */
  const thin = { t_s: [], value: [] };
  const column = (span.to - span.from) / columns;
  for (let i = 0; i < t_s.length; ) {
    const place = Math.floor((t_s[i] - span.from) / column);
    let [first, least, greatest] = [i, -1, -1];
    for (; i < t_s.length && Math.floor((t_s[i] - span.from) / column) === place; ++i) {
      if (Number.isNaN(value[i])) continue;
      if (least < 0 || value[i] < value[least]) least = i;
      if (greatest < 0 || value[i] > value[greatest]) greatest = i;
    }
    const kept = least < 0 ? [first] : [...new Set([first, least, greatest, i - 1])].sort((a, b) => a - b);
    for (const k of kept) {
      thin.t_s.push(t_s[k]);
      thin.value.push(Number.isNaN(value[k]) ? null : value[k]);
    }
  }
  return thin;
}

/**
 * Speed along a path over the sheet, mm/s: the path in W less the sheet's own motion, over two rows.
 * @param {import('../trace/tables.js').Table} motion @returns {Curve}
 */
export function spotSpeed({ t_s, columns }) {
  const rows = t_s.length;
  const value = new Float64Array(rows).fill(NaN);
  const web = (/** @type {number} */ i) => (columns.belt_mm?.[i] ?? 0) + (columns.slip_x_mm?.[i] ?? 0);
  const slip = (/** @type {number} */ i) => columns.slip_y_mm?.[i] ?? 0;
  for (let i = 1; i < rows; ++i) {
    const dx = columns.spot_x_mm[i] - columns.spot_x_mm[i - 1] - (web(i) - web(i - 1));
    const dy = columns.spot_y_mm[i] - columns.spot_y_mm[i - 1] - (slip(i) - slip(i - 1));
    value[i] = Math.hypot(dx, dy) / (t_s[i] - t_s[i - 1]);
  }
  return { t_s, value };
}

/** Speed of a column that is a place, mm/s. @param {import('../trace/tables.js').Table} motion @param {string} name @returns {Curve} */
export function speedOf({ t_s, columns }, name) {
  const value = new Float64Array(t_s.length).fill(NaN);
  for (let i = 1; i < t_s.length; ++i) value[i] = (columns[name][i] - columns[name][i - 1]) / (t_s[i] - t_s[i - 1]);
  return { t_s, value };
}

/**
 * A column of the overview: its greatest value of each interval.
 * @param {import('../trace/overview.js').OverviewPart[]} parts @param {string} name @returns {Curve}
 */
export function overviewCurve(parts, name) {
  /** @type {number[]} */
  const t_s = [];
  /** @type {number[]} */
  const value = [];
  for (const { from_s, step_s, rows, columns } of parts) {
    for (let row = 0; row < rows; ++row) {
      t_s.push(from_s + (row + 0.5) * step_s);
      value.push(columns[name]?.max[row] ?? NaN);
    }
  }
  return { t_s, value };
}

/** Mean speed of a place of the overview between intervals, mm/s. @param {import('../trace/overview.js').OverviewPart[]} parts @param {string} name @returns {Curve} */
export function overviewSpeed(parts, name) {
  const { t_s, value } = overviewCurve(parts, name);
  return { t_s, value: Float64Array.from(t_s, (t, i) => (i > 0 ? (value[i] - value[i - 1]) / (t - t_s[i - 1]) : NaN)) };
}
