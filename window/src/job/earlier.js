// SPDX-License-Identifier: Apache-2.0
// Earlier runs of the scenario, with their verdicts, reports and traces.
// @ts-check
import { h, keyed } from '../shared/dom.js';
import { watch } from '../shared/store.js';
import { resultPath } from './actions.js';
import { verdictKind } from './run.js';

const kMost = 8;

/** @typedef {{ path: string, scenario: string, verdict: string | null, when: string }} EarlierRun */

/** The newest runs of a scenario. @param {{ runs?: EarlierRun[] }} files @param {string | undefined} name @returns {EarlierRun[]} */
export const runsOf = (files, name) => (files.runs ?? []).filter((run) => run.scenario === name).slice(0, kMost);

/** "2026-11-28 16:05" in the time of whoever looks. @param {string} when ISO, UTC */
export function whenWords(when) {
  const at = new Date(when);
  if (Number.isNaN(at.getTime())) return when;
  const two = (/** @type {number} */ n) => String(n).padStart(2, '0');
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())} ${two(at.getHours())}:${two(at.getMinutes())}`;
}

/** @param {Element} element @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
export function mountEarlier(element, store, actions) {
  const list = h('ul');
  const box = h('div', { class: 'block' }, h('h2', {}, 'Earlier runs'), list);
  element.append(box);
  const make = (/** @type {EarlierRun & { trace: string, job: string }} */ run) => {
    const words = run.verdict ?? 'no verdict';
    return h(
      'li',
      { class: 'earlier' },
      h(
        'button',
        {
          class: `plain ${verdictKind(run.verdict)}`,
          title: 'Show this verdict above',
          'aria-label': `${words}, show the verdict of ${run.when}`,
          on: { click: () => void actions.showResult(run.path) },
        },
        words,
      ),
      h('span', {}, whenWords(run.when)),
      h(
        'a',
        {
          href: resultPath(run.path, 'report.html'),
          target: '_blank',
          rel: 'noreferrer',
          'aria-label': `Report of ${run.when}`,
        },
        'Report',
      ),
      run.trace &&
        h(
          'a',
          {
            href: `/view?trace=${encodeURIComponent(run.trace)}&job=${encodeURIComponent(run.job)}`,
            'aria-label': `Trace of ${run.when}`,
          },
          'Trace',
        ),
    );
  };
  watch(
    store,
    (s) => [s.files, s.check.value?.name, s.job?.path],
    (s) => {
      const traces = new Set((s.files.traces ?? []).map((/** @type {any} */ t) => t.path));
      const runs = s.job ? runsOf(s.files, s.check.value?.name) : [];
      box.hidden = runs.length === 0;
      const shown = runs.map((run) => ({
        ...run,
        trace: traces.has(`${run.path}/run.mcap`) ? `${run.path}/run.mcap` : '',
        job: s.job?.path ?? '',
      }));
      keyed(list, shown, (run) => `${run.path} ${run.trace} ${run.job}`, make);
    },
  );
}
