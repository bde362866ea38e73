// SPDX-License-Identifier: Apache-2.0
// The run: how far it is, how to stop it, what came of it.
// @ts-check
import { fill, h, say } from '../shared/dom.js';
import { icon } from '../shared/icons.js';
import { watch } from '../shared/store.js';
import { resultPath } from './actions.js';
import { checkChosen } from './links.js';
import * as R from './run.js';
import * as S from './state.js';
import { findingChosen, itemsOf } from './stage/findings.js';

/** Lines of G-code that are told beside the verdict. */
const kMostByHand = 3;
const kKinds = ['pass', 'fail', 'unproven', 'invalid'];

/** @param {Element} element @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
export function mountRun(element, store, actions) {
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
  const verdict = h('p', { class: 'verdict' });
  const earlier = h('p', { class: 'earlier-job', id: 'earlier-job', role: 'status', hidden: true });
  const words = h('p', { class: 'words' });
  const bar = h('progress', { max: 1, 'aria-label': 'Progress of the run' });
  const links = h('div', { class: 'links' });
  const notes = h('ul', { class: 'by-hand', id: 'by-hand', 'aria-label': 'G-code by hand', hidden: true });
  const checks = h('ul', { class: 'checks' });
  const log = h('pre', { tabindex: 0, 'aria-label': 'What the bench says' });
  const lines = h('details', {}, h('summary', {}, 'What the bench says'), log);
  const box = h(
    'section',
    { class: 'run', id: 'run', 'aria-label': 'Run', hidden: true },
    verdict,
    h('div', {}, earlier, words, bar),
    links,
    notes,
    checks,
    lines,
  );
  element.append(spoken, box);
  markEarlier(box, earlier, store);
  tellByHand(notes, store);
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
      const summary = R.withTitles(run.judged?.summary ?? R.endWords(run), run.judged);
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
      const bad = going ? [] : R.groupedChecks(run.judged);
      checks.hidden = bad.length === 0 && !(run.judged?.problems?.length > 0);
      fill(
        checks,
        (going ? [] : (run.judged?.problems ?? [])).map((/** @type {any} */ p) =>
          h('li', {}, h('span', {}, R.withTitles(typeof p === 'string' ? p : (p.text ?? p.message ?? ''), run.judged))),
        ),
        bad.map(({ check, along }) => checkRow(check, run, store, along)),
      );
      lines.hidden = run.log.length === 0;
      say(log, R.withTitles(run.log.join('\n'), run.judged));
    },
  );
}

/**
 * What is not as drawn in G-code by hand, above the checks of a run that failed: as a rule it is the reason.
 * @param {any} list @param {import('./page.js').Store} store
 */
function tellByHand(list, store) {
  watch(
    store,
    (s) => [s.run, s.job, s.plan, s.check.value],
    (s) => {
      const { run } = s;
      const failed = run && !S.isGoing(run) && run.verdict !== null && run.verdict !== 'PASS';
      const items = failed && S.isByHand(s) && !S.isOfEarlierJob(s) ? itemsOf(s).filter((i) => i.line !== null) : [];
      list.hidden = items.length === 0;
      fill(
        list,
        items.slice(0, kMostByHand).map((item) =>
          h(
            'li',
            {},
            h(
              'button',
              { title: 'Show the line and its place', on: { click: () => store.update((now) => findingChosen(now, item)) } },
              h('b', {}, `${item.place}: `),
              h('span', {}, item.message),
            ),
          ),
        ),
        items.length > kMostByHand && h('li', {}, `${items.length - kMostByHand} more are listed below the drawing.`),
      );
    },
  );
}

/** What is said over the verdict of a job that was changed since. @param {Element} box @param {Element} earlier @param {import('./page.js').Store} store */
function markEarlier(box, earlier, store) {
  watch(
    store,
    (s) => [s.run, s.job, s.plan],
    (s) => {
      const is = S.isOfEarlierJob(s);
      box.classList.toggle('of-earlier', is);
      const other = s.run && s.job && s.job.path !== s.run.scenario ? ` ${s.run.scenario}` : '';
      say(earlier, is ? `Of the job${other} before it was changed. Start again for a verdict on what is here now.` : '');
      /** @type {any} */ (earlier).hidden = !is;
    },
  );
}

/**
 * A check that is not good. Where its worst value has a place, a click on its title leads there in drawing and G-code; where it has a
 * time, a link leads there in the trace.
 * What it brings along is folded below it.
 * @param {any} check of verdict.json @param {S.Run} run @param {import('./page.js').Store} store @param {any[]} [along]
 */
function checkRow(check, run, store, along = []) {
  const title = `${check.verdict === 'FAIL' ? '' : `${check.verdict}: `}${check.title}${check.subject ? ` (${check.subject})` : ''}`;
  const where = R.placeOf(check);
  const name = where
    ? h(
        'button',
        {
          class: 'to-place',
          title: 'Show the place in drawing and G-code',
          on: { click: () => store.update((s) => checkChosen(s, where)) },
        },
        title,
      )
    : h('b', {}, title);
  const at_s = check.where?.time_s;
  return h(
    'li',
    { class: where ? 'has-place' : null },
    name,
    h('span', {}, R.figureWords(check)),
    h(
      'p',
      {},
      R.withTitles(check.explanation ?? '', run.judged),
      run.trace &&
        typeof at_s === 'number' && [' ', h('a', { href: traceHref(run, at_s) }, `Trace at ${at_s.toFixed(4)} s`)],
    ),
    along.length > 0 &&
      h(
        'details',
        { class: 'along' },
        h('summary', {}, along.length === 1 ? 'Brings one more check along' : `Brings ${along.length} more checks along`),
        h('ul', {}, along.map((each) => checkRow(each, run, store))),
      ),
  );
}

/** @param {S.Run} run @param {number} [at_s] */
const traceHref = (run, at_s) =>
  `/view?trace=${encodeURIComponent(run.trace)}&job=${encodeURIComponent(run.scenario)}${at_s === undefined ? '' : `#t=${at_s.toFixed(6)}`}`;

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
          href: traceHref(run, at_s),
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
