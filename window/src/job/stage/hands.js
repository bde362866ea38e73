// SPDX-License-Identifier: Apache-2.0
// Pointer and keys on the drawing: choosing, a rubber band, moving about, measuring. Everything that the pointer does has a key.
// @ts-check
import { entitiesChosen } from '../links.js';
import * as S from '../state.js';
import * as G from './geometry.js';
import { entitiesOf } from './painter.js';

const kCatch_px = 7;

/**
 * @param {HTMLCanvasElement} canvas @param {import('../page.js').Store} store @param {ReturnType<typeof import('./painter.js').createPainter>} painter
 * @param {import('./painter.js').Hand} hand @param {(words: string) => void} tell speaks to who does not see the drawing
 */
export function takeHands(canvas, store, painter, hand, tell) {
  const curves = () => entitiesOf(store.get());
  const within = () => kCatch_px / painter.view().scale;
  const placeOf = (/** @type {MouseEvent} */ event) => {
    const r = canvas.getBoundingClientRect();
    return /** @type {G.Point} */ ([event.clientX - r.left, event.clientY - r.top]);
  };
  const aim = (/** @type {G.Point} */ at_px) => {
    const found = G.snapped(curves(), G.toSheet(painter.view(), at_px), within());
    hand.cursor = found.at;
    hand.kind = found.kind;
    painter.soon();
  };

  /** @type {{ from: G.Point, last: G.Point, moving: boolean, tool: string } | null} */
  let held = null;
  canvas.addEventListener('pointerdown', (event) => {
    if (event.button > 1) return;
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    const at = placeOf(event);
    const { tool } = store.get().stage;
    held = { from: at, last: at, moving: false, tool: event.button === 1 || event.altKey ? 'move' : tool };
    event.preventDefault();
  });
  canvas.addEventListener('pointermove', (event) => {
    const at = placeOf(event);
    if (held && !held.moving && Math.hypot(at[0] - held.from[0], at[1] - held.from[1]) > 4) held.moving = true;
    if (held?.moving && held.tool === 'move') {
      canvas.classList.add('grabbing');
      painter.look(G.panned(painter.view(), at[0] - held.last[0], at[1] - held.last[1]));
    } else if (held?.moving && held.tool === 'select') {
      hand.band = G.boxBetween(held.from, at);
      painter.soon();
    }
    if (held) held.last = at;
    if (store.get().stage.tool === 'measure') aim(at);
  });
  canvas.addEventListener('pointerup', (event) => {
    if (!held) return;
    const { from, moving, tool } = held;
    held = null;
    canvas.classList.remove('grabbing');
    const at = placeOf(event);
    const more = event.shiftKey || event.ctrlKey || event.metaKey;
    if (hand.band) band(from, at, more);
    else if (!moving && tool === 'select') choose(at, more);
    else if (tool === 'measure') measure();
    hand.band = null;
    painter.soon();
  });
  canvas.addEventListener('pointercancel', () => {
    held = null;
    hand.band = null;
    painter.soon();
  });
  canvas.addEventListener('pointerleave', () => {
    if (store.get().stage.tool !== 'measure' || document.activeElement === canvas) return;
    hand.cursor = null;
    painter.soon();
  });
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const by = Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0016));
      painter.look(G.zoomed(painter.view(), by, placeOf(event)));
    },
    { passive: false },
  );

  /** @param {G.Point} at_px @param {boolean} more */
  function choose(at_px, more) {
    const id = G.hit(curves(), G.toSheet(painter.view(), at_px), within());
    if (id === null) {
      if (!more) store.update((s) => entitiesChosen(s, []));
    } else store.update((s) => entitiesChosen(s, [id], more ? 'toggle' : 'only'));
  }
  /** @param {G.Point} a @param {G.Point} b @param {boolean} more */
  function band(a, b, more) {
    const box = G.boxBetween(G.toSheet(painter.view(), a), G.toSheet(painter.view(), b));
    store.update((s) => entitiesChosen(s, G.inside(curves(), box), more ? 'add' : 'only'));
  }
  function measure() {
    const at = hand.cursor;
    if (!at) return;
    store.update((s) => S.measuredAt(s, at));
    const [a, b] = store.get().stage.measure;
    tell(b ? `${G.measured(a, b).distance_mm.toFixed(3)} millimetres.` : 'First place set.');
  }

  const kArrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  /** One entity on in the order of the cuts, or of the drawing where there is none. @param {1 | -1} sense @param {boolean} more */
  function step(sense, more) {
    const s = store.get();
    const known = new Set(curves().map((c) => c.id));
    const cut = (s.plan.value?.order ?? []).filter((/** @type {number} */ id) => known.has(id));
    const ids = cut.length > 0 ? cut : [...known];
    if (ids.length === 0) return;
    const at = ids.indexOf(s.selected[s.selected.length - 1]);
    const next = ids[at < 0 ? (sense > 0 ? 0 : ids.length - 1) : (at + sense + ids.length) % ids.length];
    store.update((state) => entitiesChosen(state, [next], more ? 'add' : 'only'));
  }
  /** @param {number[]} way @param {number} px */
  function moveCursor([x, y], px) {
    const { width, height } = painter.size();
    const at = hand.cursor ? G.toScreen(painter.view(), hand.cursor) : /** @type {G.Point} */ ([width / 2, height / 2]);
    const to = /** @type {G.Point} */ ([at[0] + x * px, at[1] + y * px]);
    // Fine steps go wherever they lead; coarse ones catch what is near.
    if (px > 1) aim(to);
    else {
      hand.cursor = G.toSheet(painter.view(), to);
      hand.kind = 'free';
      painter.soon();
    }
    const [cx, cy] = /** @type {G.Point} */ (hand.cursor);
    tell(
      `x ${cx.toFixed(2)}, y ${cy.toFixed(2)}${hand.kind === 'end' ? ', end' : hand.kind === 'line' ? ', on a line' : ''}`,
    );
  }
  canvas.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey) {
      if (event.key.toLowerCase() !== 'a') return;
      store.update((s) =>
        entitiesChosen(
          s,
          curves().map((c) => c.id),
        ),
      );
      return event.preventDefault();
    }
    const { tool } = store.get().stage;
    const { width, height } = painter.size();
    const arrow = /** @type {any} */ (kArrows)[event.key];
    const middle = /** @type {G.Point} */ ([width / 2, height / 2]);
    if (arrow && (event.altKey || tool === 'move'))
      painter.look(G.panned(painter.view(), -arrow[0] * 40, -arrow[1] * 40));
    else if (arrow && tool === 'measure') moveCursor(arrow, event.shiftKey ? 1 : 12);
    else if (arrow) step(arrow[0] + arrow[1] > 0 ? 1 : -1, event.shiftKey);
    else if (event.key === '+' || event.key === '=') painter.look(G.zoomed(painter.view(), 1.25, middle));
    else if (event.key === '-') painter.look(G.zoomed(painter.view(), 0.8, middle));
    else if (event.key === 'Enter' && tool === 'measure') measure();
    else if (event.key === 'Escape')
      store.update((s) => (s.stage.measure.length > 0 ? S.looking({ measure: [] })(s) : entitiesChosen(s, [])));
    else {
      const letters = {
        f: () => painter.fit(),
        v: () => store.update(S.looking({ tool: 'select' })),
        h: () => store.update(S.looking({ tool: 'move' })),
        m: () => store.update(S.looking({ tool: 'measure' })),
        j: () => store.update((/** @type {S.State} */ s) => S.looking({ jumps: !s.stage.jumps })(s)),
        a: () => store.update((/** @type {S.State} */ s) => S.looking({ frames: !s.stage.frames })(s)),
        n: () => store.update((/** @type {S.State} */ s) => S.looking({ numbers: !s.stage.numbers })(s)),
      };
      const act = /** @type {any} */ (letters)[event.key.toLowerCase()];
      if (!act) return;
      act();
    }
    event.preventDefault();
  });
}
