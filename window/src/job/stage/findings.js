// SPDX-License-Identifier: Apache-2.0
// What is wrong with drawing and job: numbered marks in the drawing, and the same numbers in a list.
// @ts-check
import { h, keyed, mark, say } from '../../shared/dom.js';
import { watch } from '../../shared/store.js';
import { entitiesChosen, lineChosen } from '../links.js';
import * as S from '../state.js';
import { frameWords, framesOf, misplaced, tooLarge } from './frames.js';
import { apart, toScreen } from './geometry.js';
import { motionOf } from './painter.js';

/** @typedef {{ number: number, severity: string, message: string, where: [number, number] | null, entities: number[], line: number | null, place: string }} Item */

/** Rows of the list. Who has more than these begins with them. */
const kMostRows = 300;
/** Room of a numbered mark, with what is between two. */
const kPin_px = 21;

/** Where a warning of the drawing's reader is: "label.svg, line 12". @param {any} issue */
const placeInFile = (issue) => `${S.baseName(issue.file)}${issue.line > 0 ? `, line ${issue.line}` : ''}`;

/** Warnings of the drawing's file: its unit, what is left out of it. @param {S.State} s */
const ofFile = (s) =>
  (s.check.value?.issues ?? [])
    .filter((/** @type {any} */ i) => (i.file ?? '') !== '' && i.severity === 'warning' && s.check.value?.drawing)
    .map((/** @type {any} */ i) => ({
      severity: 'warning',
      message: i.message,
      where: null,
      entities: entitiesAtLine(s, i),
      line: null,
      place: placeInFile(i),
    }));

/** Entities that begin at the line of the drawing of which an issue tells. @param {S.State} s @param {any} issue @returns {number[]} */
const entitiesAtLine = (s, issue) =>
  issue.file === s.check.value.drawing.file && issue.line > 0
    ? s.check.value.drawing.entities
        .filter((/** @type {any} */ e) => e.line === issue.line)
        .map((/** @type {any} */ e) => e.id)
    : [];

/** The entity of which a sentence of the planner tells: "from E5: …". @param {string} message @returns {number[]} */
function entitiesIn(message) {
  const found = /\bE(\d+)\b/.exec(message);
  return found ? [Number(found[1])] : [];
}

/** What the planner says of the job and its G-code. @param {S.State} s */
function ofJob(s) {
  /** @type {Set<string>} */
  const told = new Set();
  const known = new Set((s.check.value?.drawing?.entities ?? []).map((/** @type {any} */ e) => e.id));
  return (s.plan.value?.issues ?? []).flatMap((/** @type {any} */ i) => {
    // The place stands before the message already.
    const message = S.withoutLine(i);
    if (told.has(`${i.line} ${message}`)) return [];
    told.add(`${i.line} ${message}`);
    const line = i.line > 0 ? i.line : null;
    const entities = (i.entities ?? entitiesIn(message)).filter((/** @type {number} */ id) => known.has(id));
    const place = line === null ? (i.source === 'gcode' ? 'G-code' : 'job') : `G-code, line ${line}`;
    return [{ severity: i.severity ?? 'error', message, where: i.where_mm ?? null, entities, line, place }];
  });
}

/** Everything that is to be listed, in one numbering. @param {S.State} s @returns {Item[]} */
export function itemsOf(s) {
  const { drawing } = s.check.value ?? {};
  const findings = (drawing?.findings ?? []).filter((/** @type {any} */ f) => !f.accepted);
  const drawn = findings.map((/** @type {any} */ f) => ({
    severity: f.severity,
    message: f.message,
    where: f.where_mm ?? null,
    entities: f.entities ?? [],
    line: null,
    // Lines in the message, and this one, are those of the drawing's file.
    place: S.baseName(drawing.file ?? '') + (/\bline \d/.test(f.message) || !f.line ? '' : `, line ${f.line}`),
  }));
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
  return [...drawn, ...ofFile(s), ...ofJob(s), ...planned].map((item, i) => ({ ...item, number: i + 1 }));
}

/** A finding was chosen: its line or its entities, and the place itself in the drawing. @param {S.State} s @param {Item} item @returns {S.State} */
export function findingChosen(s, item) {
  const next =
    item.line !== null ? lineChosen({ ...s, line: null }, item.line) : entitiesChosen(s, item.entities);
  return { ...next, finding: item.number, stage: { ...next.stage, show: 'drawing', place: item.where } };
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
 * What can be done about a drawing that does not lie where it should, and what the words of frames mean.
 * @param {import('../page.js').Store} store @param {import('../actions.js').Actions} actions
 */
function placing(store, actions) {
  const why = h('span');
  const button = h(
    'button',
    { id: 'place-anew', on: { click: () => void actions.place() } },
    'Lay marks and start anew',
  );
  const offer = h('p', { class: 'offer', hidden: true }, why, button);
  const large = h('p', { class: 'offer', id: 'too-large', hidden: true });
  const words = h('p', { class: 'frame-words', id: 'frame-words', hidden: true });
  watch(
    store,
    (s) => [s.check.value, s.plan.value, s.job?.readOnly],
    (s) => {
      const value = s.job ? s.check.value : null;
      const doubt = misplaced(value, s.plan.value);
      offer.hidden = doubt === '';
      say(why, doubt);
      const size = tooLarge(value);
      large.hidden = size === '';
      say(large, size);
    },
  );
  watch(
    store,
    (s) => [s.check.value, s.plan.value, s.stage.frames],
    (s) => {
      const told = (s.plan.value?.issues ?? []).some((/** @type {any} */ i) => /x_W|y_W|field/.test(i.message));
      words.hidden = !s.job || !s.check.value?.drawing || !(told || s.stage.frames);
      say(words, frameWords(framesOf(s.check.value, motionOf(s), 0), s.check.value?.machine?.name ?? ''));
    },
  );
  return [large, offer, words];
}

/**
 * @param {Element} element @param {Element} pins
 * @param {{ store: import('../page.js').Store, actions: import('../actions.js').Actions, toPlace: (at_mm: [number, number]) => void,
 *   painter: ReturnType<typeof import('./painter.js').createPainter> }} page
 */
export function mountFindings(element, pins, { store, actions, toPlace, painter }) {
  const title = h('h2');
  const list = h('ol');
  const more = h('p', { hidden: true });
  const box = h('section', { class: 'findings', 'aria-label': 'Findings' }, title);
  const [large, offer, words] = placing(store, actions);
  box.append(large, offer, list, more, words);
  element.append(box);
  const go = (/** @type {Item} */ item) => {
    store.update((s) => ({
      ...(item.line !== null ? lineChosen({ ...s, line: null }, item.line) : entitiesChosen(s, item.entities)),
      finding: item.number,
    }));
    if (item.where) toPlace(item.where);
  };
  const isWarning = (/** @type {Item} */ item) => item.severity !== 'error';
  /** @type {Item[]} */
  let items = [];
  const placePins = () => {
    const shown = items.slice(0, kMostRows).filter((i) => i.where);
    const places = apart(
      shown.map((i) => toScreen(painter.view(), /** @type {[number, number]} */ (i.where))),
      kPin_px,
    );
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
      (pin, item, index) => {
        const [x, y] = places[index];
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
