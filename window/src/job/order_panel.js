// SPDX-License-Identifier: Apache-2.0
// The order of the cuts as a list: dragged by the pointer, moved by Alt and the arrows.
// @ts-check
import { fill, h, keyed, say } from '../shared/dom.js';
import { icon } from '../shared/icons.js';
import { watch } from '../shared/store.js';
import { swatch } from './choices.js';
import { entitiesChosen } from './links.js';
import { moved, nudged } from './order.js';
import * as S from './state.js';

/** @typedef {import('./page.js').Store} Store */

/** Rows of the list; a page with more of them no longer answers at once. */
const kMostRows = 2000;

/** @param {Element} panel @param {Store} store @param {import('./actions.js').Actions} actions */
export function mountOrder(panel, store, actions) {
  const how = h('span', { id: 'order-how' });
  const spoken = h('span', { class: 'visually-hidden', role: 'status' });
  const planned = h(
    'button',
    { class: 'plain', id: 'order-planned', on: { click: () => actions.setOrder([]) } },
    'As planned',
  );
  const shift = (/** @type {1 | -1} */ sense) => {
    const s = store.get();
    if (S.isByHand(s)) return;
    const before = S.orderOf(s);
    const order = nudged(before, s.selected, sense);
    if (order.every((id, i) => id === before[i])) return;
    actions.setOrder(order);
    say(spoken, `Now at place ${order.findIndex((id) => s.selected.includes(id)) + 1} of ${order.length}.`);
  };
  const earlier = h(
    'button',
    { title: 'Earlier (Alt ↑)', 'aria-label': 'Earlier', on: { click: () => shift(-1) } },
    icon('up'),
  );
  const later = h(
    'button',
    { title: 'Later (Alt ↓)', 'aria-label': 'Later', on: { click: () => shift(1) } },
    icon('down'),
  );
  const hint = h('p', {}, 'Drag, or Alt and ↑ ↓.');
  const list = h('ul', {
    class: 'order',
    id: 'order',
    role: 'listbox',
    tabindex: 0,
    'aria-multiselectable': 'true',
    'aria-label': 'Order of the cuts',
    'aria-describedby': 'order-how',
  });
  const more = h('p', { hidden: true });
  panel.append(
    h('div', { class: 'panel-head' }, how, h('span', { class: 'gap' }), planned, earlier, later, hint, more, spoken),
    list,
  );
  const ids = () => S.orderOf(store.get());

  const make = (/** @type {any} */ item) =>
    h(
      'li',
      { id: `order-${item.id}`, role: 'option', 'data-id': item.id },
      h('span', { class: 'place' }),
      h('span'),
      h('span'),
      h('span', { class: 'layer-name' }),
      h('span', { class: 'length' }),
    );
  watch(
    store,
    (s) => [S.orderOf(s), s.check.value?.drawing, s.selected],
    (s) => {
      const entities = new Map((s.check.value?.drawing?.entities ?? []).map((/** @type {any} */ e) => [e.id, e]));
      const chosen = new Set(s.selected);
      const order = S.orderOf(s);
      more.hidden = order.length <= kMostRows;
      say(
        more,
        `${order.length - kMostRows} more are not listed. Choose them in the drawing; what is chosen is moved.`,
      );
      const items = order.slice(0, kMostRows).map((id) => ({ id, entity: entities.get(id) }));
      const active = s.selected[s.selected.length - 1];
      keyed(
        list,
        items,
        (item) => item.id,
        make,
        (row, { id, entity }, place) => {
          say(row.children[0], place + 1);
          if (row.process !== entity?.process)
            fill(row.children[1], swatch((row.process = entity?.process ?? 'ignore')));
          say(row.children[2], `E${id}`);
          say(row.children[3], entity ? `${entity.process} · ${entity.layer}` : '');
          say(row.children[4], entity ? `${entity.length_mm.toFixed(1)} mm` : '');
          row.setAttribute('aria-selected', String(chosen.has(id)));
          row.classList.toggle('active', id === active);
        },
      );
      if (active === undefined) list.removeAttribute('aria-activedescendant');
      else list.setAttribute('aria-activedescendant', `order-${active}`);
      if (active !== undefined && !list.hidden)
        document.getElementById(`order-${active}`)?.scrollIntoView({ block: 'nearest' });
    },
  );
  watch(
    store,
    (s) => [s.check.value, s.job, s.selected.length, S.orderOf(s)],
    (s) => {
      const byHand = S.isByHand(s);
      const set = s.check.value?.values ?? {};
      const own =
        Object.keys(set).some((key) => key.startsWith('planner.order[')) || Array.isArray(set['planner.order']);
      const words = { nearest: 'Planned: the nearest next', drawn: 'Planned: as drawn' };
      say(
        how,
        !s.job || S.orderOf(s).length === 0
          ? ''
          : byHand
            ? 'As in the G-code by hand'
            : own
              ? 'By hand'
              : (/** @type {any} */ (words)[set['planner.order']] ?? 'Planned: shortest way'),
      );
      planned.hidden = !own || byHand;
      hint.hidden = byHand || !s.job;
      earlier.disabled = later.disabled = byHand || s.selected.length === 0;
    },
  );

  list.addEventListener('keydown', (/** @type {KeyboardEvent} */ event) => {
    const order = ids();
    const { selected } = store.get();
    const sense = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
    if (sense !== 0 && event.altKey) shift(sense);
    else if (sense !== 0 || event.key === 'Home' || event.key === 'End') {
      const at = order.indexOf(selected[selected.length - 1]);
      const to =
        event.key === 'Home'
          ? 0
          : event.key === 'End'
            ? order.length - 1
            : Math.min(Math.max(at + sense, 0), order.length - 1);
      store.update((s) => entitiesChosen(s, [order[at < 0 && sense !== 0 ? 0 : to]], event.shiftKey ? 'add' : 'only'));
    } else if (event.key.toLowerCase() === 'a' && (event.ctrlKey || event.metaKey))
      store.update((s) => entitiesChosen(s, order));
    else return;
    event.preventDefault();
  });
  takeDrag(list, store, ids, (order) => actions.setOrder(order));
}

/** @param {HTMLElement} list @param {Store} store @param {() => number[]} ids @param {(order: number[]) => void} done */
function takeDrag(list, store, ids, done) {
  const rowAt = (/** @type {PointerEvent} */ event) =>
    /** @type {HTMLElement | null} */ (
      document.elementFromPoint(event.clientX, event.clientY)?.closest('.order li') ?? null
    );
  const idOf = (/** @type {HTMLElement} */ row) => Number(row.dataset.id);
  /** @type {{ id: number, y: number, moving: boolean, to: number | null } | null} */
  let held = null;
  const unmark = () =>
    list
      .querySelectorAll('.over-before, .over-after')
      .forEach((row) => row.classList.remove('over-before', 'over-after'));
  list.addEventListener('pointerdown', (event) => {
    const row = rowAt(event);
    if (!row || event.button !== 0) return;
    held = { id: idOf(row), y: event.clientY, moving: false, to: null };
    list.setPointerCapture(event.pointerId);
  });
  list.addEventListener('pointermove', (event) => {
    if (!held) return;
    if (!held.moving && Math.abs(event.clientY - held.y) < 5) return;
    if (!held.moving) {
      held.moving = true;
      const { id } = held;
      if (!store.get().selected.includes(id)) store.update((s) => entitiesChosen(s, [id]));
    }
    const box = list.getBoundingClientRect();
    // Near an end the list goes along.
    if (event.clientY < box.top + 24) list.scrollTop -= 8;
    if (event.clientY > box.bottom - 24) list.scrollTop += 8;
    unmark();
    const row = rowAt(event);
    if (!row || S.isByHand(store.get())) return;
    const r = row.getBoundingClientRect();
    const after = event.clientY > r.top + r.height / 2;
    row.classList.add(after ? 'over-after' : 'over-before');
    held.to = ids().indexOf(idOf(row)) + (after ? 1 : 0);
  });
  list.addEventListener('pointerup', (event) => {
    if (!held) return;
    const { id, moving, to } = held;
    held = null;
    unmark();
    if (!moving) {
      const order = ids();
      const { selected } = store.get();
      const last = order.indexOf(selected[selected.length - 1]);
      const here = order.indexOf(id);
      if (event.shiftKey && last >= 0)
        store.update((s) => entitiesChosen(s, order.slice(Math.min(last, here), Math.max(last, here) + 1), 'add'));
      else store.update((s) => entitiesChosen(s, [id], event.ctrlKey || event.metaKey ? 'toggle' : 'only'));
    } else if (to !== null) {
      const before = ids();
      const order = moved(before, store.get().selected, to);
      if (order.some((one, i) => one !== before[i])) done(order);
    }
  });
  list.addEventListener('pointercancel', () => {
    held = null;
    unmark();
  });
}
