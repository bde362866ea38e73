// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Edges of the pins in a span of time, by signal.

import { countBefore } from './search.js';

/**
 * @typedef {import('./tables.js').PinTable} PinTable
 * @typedef {{ticks: Float64Array, levelBefore: number}} Pin edges within the span, each toggles; level before the first
 * @typedef {{from_tick: number, to_tick: number, pins: Map<number, Pin>}} PinWindow [from_tick, to_tick)
 */

/**
 * Joins the tables of chunks that follow each other.
 * @param {PinTable[]} parts they cover the span; edges outside are left out
 * @param {Map<number, number>} levels of all signals just before from_tick
 * @param {number} from_tick @param {number} to_tick
 * @returns {PinWindow}
 */
export function joinedPins(parts, levels, from_tick, to_tick) {
  /** @type {Map<number, Pin>} */
  const pins = new Map();
  const ids = new Set(levels.keys());
  for (const part of parts) for (const id of part.keys()) ids.add(id);
  for (const id of ids) {
    const pieces = [];
    let length = 0;
    let levelBefore = levels.get(id) ?? 0;
    for (const part of parts) {
      const edges = part.get(id);
      if (!edges) continue;
      const first = countBefore(edges.ticks, from_tick);
      const piece = edges.ticks.subarray(first, countBefore(edges.ticks, to_tick));
      if (!piece.length) continue;
      // The edges themselves know best: their levels are exact at any tick.
      if (length === 0) levelBefore = 1 ^ edges.firstLevel ^ (first & 1);
      pieces.push(piece);
      length += piece.length;
    }
    const ticks = new Float64Array(length);
    let at = 0;
    for (const piece of pieces) {
      ticks.set(piece, at);
      at += piece.length;
    }
    pins.set(id, { ticks, levelBefore });
  }
  return { from_tick, to_tick, pins };
}
