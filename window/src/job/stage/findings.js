// SPDX-License-Identifier: Apache-2.0
// What is wrong with drawing and job: numbered marks in the drawing, and the same numbers in a list.
// @ts-check
import { h, keyed, mark, say } from '../../shared/dom.js';
import { watch } from '../../shared/store.js';
import { entitiesChosen, lineChosen } from '../links.js';
import * as S from '../state.js';
import { toScreen } from './geometry.js';

/** @typedef {{ number: number, severity: string, message: string, where: [number, number] | null, entities: number[], line: number | null, place: string }} Item */

/** Rows of the list. Who has more than these begins with them. */
const kMostRows = 300;

/** Everything that is to be listed, in one numbering. @param {S.State} s @returns {Item[]} */
export function itemsOf(s) {
  const findings = (s.check.value?.drawing?.findings ?? []).filter((/** @type {any} */ f) => !f.accepted);
  const drawn = findings.map((/** @type {any} */ f) => ({
    severity: f.severity,
    message: f.message,
    where: f.where_mm ?? null,
    entities: f.entities ?? [],
    line: null,
    // Most messages name their entities themselves.
    place: /\bE\d/.test(f.message) || !f.line ? '' : `line ${f.line} of the drawing`,
  }));
  /** @type {Set<string>} */
  const told = new Set();
  const job = (s.plan.value?.issues ?? []).flatMap((/** @type {any} */ i) => {
    // The place stands before the message already.
    const message = i.line > 0 ? i.message.replace(/^G-code line \d+: /, '') : i.message;
    if (told.has(`${i.line} ${message}`)) return [];
    told.add(`${i.line} ${message}`);
    const line = i.line > 0 ? i.line : null;
    const place = line === null ? 'job' : `G-code, line ${line}`;
    return [{ severity: i.severity ?? 'error', message, where: null, entities: [], line, place }];
  });
  // A scenario that is refused has these beside its fields already.
  const planned =
    s.plan.state === 'failed' && s.check.value?.fits && S.isPlanned(s)
      ? [
          {
            severity: 'error',
            message: s.plan.fault?.message ?? '',
            where: null,
            entities: [],
            line: null,
            place: 'job',
          },
        ]
      : [];
  return [...drawn, ...job, ...planned].map((item, i) => ({ ...item, number: i + 1 }));
}

/** @param {number} count @param {string} one @param {string} several */
const counted = (count, one, several) => (count === 0 ? '' : `${count} ${count === 1 ? one : several}`);

/** What stands above the list, or in its place. @param {S.State} s @param {Item[]} items */
export function headOf(s, items) {
  const errors = items.filter((i) => i.severity === 'error').length;
  if (items.length > 0)
    return [counted(errors, 'fault', 'faults'), counted(items.length - errors, 'note', 'notes')]
      .filter(Boolean)
      .join(', ');
  if (s.check.state === 'busy' || s.plan.state === 'busy' || s.plan.state === 'none') return 'Planning the job…';
  if (!S.isPlanned(s)) return 'Nothing is wrong. The firmware takes a job of its own, so there is no preview.';
  const facts = s.plan.value?.facts;
  if (!facts) return 'Nothing is wrong with the drawing.';
  const belt =
    facts.max_belt_speed_mm_s > 0 ? `; the belt may run at up to ${facts.max_belt_speed_mm_s.toFixed(1)} mm/s` : '';
  const lengths = `${facts.cut_length_mm.toFixed(0)} mm of cuts and ${facts.jump_length_mm.toFixed(0)} mm of jumps`;
  return `Nothing is wrong. ${lengths} in ${facts.unit_time_s.toFixed(2)} s${belt}.`;
}

/**
 * @param {Element} element @param {Element} pins @param {import('../page.js').Store} store @param {(at_mm: [number, number]) => void} toPlace
 * @param {ReturnType<typeof import('./painter.js').createPainter>} painter
 */
export function mountFindings(element, pins, store, toPlace, painter) {
  const title = h('h2');
  const list = h('ol');
  const more = h('p', { hidden: true });
  const box = h('section', { class: 'findings', 'aria-label': 'Findings' }, title, list, more);
  element.append(box);
  const go = (/** @type {Item} */ item) => {
    store.update((s) => ({
      ...(item.line !== null ? lineChosen(s, item.line) : entitiesChosen(s, item.entities)),
      finding: item.number,
    }));
    if (item.where) toPlace(item.where);
  };
  const isWarning = (/** @type {Item} */ item) => item.severity !== 'error';
  /** @type {Item[]} */
  let items = [];
  const placePins = () => {
    const shown = items.slice(0, kMostRows).filter((i) => i.where);
    keyed(
      pins,
      shown,
      (i) => `${i.number} ${i.severity} ${i.message}`,
      (item) =>
        h(
          'button',
          {
            class: isWarning(item) ? 'pin warning' : 'pin',
            title: item.message,
            'aria-label': `Finding ${item.number}: ${item.message}`,
            on: { click: () => go(item) },
          },
          item.number,
        ),
      (pin, item) => {
        const [x, y] = toScreen(painter.view(), /** @type {[number, number]} */ (item.where));
        const { width, height } = painter.size();
        pin.style.left = `${x}px`;
        pin.style.top = `${y}px`;
        pin.hidden = x < 0 || y < 0 || x > width || y > height;
        mark(pin, 'aria-current', store.get().finding === item.number ? 'true' : null);
      },
    );
  };
  watch(
    store,
    (s) => [s.check.value, s.plan, s.finding, s.job === null],
    (s) => {
      items = s.job ? itemsOf(s) : [];
      box.hidden = !s.job || !s.check.value?.drawing;
      say(title, headOf(s, items));
      more.hidden = items.length <= kMostRows;
      say(more, `${items.length - kMostRows} more are not listed. Mend these first.`);
      title.classList.toggle('good', items.length === 0);
      keyed(
        list,
        items.slice(0, kMostRows),
        (i) => `${i.number} ${i.severity} ${i.message}`,
        (item) =>
          h(
            'li',
            {},
            h(
              'button',
              { on: { click: () => go(item) } },
              h('span', { class: isWarning(item) ? 'badge warning' : 'badge' }, item.number),
              h('span', {}, item.place ? `${item.place}: ` : '', item.message),
            ),
          ),
        (row, item) => mark(row.firstElementChild, 'aria-current', s.finding === item.number ? 'true' : null),
      );
      placePins();
    },
  );
  painter.onPaint(placePins);
}
