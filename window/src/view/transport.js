// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The bar with which time is moved: play, step by what, how fast, and where the cursor is.

import { h, mark, say } from '../shared/dom.js';
import { kSpeeds } from '../time/timeline.js';
import { stepFrom } from '../time/steps.js';
import { duration, moment, speedWords } from './format.js';

/** @typedef {import('../time/steps.js').StepKind} StepKind */

/** @type {[StepKind, string][]} */
const kKinds = [['period', 'period'], ['pulse', 'pulse'], ['frame', 'frame'], ['line', 'G-code line'], ['check', 'check']];

/** @param {import('../trace/trace.js').Trace} trace @param {ReturnType<typeof import('../time/timeline.js').createTimeline>} timeline */
export function transport(trace, timeline) {
  /** @type {StepKind} */
  let kind = 'period';
  const note = h('span', { class: 'mute tv-transport-note', role: 'status' });
  const play = button('Play', 'Play or pause (space)', () => timeline.play(), 'primary');
  const period_s = trace.machine.period_s ?? trace.machine.quantum_s;
  const choice = h('select', { 'aria-label': 'Step by', on: { change: () => { kind = choice.value; } } },
    kKinds.map(([value, words]) => h('option', { value }, value === 'period' ? `period, ${duration(period_s)}` : words)));
  const speed = h('select', { 'aria-label': 'Speed', title: 'Simulated time for time (digits 1 to 9)', on: { change: () => timeline.update((state) => ({ ...state, speed: Number(speed.value) })) } },
    kSpeeds.map((value) => h('option', { value: String(value) }, speedWords(value))));
  const time = h('input', { class: 'tv-time number', 'aria-label': 'Time of the cursor, seconds', spellcheck: 'false', autocomplete: 'off', on: {
    change: () => {
      const t_s = Number(time.value.replace(/[\s\u2009]|s$/g, ''));
      if (Number.isFinite(t_s)) timeline.go(t_s);
      tell();
    },
    focus: () => time.select(),
  } });
  const marks = h('span', { class: 'tv-marks number', role: 'status', 'aria-label': 'Time between the marks A and B' });

  /** The latest step wins: one that is still looked for when the next is asked for counts from where it will end. */
  let last = Promise.resolve();
  function step(/** @type {StepKind} */ by, /** @type {import('../time/steps.js').Direction} */ direction, count = 1) {
    timeline.play(false);
    last = last.then(async () => {
      for (let i = 0; i < count; ++i) {
        const to = await stepFrom(trace, by, timeline.get().t_s, direction);
        if (to === undefined) {
          say(note, `no ${direction > 0 ? 'later' : 'earlier'} ${by === 'line' ? 'line' : by}`);
          return;
        }
        say(note, '');
        timeline.go(to);
      }
    }).catch((fault) => say(note, fault.message));
    return last;
  }

  function tell() {
    const { t_s, playing, speed: now, a_s, b_s } = timeline.get();
    if (document.activeElement !== time) time.value = `${moment(t_s)} s`;
    say(play, playing ? 'Pause' : 'Play');
    mark(play, 'aria-pressed', String(playing));
    speed.value = String(now);
    say(marks, a_s !== null && b_s !== null ? `A–B ${duration(Math.abs(b_s - a_s), 7)}` : '');
  }
  tell();
  const element = h('div', { class: 'tv-transport', role: 'toolbar', 'aria-label': 'Time' },
    button('⇤', 'To the start (Home)', () => timeline.go(timeline.get().extent.from)),
    button('‹', 'Step back', () => step(kind, -1)), play, button('›', 'Step on', () => step(kind, 1)),
    button('⇥', 'To the end (End)', () => timeline.go(timeline.get().extent.to)),
    h('label', { class: 'tv-labelled' }, h('span', {}, 'Step'), choice), h('label', { class: 'tv-labelled' }, h('span', {}, 'Speed'), speed), time, marks, note);
  return { element, step, close: timeline.subscribe(tell) };
}

/** @param {string} words @param {string} label @param {() => void} act @param {string} [tone] */
function button(words, label, act, tone = '') {
  return h('button', { type: 'button', class: tone, title: label, 'aria-label': tone ? null : label, on: { click: act } }, words);
}
