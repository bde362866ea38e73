// SPDX-License-Identifier: Apache-2.0
// The job page as a whole: its regions, its keys, and what is dropped onto it.
// @ts-check
import { fill, h, mark, say } from '../shared/dom.js';
import { icon } from '../shared/icons.js';
import { jobHash, keepJob } from '../shared/job_address.js';
import { shellBar } from '../shared/shell.js';
import { watch } from '../shared/store.js';
import { commandOf } from './command.js';
import { mountChoices } from './choices.js';
import { mountEarlier } from './earlier.js';
import { mountParameters } from './parameters.js';
import { mountRight } from './right.js';
import { mountRun } from './run_panel.js';
import { saveAs } from './save_as.js';
import { mountMiddle } from './stage/middle.js';
import * as S from './state.js';

/** @typedef {ReturnType<typeof import('../shared/store.js').createStore<S.State>>} Store */

/** @param {Element} root @param {Store} store @param {import('./actions.js').Actions} actions */
export function mountPage(root, store, actions) {
  const runArea = h('div', { class: 'run-area' });
  const left = h('section', { class: 'left', 'aria-label': 'Scenario' });
  const middle = h('main', { class: 'middle', 'aria-label': 'Drawing', id: 'drawing' });
  const right = h('section', { class: 'right', 'aria-label': 'G-code, order and text' });
  const page = h('div', { class: 'job-page' }, top(store, actions), runArea, left, middle, right, foot(store));
  fill(root, page);
  mountNotice(runArea, store);
  mountRun(runArea, store, actions);
  mountChoices(left, store, actions);
  mountParameters(left, store, actions);
  mountEarlier(left, store, actions);
  mountMiddle(middle, store, actions);
  mountRight(right, store, actions);
  takeDrops(store, actions);
  takeKeys(store, actions);
  watch(
    store,
    (state) => [S.isUnsettled(state), state.busy],
    (state) => page.setAttribute('aria-busy', String(S.isUnsettled(state) || state.busy !== '')),
  );
  watch(
    store,
    (state) => [state.job?.path, S.isChanged(state.job), state.run?.results],
    ({ job, run }) => {
      document.title = job ? `${S.isChanged(job) ? '• ' : ''}${job.path} · Kerfbench` : 'Kerfbench';
      // The verdict that is shown is part of the address: who comes back from its trace finds it here.
      const hash = jobHash({ scenario: job?.path, results: job && run?.scenario === job.path ? run.results : '' });
      if (!hash) return;
      keepJob(hash);
      if (location.hash !== hash) history.replaceState(null, '', hash);
    },
  );
  addEventListener('beforeunload', (event) => {
    if (S.isChanged(store.get().job)) event.preventDefault();
  });
}

/** @param {Store} store @param {import('./actions.js').Actions} actions */
function top(store, actions) {
  const name = h('b');
  const state = h('span', { class: 'state', role: 'status' });
  const save = () => (store.get().job?.readOnly ? saveAs(store, actions) : actions.save());
  const undo = h(
    'button',
    { class: 'plain', title: 'Undo (Ctrl Z)', 'aria-label': 'Undo', on: { click: () => store.update(S.undone) } },
    icon('undo'),
  );
  const redo = h(
    'button',
    { class: 'plain', title: 'Redo (Ctrl Shift Z)', 'aria-label': 'Redo', on: { click: () => store.update(S.redone) } },
    icon('redo'),
  );
  const saveButton = h('button', { id: 'save', title: 'Ctrl S', on: { click: save } }, 'Save');
  const saveAsButton = h('button', { id: 'save-as', on: { click: () => saveAs(store, actions) } }, 'Save as…');
  const start = h(
    'button',
    { id: 'start', class: 'primary', 'aria-describedby': 'why-not', on: { click: () => actions.start() } },
    'Start',
  );
  const why = h('span', { id: 'why-not', class: 'visually-hidden' });
  watch(
    store,
    (s) => [s.job, s.busy, s.check, s.plan, s.run, s.session, s.editing],
    (s) => {
      say(name, s.job ? s.job.path.slice(s.job.path.lastIndexOf('/') + 1) : '');
      mark(name, 'title', s.job?.path);
      const changed = S.isChanged(s.job);
      say(
        state,
        s.busy || (!s.job ? '' : s.job.readOnly && !changed ? 'shipped, read only' : changed ? 'not saved' : 'saved'),
      );
      state.classList.toggle('changed', changed && !s.busy);
      const reason = S.whyNotStart(s);
      start.disabled = reason !== '' || s.busy !== '';
      say(start, changed && !s.job?.readOnly ? 'Save and start' : 'Start');
      mark(start, 'title', reason || 'Runs this scenario on the twin (Ctrl Enter)');
      say(why, reason);
      undo.disabled = !s.job?.past.length;
      redo.disabled = !s.job?.future.length;
      saveButton.disabled = !s.job || (!changed && !s.job.readOnly);
      say(saveButton, s.job?.readOnly ? 'Save a copy…' : 'Save');
      saveAsButton.hidden = !s.job || s.job.readOnly;
      for (const button of [undo, redo, saveButton, start]) button.hidden = !s.job;
    },
  );
  return h(
    'header',
    { class: 'top' },
    h('a', { class: 'skip', href: '#drawing' }, 'To the drawing'),
    shellBar('job'),
    h('div', { class: 'what' }, name, state),
    h('div', { class: 'acts' }, undo, redo, saveButton, saveAsButton, start, why),
  );
}

/** @param {Store} store */
function foot(store) {
  const code = h('code', { id: 'command', tabindex: 0 });
  const told = h('span', { class: 'visually-hidden', role: 'status' });
  const copy = h(
    'button',
    {
      class: 'plain',
      id: 'copy-command',
      on: {
        click: async () => {
          try {
            await navigator.clipboard.writeText(code.textContent ?? '');
            say(told, 'Copied.');
            say(copy, 'Copied');
          } catch {
            // Without the right to write the clipboard the text is at least selected.
            getSelection()?.selectAllChildren(code);
            say(copy, 'Press Ctrl C');
          }
        },
      },
    },
    'Copy',
  );
  watch(
    store,
    (s) => [s.job?.path, s.run, s.session],
    (s) => {
      say(code, commandOf(s));
      say(copy, 'Copy');
    },
  );
  return h('footer', { class: 'foot' }, h('span', { class: 'prompt' }, 'Same in a terminal'), code, copy, told);
}

/** What went wrong with the last thing that was asked for. @param {Element} element @param {Store} store */
function mountNotice(element, store) {
  const words = h('div');
  const close = h(
    'button',
    {
      class: 'plain',
      'aria-label': 'Close this message',
      on: { click: () => store.update(S.having({ notice: null })) },
    },
    icon('close'),
  );
  const box = h('div', { class: 'notice', id: 'notice', role: 'alert', hidden: true }, words, close);
  element.append(box);
  watch(
    store,
    (s) => [s.notice],
    ({ notice }) => {
      box.hidden = !notice;
      box.classList.toggle('done', notice?.kind === 'done');
      fill(
        words,
        notice && h('p', {}, notice.text),
        notice &&
          notice.issues.length > 0 &&
          h(
            'ul',
            {},
            notice.issues.map((issue) =>
              h('li', {}, issue.file ? `${issue.file}${issue.line ? `:${issue.line}` : ''}: ` : '', issue.message),
            ),
          ),
        notice?.acts?.length
          ? h(
              'div',
              { class: 'acts' },
              notice.acts.map(({ title, act }) =>
                h('button', { on: { click: () => (store.update(S.having({ notice: null })), act()) } }, title),
              ),
            )
          : null,
      );
    },
  );
}

/** @param {Store} store @param {import('./actions.js').Actions} actions */
function takeDrops(store, actions) {
  const dragging = (/** @type {boolean} */ on) => document.body.classList.toggle('dragging', on);
  const hasFiles = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes('Files');
  addEventListener('dragover', (event) => {
    if (!hasFiles(event)) return;
    event.preventDefault();
    dragging(true);
  });
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) dragging(false);
  });
  addEventListener('drop', (event) => {
    dragging(false);
    if (!hasFiles(event)) return;
    event.preventDefault();
    actions.take([...(event.dataTransfer?.files ?? [])]);
  });
}

/** @param {Store} store @param {import('./actions.js').Actions} actions */
function takeKeys(store, actions) {
  addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    const typing = event.target instanceof HTMLElement && event.target.closest('input, textarea, .cm-editor');
    if (key === 's') {
      event.preventDefault();
      if (store.get().job?.readOnly) saveAs(store, actions);
      else if (S.isChanged(store.get().job)) actions.save();
    } else if (key === 'enter' && !S.whyNotStart(store.get())) {
      event.preventDefault();
      actions.start();
    } else if (key === 'z' && !typing) {
      event.preventDefault();
      store.update(event.shiftKey ? S.redone : S.undone);
    }
  });
}
