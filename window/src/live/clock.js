// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The time at which a run that goes on is shown: a little behind the newest that has come, and moving evenly although what
// comes does so in lumps. A run is faster or slower than real time, and its speed changes; so does that of this clock.

/**
 * @typedef {{t_s: number, rate: number, newest_s: number, arrivals: {at_s: number, newest_s: number}[]}} LiveClock
 *   time shown, simulated seconds a second; newest time that has come, and when the latest ones came
 */

const kWindow_s = 1.2; // Over so much of the viewer's time the run's speed is measured.
const kDelay_s = 0.15; // So far behind it is shown, in the viewer's time.
const kPull = 1.5; // Share of a departure from that delay which is made good each second.

/** @returns {LiveClock} */
export const startClock = () => ({ t_s: NaN, rate: 0, newest_s: NaN, arrivals: [] });

/** Something has come. @param {LiveClock} clock @param {number} at_s the viewer's time @param {number} newest_s @returns {LiveClock} */
export function arrived(clock, at_s, newest_s) {
  const arrivals = [...clock.arrivals.filter((one) => at_s - one.at_s < kWindow_s), { at_s, newest_s }];
  const [first] = arrivals;
  const passed_s = at_s - first.at_s;
  const rate = passed_s > 0.2 ? (newest_s - first.newest_s) / passed_s : clock.rate;
  return { t_s: Number.isNaN(clock.t_s) ? newest_s : clock.t_s, rate, newest_s, arrivals };
}

/**
 * Goes on by a time of the viewer's: never beyond what has come, never backwards.
 * @param {LiveClock} clock @param {number} elapsed_s @param {boolean} ended nothing more will come @returns {LiveClock}
 */
export function ticked(clock, elapsed_s, ended) {
  if (Number.isNaN(clock.t_s)) return clock;
  const rate = Math.max(clock.rate, 1e-3);
  const wanted_s = ended ? clock.newest_s : clock.newest_s - kDelay_s * rate;
  // Far behind, as after the page was hidden, it jumps.
  if (wanted_s - clock.t_s > 4 * rate) return { ...clock, t_s: wanted_s };
  const step_s = rate * elapsed_s + Math.min(1, kPull * elapsed_s) * (wanted_s - clock.t_s - rate * elapsed_s);
  return { ...clock, t_s: Math.min(clock.newest_s, clock.t_s + Math.max(0, step_s)) };
}
