// SPDX-License-Identifier: Apache-2.0
// Asks for the name under which a scenario is saved. A copy of a shipped one has its names of files rewritten by the server.
// @ts-check
import { h, say } from '../shared/dom.js';
import { freeName } from './arrivals.js';
import * as S from './state.js';

/** What is wrong with a name, in a sentence; empty: nothing. @param {string} name without .yaml @param {Set<string>} taken paths */
export function faultOfName(name, taken) {
  if (name === '') return 'A name is needed.';
  if (!/^[A-Za-z0-9_][A-Za-z0-9 ._-]*$/.test(name)) return 'Letters, digits, space, “-”, “_” and “.” may be in a name.';
  return taken.has(`${name}.yaml`) ? 'There is one of this name.' : '';
}

/** @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
export function saveAs(store, actions) {
  const { job, files } = store.get();
  if (!job) return;
  const taken = new Set(/** @type {{path: string}[]} */ (files.scenarios).map((f) => f.path));
  const stem = job.path.slice(job.path.lastIndexOf('/') + 1).replace(/\.ya?ml$/, '');
  const input = h('input', {
    id: 'new-name',
    value: freeName(`${stem}.yaml`, taken).replace(/\.yaml$/, ''),
    autocomplete: 'off',
    spellcheck: 'false',
    'aria-describedby': 'new-name-fault',
  });
  const fault = h('p', { class: 'fault', id: 'new-name-fault', role: 'status' });
  const save = h('button', { class: 'primary', type: 'submit' }, 'Save');
  const look = () => {
    const wrong = faultOfName(input.value.trim(), taken);
    say(fault, wrong);
    save.disabled = wrong !== '';
    input.setAttribute('aria-invalid', String(wrong !== ''));
  };
  const dialog = h(
    'dialog',
    { 'aria-labelledby': 'new-name-title', on: { close: () => dialog.remove() } },
    h(
      'form',
      {
        method: 'dialog',
        on: {
          submit: () => {
            const name = input.value.trim();
            if (faultOfName(name, taken) !== '') return;
            if (S.isShipped(job.path)) actions.copy(job.path, name);
            else actions.save(`${job.path.slice(0, job.path.lastIndexOf('/') + 1)}${name}.yaml`);
          },
        },
      },
      h('h2', { id: 'new-name-title' }, job.readOnly ? 'Save a copy of this scenario' : 'Save under another name'),
      h('label', { for: 'new-name' }, 'Name'),
      input,
      fault,
      h('div', { class: 'acts' }, h('button', { type: 'button', on: { click: () => dialog.close() } }, 'Cancel'), save),
    ),
  );
  input.addEventListener('input', look);
  document.body.append(dialog);
  look();
  dialog.showModal();
  input.select();
}
