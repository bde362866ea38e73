// SPDX-License-Identifier: Apache-2.0
// @ts-check
// From a moment to the next of its kind: a period of the program, a pulse, a frame of the camera, a line of the program, a check.

import { countBefore, countUpTo } from '../trace/search.js';

/**
 * @typedef {'period' | 'pulse' | 'frame' | 'line' | 'check'} StepKind
 * @typedef {1 | -1} Direction
 * @typedef {import('../trace/trace.js').Trace} Trace
 */

/** Times nearer than this are the same: it is less than a tick of the fastest controllers. */
const kSame_s = 2e-9;

/** The next multiple of a period. @param {number} t_s @param {number} period_s @param {Direction} direction */
export function onGrid(t_s, period_s, direction) {
  const at = t_s / period_s;
  const k = direction > 0 ? Math.floor(at + 1e-6) + 1 : Math.ceil(at - 1e-6) - 1;
  return Math.max(0, k) * period_s;
}

/** The next of ascending times, undefined behind the last. @param {ArrayLike<number>} times @param {number} t_s @param {Direction} direction */
export function nextOf(times, t_s, direction) {
  const at = direction > 0 ? countUpTo(times, t_s + kSame_s) : countBefore(times, t_s - kSame_s) - 1;
  return at >= 0 && at < times.length ? times[at] : undefined;
}

/** Times of active edges of some PULs, ascending. @param {import('../trace/tables.js').PinTable} pins @param {{pul: number, active_edge: string}[]} drives @param {number} hz */
export function pulsesOf(pins, drives, hz) {
  /** @type {number[]} */
  const times = [];
  for (const { pul, active_edge } of drives) {
    const edges = pins.get(pul);
    if (!edges) continue;
    const first = edges.firstLevel === (active_edge === 'rising' ? 1 : 0) ? 0 : 1;
    for (let i = first; i < edges.ticks.length; i += 2) times.push(edges.ticks[i] / hz);
  }
  return times.sort((a, b) => a - b);
}

/**
 * The time of the next event of a kind, wherever in the trace it is.
 * @param {Trace} trace @param {StepKind} kind @param {number} t_s @param {Direction} direction
 * @returns {Promise<number | undefined>} undefined: there is none
 */
export async function stepFrom(trace, kind, t_s, direction) {
  const { machine } = trace;
  if (kind === 'period') return onGrid(t_s, machine.period_s ?? machine.quantum_s, direction);
  if (kind === 'check') {
    const times = trace.checks.map((check) => check.time_s ?? NaN).filter(Number.isFinite).sort((a, b) => a - b);
    return nextOf(times, t_s, direction);
  }
  if (kind === 'pulse') return inChunks(trace, '/pins', t_s, direction, (part) => pulsesOf(part, machine.drives, machine.tick_hz));
  if (kind === 'line') return inChunks(trace, '/gcode', t_s, direction, (part) => part.t_s);
  return inChunks(trace, trace.file.has('/spot') ? '/spot' : '/frames', t_s, direction, (part) => part.t_s ?? part.map(timeOfFrame));
}

/** @param {{timestamp: {sec: number, nsec: number}}} frame */
export const timeOfFrame = ({ timestamp: { sec, nsec } }) => sec + 1e-9 * nsec;

/**
 * Looks through the chunks of a topic, from the one at a time on.
 * @param {Trace} trace @param {string} topic @param {number} t_s @param {Direction} direction
 * @param {(part: any) => ArrayLike<number>} timesOf
 */
async function inChunks(trace, topic, t_s, direction, timesOf) {
  const indexes = trace.file.chunksOf(topic);
  const starts_s = indexes.map((index) => trace.file.chunks[index].start_s);
  // The chunk that begins last before the time; going forward, all of it may lie before.
  let at = countUpTo(starts_s, t_s + kSame_s) - 1;
  if (direction > 0) at = Math.max(0, at);
  for (; at >= 0 && at < indexes.length; at += direction) {
    const found = nextOf(timesOf(await trace.details.part(topic, indexes[at])), t_s, direction);
    if (found !== undefined) return found;
  }
  return undefined;
}
