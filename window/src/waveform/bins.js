// SPDX-License-Identifier: Apache-2.0
// @ts-check
// From the edges of a pin to what fits into the columns of a picture. Where a column has one edge at most, the line of the
// pin can be drawn; where it has more, only how many there are.

import { countBefore } from '../trace/search.js';

/**
 * @typedef {{from_px: number, to_px: number, dense: boolean, level: number, edges: number, first: number}} Run
 *   a stretch of columns, [from_px, to_px); level before its first edge; index of its first edge
 */

/**
 * Number of edges in each column: an edge belongs to column floor((tick - from) / perPixel).
 * @param {ArrayLike<number>} edges ascending @param {number} from @param {number} perPixel @param {number} width
 * @returns {Uint32Array}
 */
export function edgesPerColumn(edges, from, perPixel, width) {
  const counts = new Uint32Array(width);
  let before = countBefore(edges, from);
  for (let x = 0; x < width; ++x) {
    const upTo = countBefore(edges, from + (x + 1) * perPixel);
    counts[x] = upTo - before;
    before = upTo;
  }
  return counts;
}

/**
 * Stretches that are dense (two edges in a column, or columns with edges side by side that would touch) and those whose edges can be told
 * apart. Together they cover all columns.
 * @param {ArrayLike<number>} edges ascending ticks; each toggles the level @param {number} levelBefore level before the first edge
 * @param {number} from @param {number} perPixel @param {number} width columns
 * @returns {Run[]}
 */
export function runsOf(edges, levelBefore, from, perPixel, width) {
  const counts = edgesPerColumn(edges, from, perPixel, width);
  /** @type {Run[]} */
  const runs = [];
  let at = countBefore(edges, from);
  for (let x = 0; x < width; ) {
    const dense = isDense(counts, x);
    const run = { from_px: x, to_px: x, dense, level: levelBefore ^ (at & 1), edges: 0, first: at };
    while (x < width && isDense(counts, x) === dense) run.edges += counts[x++];
    run.to_px = x;
    at += run.edges;
    runs.push(run);
  }
  return runs;
}

/** @param {Uint32Array} counts @param {number} x */
function isDense(counts, x) {
  if (counts[x] > 1) return true;
  // A column with one edge or none between two dense ones would flicker as a gap.
  return x > 0 && x + 1 < counts.length && counts[x - 1] > 1 && counts[x + 1] > 1;
}
