// SPDX-License-Identifier: Apache-2.0
// The right of the page: G-code, the order of the cuts, and the scenario as text.
// @ts-check
import { yaml } from '@codemirror/lang-yaml';
import { fill, h, say } from '../shared/dom.js';
import { watch } from '../shared/store.js';
import { createEditor } from './editor.js';
import { lineChosen, linesOfEntities } from './links.js';
import { momentAt } from './motion.js';
import { mountOrder } from './order_panel.js';
import * as S from './state.js';
import { motionOf } from './stage/painter.js';

/** @typedef {import('./page.js').Store} Store */

const kTabs = [
  ['gcode', 'G-code'],
  ['order', 'Order'],
  ['text', 'Scenario'],
];

/** @param {Element} element @param {Store} store @param {import('./actions.js').Actions} actions */
export function mountRight(element, store, actions) {
  const panels = kTabs.map(([id]) =>
    h('div', { class: 'tab-panel', id: `panel-${id}`, role: 'tabpanel', 'aria-labelledby': `tab-${id}`, hidden: true }),
  );
  const choose = (/** @type {number} */ at, focus = false) =>
    kTabs.forEach(([id], i) => {
      tabs[i].setAttribute('aria-selected', String(i === at));
      tabs[i].tabIndex = i === at ? 0 : -1;
      panels[i].hidden = i !== at;
      if (i === at && focus) tabs[i].focus();
    });
  const tabs = kTabs.map(([id, title], i) =>
    h(
      'button',
      {
        id: `tab-${id}`,
        role: 'tab',
        'aria-controls': `panel-${id}`,
        on: {
          click: () => choose(i),
          keydown: (/** @type {KeyboardEvent} */ event) => {
            const sense = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
            if (sense !== 0) choose((i + sense + kTabs.length) % kTabs.length, true);
          },
        },
      },
      title,
    ),
  );
  element.append(
    h('div', { class: 'tabs', role: 'tablist', 'aria-label': 'G-code, order, scenario' }, tabs),
    ...panels,
  );
  const none = h(
    'p',
    { class: 'nothing' },
    'The G-code, the order of the cuts and the text of the scenario are here once there is one.',
  );
  element.append(none);
  watch(
    store,
    (s) => [s.job === null],
    (s) => {
      none.hidden = s.job !== null;
      element.classList.toggle('without-job', s.job === null);
    },
  );
  mountGcode(panels[0], store, actions);
  mountOrder(panels[1], store, actions);
  mountText(panels[2], store);
  choose(0);
}

/** @param {Element} panel @param {Store} store @param {import('./actions.js').Actions} actions */
function mountGcode(panel, store, actions) {
  const origin = h('span');
  const again = h(
    'button',
    {
      class: 'plain',
      id: 'plan-again',
      on: {
        click: () => {
          store.update((s) => S.gcodeEdited(s, null));
          if (store.get().check.value?.values?.['planner.gcode'])
            actions.setKeys([{ path: 'planner.gcode', value: null }]);
        },
      },
    },
    'Plan anew',
  );
  const download = h(
    'button',
    {
      class: 'plain',
      on: {
        click: () => {
          const { job } = store.get();
          const link = h('a', {
            download: `${(job?.path ?? 'job').replace(/^.*\//, '').replace(/\.ya?ml$/, '')}.gcode`,
            href: URL.createObjectURL(new Blob([S.gcodeOf(store.get())], { type: 'text/plain' })),
          });
          link.click();
          URL.revokeObjectURL(link.href);
        },
      },
    },
    'Download',
  );
  const fault = h('p', { class: 'fault', role: 'status' });
  const holder = h('div', { class: 'editor', id: 'gcode' });
  panel.append(h('div', { class: 'panel-head' }, origin, h('span', { class: 'gap' }), again, download, fault), holder);
  const editor = createEditor(holder, {
    label: 'G-code',
    onText: (text) =>
      store.update((s) =>
        S.gcodeEdited(s, text === (s.plan.value?.gcode ?? '') && s.job?.gcode === null ? null : text),
      ),
    onLine: (line) => store.update((s) => lineChosen(s, line)),
  });
  const issues = (/** @type {S.State} */ s) =>
    (s.plan.state === 'ready' ? s.plan.value.issues : []).filter((/** @type {any} */ i) => i.line > 0);
  watch(
    store,
    (s) => [s.job?.gcode, s.plan.value?.gcode, s.job?.path],
    (s) => editor.setText(S.gcodeOf(s)),
  );
  watch(
    store,
    (s) => [s.plan],
    (s) =>
      editor.setIssues(issues(s).map((/** @type {any} */ i) => ({ ...i, message: S.withoutLine(i) }))),
  );
  watch(
    store,
    (s) => [s.selected, s.line, s.plan, nowLine(s)],
    (s) => {
      const chosen = linesOfEntities(s.plan.value?.entity_lines, s.selected);
      editor.mark({
        chosen: s.line === null || chosen.includes(s.line) ? chosen : [...chosen, s.line],
        now: nowLine(s),
        faults: issues(s)
          .filter((/** @type {any} */ i) => i.severity !== 'warning')
          .map((/** @type {any} */ i) => i.line),
      });
    },
  );
  watch(
    store,
    (s) => [s.line, nowLine(s)],
    (s) => {
      const line = s.playing || s.line === null ? nowLine(s) : s.line;
      if (line !== null) editor.show(line);
    },
  );
  watch(
    store,
    (s) => [s.job, s.plan, s.check.value],
    (s) => {
      const byHand = S.isByHand(s);
      const file = s.check.value?.values?.['planner.gcode'];
      say(
        origin,
        !s.job
          ? ''
          : s.job.gcode !== null
            ? 'By hand, not saved'
            : byHand
              ? `By hand: ${file}`
              : 'Planned; edit it to make it yours',
      );
      again.hidden = !byHand;
      download.hidden = S.gcodeOf(s) === '';
      const first = issues(s).find((/** @type {any} */ i) => i.severity !== 'warning');
      const words = first
        ? `G-code, line ${first.line}: ${S.withoutLine(first)}`
        : s.plan.state === 'failed' && S.obstacles({ ...s, plan: { ...s.plan, state: 'none' } }).length === 0
          ? (s.plan.fault?.message ?? '')
          : '';
      say(fault, words);
      fault.hidden = words === '';
    },
  );
}

/** Line of G-code at which the preview is, once it has begun. @param {S.State} s */
function nowLine(s) {
  const motion = s.period > 0 ? motionOf(s) : null;
  return motion ? momentAt(motion, s.period).line : null;
}

/** @param {Element} panel @param {Store} store */
function mountText(panel, store) {
  const words = h('span');
  const holder = h('div', { class: 'editor', id: 'text' });
  panel.append(h('div', { class: 'panel-head' }, words), holder);
  const editor = createEditor(holder, {
    label: 'Scenario, YAML',
    language: yaml(),
    onText: (text) => store.update((s) => S.edited(s, text)),
  });
  watch(
    store,
    (s) => [s.job?.text],
    (s) => editor.setText(s.job?.text ?? ''),
  );
  watch(
    store,
    (s) => [s.check.value],
    (s) => {
      const own = (s.check.value?.issues ?? []).filter((/** @type {any} */ i) => (i.file ?? '') === '');
      editor.setIssues(own);
      editor.mark({
        chosen: [],
        now: null,
        faults: own.filter((/** @type {any} */ i) => i.severity !== 'warning').map((/** @type {any} */ i) => i.line),
      });
      const errors = own.filter((/** @type {any} */ i) => i.severity !== 'warning').length;
      fill(
        words,
        !s.job
          ? ''
          : errors > 0
            ? `${errors} ${errors === 1 ? 'fault' : 'faults'}, marked at their lines`
            : 'As it is written to the file; comments stay',
      );
    },
  );
}
