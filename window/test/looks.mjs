// SPDX-License-Identifier: Apache-2.0
// What all panels of the viewer ask a trace for at a moment, without a browser: to count what a jump reads. The browser's test holds the
// page itself to the same counts.
import { framesAt, nextFrame, wayTo } from '../src/panels/frames_panel.js';

/** Time for which what was burnt is in sight, as the machine's panel has it, at most. */
const kBurnt_s = 60;

/**
 * Asks once. @param {import('../src/trace/trace.js').Trace} trace @param {number} t_s @param {number} span_s around it, of waveform and plots
 * @returns {boolean} whether all was there
 */
function ask(trace, t_s, span_s) {
  const [from, to] = [Math.max(0, t_s - span_s / 2), t_s + span_s / 2];
  const { views, belt_mm_s } = trace.machine;
  const reach_s = belt_mm_s > 0 ? Math.min(kBurnt_s, (views.overall.max_mm[0] - views.overall.min_mm[0]) / belt_mm_s) : kBurnt_s;
  trace.motionAt(t_s);
  trace.commandedAt(t_s);
  trace.lineAt(t_s);
  trace.spotAt(t_s);
  trace.burnt(t_s - reach_s, t_s + 1);
  trace.pins(Math.max(0, t_s - 0.05), t_s + 0.05);
  trace.pins(from, to);
  trace.rows('/motion', from, to);
  trace.rows('/motion', t_s - 0.06, t_s);
  trace.rows('/commanded', t_s - 0.06, t_s);
  trace.rows('/spot', from, to);
  trace.rows('/spot', t_s - 1.5, t_s);
  const [frame] = framesAt(trace, t_s);
  nextFrame(trace, t_s);
  wayTo(trace, frame, t_s);
  return !trace.details.waiting;
}

/** Looks at a moment until all panels have what they want. @param {import('../src/trace/trace.js').Trace} trace @param {number} t_s @param {number} [span_s] */
export async function lookAt(trace, t_s, span_s = 0.1) {
  while (!ask(trace, t_s, span_s)) await new Promise((go) => setImmediate(go));
}
