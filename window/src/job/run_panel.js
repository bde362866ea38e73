// SPDX-License-Identifier: Apache-2.0
// The run: how far it is, how to stop it, what came of it.
// @ts-check
import { fill, h, say } from '../shared/dom.js';
import { icon } from '../shared/icons.js';
import { watch } from '../shared/store.js';
import { resultPath } from './actions.js';
import * as R from './run.js';
import * as S from './state.js';

const kKinds = ['pass', 'fail', 'unproven', 'invalid'];

/** @param {Element} element @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
export function mountRun(element, store, actions) {
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
  const verdict = h('p', { class: 'verdict' });
  const words = h('p', { class: 'words' });
  const bar = h('progress', { max: 1, 'aria-label': 'Progress of the run' });
  const links = h('div', { class: 'links' });
  const checks = h('ul', { class: 'checks' });
  const log = h('pre', { tabindex: 0 });
  const lines = h('details', {}, h('summary', {}, 'What the bench says'), log);
  const box = h(
    'section',
    { class: 'run', id: 'run', 'aria-label': 'Run', hidden: true },
    verdict,
    h('div', {}, words, bar),
    links,
    checks,
    lines,
  );
  element.append(spoken, box);
  watch(
    store,
    (s) => [s.run],
    ({ run }) => {
      box.hidden = !run;
      if (!run) return;
      const going = S.isGoing(run);
      const kind = R.verdictKind(run.verdict);
      for (const name of kKinds) box.classList.toggle(name, !going && name === kind);
      say(verdict, going ? '' : (run.verdict ?? (run.state === 'stopped' ? 'Stopped' : 'No verdict')));
      verdict.hidden = going;
      const summary = run.judged?.summary ?? R.endWords(run);
      say(words, going ? R.progressWords(run) : summary || `${run.verdict}.`);
      bar.hidden = !going;
      if (run.share === null) bar.removeAttribute('value');
      else bar.value = run.share;
      say(
        spoken,
        going
          ? R.spokenProgress(run)
          : `${run.verdict ?? (run.state === 'stopped' ? 'Stopped' : 'No verdict')}. ${summary}`,
      );
      fill(links, linksOf(run, store, actions));
      const bad = going ? [] : R.badChecks(run.judged);
      checks.hidden = bad.length === 0 && !(run.judged?.problems?.length > 0);
      fill(
        checks,
        (going ? [] : (run.judged?.problems ?? [])).map((/** @type {any} */ p) =>
          h('li', {}, h('span', {}, typeof p === 'string' ? p : (p.text ?? p.message ?? ''))),
        ),
        bad.map(checkRow),
      );
      lines.hidden = run.log.length === 0;
      say(log, run.log.join('\n'));
    },
  );
}

/** @param {any} check of verdict.json */
function checkRow(check) {
  return h(
    'li',
    {},
    h('b', {}, `${check.verdict === 'FAIL' ? '' : `${check.verdict}: `}${check.title}${check.subject ? ` (${check.subject})` : ''}`),
    h('span', {}, R.figureWords(check)),
    h('p', {}, check.explanation),
  );
}

/** @param {S.Run} run @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function linksOf(run, store, actions) {
  if (S.isGoing(run))
    return [
      h(
        'button',
        { id: 'stop', disabled: run.stopping || run.id === '', on: { click: () => actions.stop() } },
        run.stopping ? 'Stopping…' : 'Stop',
      ),
    ];
  const report = run.report || (run.results ? resultPath(run.results, 'report.html') : '');
  const at_s = R.badChecks(run.judged)
    .map((/** @type {any} */ c) => c.where?.time_s)
    .find((/** @type {any} */ t) => typeof t === 'number');
  return [
    report &&
      h(
        'a',
        {
          class: 'button',
          href: report.startsWith('/') ? report : `/results/${report}`,
          target: '_blank',
          rel: 'noreferrer',
        },
        'Report',
      ),
    run.trace &&
      h(
        'a',
        {
          class: 'button',
          href: `/view?trace=${encodeURIComponent(run.trace)}${at_s === undefined ? '' : `#t=${at_s.toFixed(6)}`}`,
        },
        at_s === undefined ? 'Trace' : 'Trace at this moment',
      ),
    h(
      'button',
      { class: 'plain', 'aria-label': 'Close the result', on: { click: () => store.update(S.having({ run: null })) } },
      icon('close'),
    ),
  ];
}
