// SPDX-License-Identifier: Apache-2.0
// The parameters that a scenario sets, each with unit, range, help and what is wrong with it; and a search for the others.
// @ts-check
import { fill, h, keyed, mark, say } from '../shared/dom.js';
import { icon } from '../shared/icons.js';
import { markup } from '../shared/markup.js';
import { watch } from '../shared/store.js';
import * as R from './reference.js';
import * as S from './state.js';

/** @typedef {import('./reference.js').Key} Key */

/** @param {Element} element @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
export function mountParameters(element, store, actions) {
  const groups = h('div');
  const box = h('div', { class: 'block' }, h('h2', {}, 'Parameters'), groups, adder(store, actions));
  element.append(box);
  const context = (/** @type {S.State} */ s) => ({
    values: s.check.value?.values ?? {},
    own: new Set(s.check.value?.own ?? []),
    issues: S.issuesByKey(s),
    faults: s.editFault,
  });
  watch(
    store,
    (s) => [s.reference, s.check.value, s.editFault, s.job === null],
    (s) => {
      box.hidden = !s.job;
      const now = context(s);
      keyed(
        groups,
        R.setKeys(s.reference, now.values),
        (group) => group.title,
        (group) => h('fieldset', { class: 'group' }, h('legend', {}, group.title), h('div')),
        (set, group) =>
          keyed(
            set.lastElementChild,
            group.keys,
            (key) => key.path,
            (key) => makeRow(key, actions),
            (row, key) => row.show(key, now),
          ),
      );
    },
  );
}

/** @param {Key} key @param {import('./actions.js').Actions} actions */
function makeRow(key, actions) {
  const id = `key-${key.path.replace(/\W+/g, '-')}`;
  const label = h('label', { for: id, title: key.path }, R.label(key));
  const fault = h('p', { class: 'fault', id: `${id}-fault`, role: 'status', hidden: true });
  const help = h('div', { class: 'help', id: `${id}-help`, hidden: true });
  /** @param {string} words @param {boolean} [warning] */
  const wrong = (words, warning = false) => {
    say(fault, words);
    fault.hidden = words === '';
    fault.classList.toggle('warning', warning);
    mark(input, 'aria-invalid', words !== '' && !warning ? 'true' : null);
  };
  let shown = '';
  const enter = (/** @type {string} */ text) => {
    if (text === shown) return wrong('');
    const read = R.parsed(key, text);
    if ('fault' in read) return wrong(read.fault);
    wrong('');
    actions.setKeys([{ path: key.path, value: read.value }]);
  };
  const input = makeField(key, id, enter);
  const about = h(
    'button',
    {
      class: 'plain',
      'aria-label': `Help on ${R.label(key)}`,
      'aria-expanded': 'false',
      'aria-controls': help.id,
      on: {
        click: () => {
          if (!help.firstChild) fill(help, helpOf(key));
          help.hidden = !help.hidden;
          about.setAttribute('aria-expanded', String(!help.hidden));
        },
      },
    },
    '?',
  );
  const remove = h(
    'button',
    {
      class: 'plain',
      'aria-label': `Remove ${R.label(key)}`,
      title: 'Remove: the default holds again',
      on: { click: () => actions.setKeys([{ path: key.path, value: null }]) },
    },
    icon('close'),
  );
  const unit = key.unit ? h('span', { class: 'unit', 'aria-hidden': 'true' }, key.unit) : null;
  const field = h('div', { class: unit ? 'field has-unit' : 'field' }, input, unit);
  field.style.setProperty('--unit', `${key.unit?.length ?? 0}ch`);
  const row = h('div', { class: 'row' }, label, field, about, remove, fault, help);
  input.setAttribute('aria-describedby', `${fault.id} ${help.id}`);
  row.show = (/** @type {Key} */ _, /** @type {any} */ now) => {
    shown = R.fieldText(now.values[key.path]);
    if (document.activeElement !== input || input.tagName !== 'INPUT') setField(input, key, shown, now.values);
    const inherited =
      !now.own.has(key.path) &&
      ![...now.own].some((path) => path.startsWith(`${key.path}[`) || path.startsWith(`${key.path}.`));
    row.classList.toggle('inherited', inherited);
    mark(label, 'title', inherited ? `${key.path}, from the file that this one extends` : key.path);
    remove.style.visibility = inherited || key.required ? 'hidden' : 'visible';
    const issues = now.issues.get(key.path) ?? [];
    const words = now.faults[key.path] ?? issues.map((/** @type {any} */ i) => i.message).join(' ');
    wrong(
      words,
      words !== '' && !now.faults[key.path] && issues.every((/** @type {any} */ i) => i.severity === 'warning'),
    );
  };
  return row;
}

/** Is it entered as text in the scenario alone? @param {Key} key */
const isStructure = (key) => key.kind === 'list' || key.kind === 'section';

/** @param {Key} key @param {string} id @param {(text: string) => void} enter */
function makeField(key, id, enter) {
  if (isStructure(key)) return h('output', { id, class: 'value-text' });
  if (key.kind === 'flag' || (key.kind === 'choice' && !key.or_file)) {
    const choices = key.kind === 'flag' ? ['true', 'false'] : key.choices;
    const select = h(
      'select',
      { id, on: { change: () => enter(select.value) } },
      choices.map((c) => h('option', { value: c }, c)),
    );
    return select;
  }
  const input = h('input', {
    id,
    type: 'text',
    autocomplete: 'off',
    spellcheck: 'false',
    inputmode: key.kind === 'number' ? 'decimal' : null,
    on: {
      change: () => enter(input.value),
      keydown: (/** @type {KeyboardEvent} */ event) => {
        if (event.key === 'Enter') enter(input.value);
      },
    },
  });
  return input;
}

/** @param {any} field @param {Key} key @param {string} text @param {Record<string, any>} values */
function setField(field, key, text, values) {
  if (isStructure(key)) return say(field, structureWords(key, values));
  if (field.tagName === 'SELECT' && ![...field.options].some((o) => o.value === text)) {
    const words = text === '' ? structureWords(key, values) : text;
    field.append(h('option', { value: text, disabled: true }, words));
  }
  if (field.value !== text) field.value = text;
}

/** How many entries a list or a section has. @param {Key} key @param {Record<string, any>} values */
function structureWords(key, values) {
  const of_list = new Set(
    Object.keys(values)
      .filter((p) => p.startsWith(`${key.path}[`))
      .map((p) => p.slice(key.path.length).split(']')[0]),
  );
  const of_section = Object.keys(values).filter((p) => p.startsWith(`${key.path}.`)).length;
  const value = values[key.path];
  const count = Array.isArray(value) ? value.length : of_list.size || of_section;
  return `${count} ${of_section ? (count === 1 ? 'key' : 'keys') : count === 1 ? 'entry' : 'entries'}`;
}

/** @param {Key} key */
function helpOf(key) {
  const range = R.rangeWords(key);
  const fact = (/** @type {string} */ name, /** @type {string} */ words) =>
    words && [h('dt', {}, name), h('dd', {}, words)];
  return [
    h('div', {}, markup(key.help_html)),
    h(
      'dl',
      {},
      fact('Key', key.path),
      fact('Range', range && `${range}${key.unit ? ` ${key.unit}` : ''}`),
      fact('Default', key.required ? 'required' : key.default),
      isStructure(key) && fact('Change it', 'in the tab “Scenario”'),
    ),
  ];
}

/** A search over the parameters that are not set. @param {import('./page.js').Store} store @param {import('./actions.js').Actions} actions */
function adder(store, actions) {
  const input = h('input', {
    id: 'add-parameter',
    type: 'search',
    autocomplete: 'off',
    spellcheck: 'false',
    'aria-controls': 'found',
  });
  const list = h('ul', { class: 'found', id: 'found', hidden: true });
  const count = h('p', { class: 'visually-hidden', role: 'status' });
  const add = async (/** @type {Key} */ key) => {
    input.value = '';
    show();
    await actions.setKeys([{ path: key.path, value: R.firstValue(key) }]);
    // The row is there as soon as the scenario was checked.
    const id = `key-${key.path.replace(/\W+/g, '-')}`;
    const seen = store.subscribe(() => {
      const field = document.getElementById(id);
      if (!field) return;
      seen();
      field.scrollIntoView({ block: 'center' });
      field.focus();
      /** @type {any} */ (field).select?.();
    });
  };
  const show = () => {
    const { reference, check } = store.get();
    const values = check.value?.values ?? {};
    const asked = input.value.trim();
    const keys = asked === '' ? [] : R.addable(reference, values, asked);
    list.hidden = asked === '';
    say(count, asked === '' ? '' : `${keys.length} parameters fit.`);
    fill(
      list,
      keys.map((key) =>
        h(
          'li',
          {},
          h(
            'button',
            { on: { click: () => add(key) } },
            key.path,
            h('small', {}, R.plainWords(key.help_html).split(/(?<=\.)\s/)[0]),
          ),
        ),
      ),
      asked !== '' && keys.length === 0 && h('li', { class: 'none' }, 'No parameter fits.'),
    );
  };
  const step = (/** @type {KeyboardEvent} */ event) => {
    const buttons = /** @type {HTMLElement[]} */ ([...list.querySelectorAll('button')]);
    const at = buttons.indexOf(/** @type {any} */ (document.activeElement));
    if (event.key === 'Escape') {
      input.value = '';
      show();
      input.focus();
    } else if (event.key === 'ArrowDown') (buttons[at + 1] ?? buttons[at])?.focus();
    else if (event.key === 'ArrowUp') (at > 0 ? buttons[at - 1] : input).focus();
    else if (event.key === 'Enter' && document.activeElement === input) buttons[0]?.click();
    else return;
    event.preventDefault();
  };
  input.addEventListener('input', show);
  watch(
    store,
    (s) => [s.reference, s.check.value],
    (s) => {
      const more = R.addable(s.reference, s.check.value?.values ?? {}, '', Infinity).length;
      mark(input, 'placeholder', `Search ${more} more, e.g. kerf, jerk, seed`);
      if (input.value !== '') show();
    },
  );
  return h(
    'div',
    { class: 'adder', on: { keydown: step } },
    h('label', { for: 'add-parameter' }, 'Add a parameter'),
    input,
    list,
    count,
  );
}
