// SPDX-License-Identifier: Apache-2.0
// Parts of the station's page: a run, its pins, what was tested, a bench.
// @ts-check
import { h } from '../shared/dom.js';
import { classOf, currentOf, leftWords, nextStep, outcomeOf, overOf, rateWords, timeWords } from './words.js';

/** @typedef {import('./words.js').Run} Run */
/** @typedef {import('./words.js').Bench} Bench */

/** @param {Run} run */
const nameOf = (run) => run.name ?? run.scenario;

/** Pins of a run on real ones. @param {import('./words.js').Pins} pins */
const pinsTable = (pins) =>
  h(
    'table',
    { class: 'station-pins' },
    h('caption', {}, `Pins, ${pins.now_s.toFixed(1)} s`),
    h(
      'thead',
      {},
      h('tr', {}, ['pin', 'level', 'edges', 'rate'].map((title) => h('th', { scope: 'col' }, title))),
    ),
    h(
      'tbody',
      {},
      pins.signals.map((signal, i) =>
        h(
          'tr',
          { class: pins.edges_per_s[i] > 0 ? 'busy' : null },
          h('th', { scope: 'row' }, signal),
          h('td', {}, pins.levels[i] ? 'high' : 'low'),
          h('td', { class: 'num' }, pins.edges[i]),
          h('td', { class: 'num' }, rateWords(pins.edges_per_s[i])),
        ),
      ),
    ),
    h(
      'tfoot',
      {},
      h(
        'tr',
        {},
        h('th', { scope: 'row' }, 'driven edges'),
        h('td', { colspan: 3, class: 'num' }, `worst lag ${pins.worst_lag_us.toFixed(1)} µs`),
      ),
    ),
  );

/** The run that goes on. @param {Run} run @param {(() => void) | null} stop */
export function currentCard(run, stop) {
  const share = run.progress.share;
  return h(
    'section',
    { class: 'station-current', 'aria-label': 'Run that goes on' },
    h('h2', {}, nameOf(run), run.serial_number && h('span', { class: 'serial' }, run.serial_number)),
    h(
      'progress',
      share === undefined ? { 'aria-label': 'progress' } : { value: share, max: 1, 'aria-label': 'progress' },
    ),
    h(
      'p',
      { class: 'mute' },
      [run.state === 'waiting' ? 'waits' : run.progress.what, leftWords(run.progress.left_s)].filter(Boolean).join(' · '),
    ),
    run.live.problems.map((text) => h('p', { class: 'fault', role: 'alert' }, text)),
    run.live.pins && pinsTable(run.live.pins),
    stop && h('button', { type: 'button', on: { click: stop } }, 'Stop'),
  );
}

/** What was tested, the newest first. @param {Run[]} runs @param {boolean} is_own whose reports this page can open @param {string} [caption] */
export const testedTable = (runs, is_own, caption = 'Tested') =>
  h(
    'table',
    { class: 'station-tested' },
    h('caption', {}, caption),
    h(
      'thead',
      {},
      h('tr', {}, ['time', 'serial number', 'scenario', 'result', 'report'].map((title) => h('th', { scope: 'col' }, title))),
    ),
    h(
      'tbody',
      {},
      runs.map((run) => {
        const outcome = outcomeOf(run);
        return h(
          'tr',
          {},
          h('td', { class: 'when' }, timeWords(run, new Date())),
          h('th', { scope: 'row' }, run.serial_number || 'without'),
          h('td', {}, nameOf(run)),
          h('td', {}, h('span', { class: `outcome ${classOf(outcome)}` }, outcome), run.problem && ` ${run.problem}`),
          h('td', {}, is_own && run.report && h('a', { href: run.report, target: '_blank', rel: 'noopener' }, 'Report')),
        );
      }),
    ),
  );

/** Another bench. @param {Bench} bench */
export function benchCard(bench) {
  const runs = bench.runs ?? [];
  const current = currentOf(runs);
  const over = overOf(runs);
  return h(
    'section',
    { class: `station-bench${bench.problem ? ' away' : ''}` },
    h('h2', {}, bench.folder || bench.name || bench.address, bench.name && h('span', { class: 'mute' }, `on ${bench.name}`)),
    bench.address && h('p', {}, h('a', { href: bench.address, target: '_blank', rel: 'noopener' }, bench.address)),
    bench.problem
      ? h('p', { class: 'fault' }, bench.problem)
      : [
          h('p', { class: 'next' }, nextStep(current, over[0])),
          current && currentCard(current, null),
          over.length > 0 && testedTable(over.slice(0, 5), false),
        ],
  );
}
