// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What a drive asks of its pulses, measured at one active edge of PUL: how long DIR had been still before it and stays
// still after it, how long PUL stays active and had been idle.

import { countBefore, countUpTo } from '../trace/search.js';

/**
 * @typedef {{ticks: ArrayLike<number>, levelBefore: number}} Edges edges of a pin, ascending, and its level before the first
 * @typedef {{tick: number, setup: number, hold: number, width: number, space: number, dir: number}} PulseTimes
 *   tick of the active edge; the rest in ticks, Infinity where there is no such edge in what is loaded; level of DIR at it
 */

/** Level of a pin at a tick, an edge at that tick included. @param {Edges} pin @param {number} tick */
export function levelAt(pin, tick) {
  return pin.levelBefore ^ (countUpTo(pin.ticks, tick) & 1);
}

/**
 * The active edge of PUL that is nearest to a tick, and the times around it.
 * @param {Edges} pul @param {Edges} dir @param {boolean} rising whether PUL is active high @param {number} tick
 * @returns {PulseTimes | undefined} undefined without any active edge
 */
export function pulseAt(pul, dir, rising, tick) {
  const index = nearestActive(pul, rising, tick);
  if (index === undefined) return undefined;
  const at = pul.ticks[index];
  // A change of DIR at the very tick of the edge gives no set-up at all: it counts as before the edge.
  const changed = countUpTo(dir.ticks, at);
  return {
    tick: at,
    setup: changed > 0 ? at - dir.ticks[changed - 1] : Infinity,
    hold: changed < dir.ticks.length ? dir.ticks[changed] - at : Infinity,
    width: index + 1 < pul.ticks.length ? pul.ticks[index + 1] - at : Infinity,
    space: index > 0 ? at - pul.ticks[index - 1] : Infinity,
    dir: levelAt(dir, at),
  };
}

/** @param {Edges} pul @param {boolean} rising @param {number} tick */
function nearestActive(pul, rising, tick) {
  // The edge with an even index leaves the level before the first one.
  const parity = (pul.levelBefore === 0) === rising ? 0 : 1;
  const after = countBefore(pul.ticks, tick);
  const next = after + ((after + parity) & 1);
  const previous = next - 2;
  const hasNext = next < pul.ticks.length;
  if (previous < 0) return hasNext ? next : undefined;
  if (!hasNext) return previous;
  return pul.ticks[next] - tick < tick - pul.ticks[previous] ? next : previous;
}
