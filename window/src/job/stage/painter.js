// SPDX-License-Identifier: Apache-2.0
// Keeps what is painted in step with the state. The sheet, and the way that has been run, are kept on canvases of their own: playing
// only adds to the latter, and choosing paints neither anew.
// @ts-check
import { makeMotion, reachAt } from '../motion.js';
import { framesOf, wholeOf } from './frames.js';
import { boxOfCurves, fitted } from './geometry.js';
import * as P from './paint.js';
import { paintAxes, paintPlace, paintSheetAndMarks } from './paint_frames.js';

/** @typedef {import('../state.js').State} State */
/** @typedef {import('./geometry.js').View} View */

/** What the pointer and the keys do at the moment; nothing of it outlives the page.
 * @typedef {{ band: import('./geometry.js').Box | null, cursor: [number, number] | null, kind: string }} Hand */

/** @param {(what: any) => any} make @returns {(what: any) => any} remembers the last answer */
function once(make) {
  /** @type {any} */
  let of;
  /** @type {any} */
  let answer;
  return (what) => {
    if (of !== what) [of, answer] = [what, make(what)];
    return answer;
  };
}

/** @type {import('../state.js').Entity[]} */
const noEntities = [];
/** @param {State} state @returns {import('../state.js').Entity[]} */
export const entitiesOf = (state) => state.check.value?.drawing?.entities ?? noEntities;

/** Motions are made once for each plan, for all views. */
const motionOf_ = once((/** @type {any} */ plan) => (plan?.preview?.x_mm?.length ? plan : null));
/** @type {WeakMap<object, import('../motion.js').Motion>} */
const motions = new WeakMap();
/** @param {State} state */
export function motionOf(state) {
  const plan = motionOf_(state.plan.value);
  if (!plan) return null;
  const known = motions.get(plan);
  if (known) return known;
  const motion = makeMotion(plan.preview, state.check.value?.machine?.full_power_w ?? 0);
  // Watts need the machine, which another answer brings.
  if (state.check.value?.machine) motions.set(plan, motion);
  return motion;
}

/** Frames at the present moment. @param {State} state */
const framesNow = (state) => framesOf(state.check.value, motionOf(state), state.period);

/** A canvas of its own for what seldom changes. */
function createLayer() {
  const canvas = document.createElement('canvas');
  /** @type {any[]} */
  let key = [];
  return {
    canvas,
    g: /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d')),
    /** Is it to be painted anew, for what it depends on has changed? @param {any[]} next */
    isFresh(next) {
      const same = key.length === next.length && key.every((part, i) => part === next[i]);
      key = next;
      return !same;
    },
    forget() {
      key = [];
    },
  };
}

/** @param {HTMLCanvasElement} canvas @param {() => State} get @param {Hand} hand */
export function createPainter(canvas, get, hand) {
  const run = createLayer();
  const sheet = createLayer();
  const drawnOf = once((entities) => P.byProcess(entities));
  const byId = once((entities) => new Map(entities.map((/** @type {any} */ e) => [e.id, e])));
  const jumpsOf = once((motion) => (motion ? P.jumpsOf(motion) : []));
  const box = once((entities) => boxOfCurves(entities));
  let width = 0;
  let height = 0;
  let asked = false;
  /** @type {View} */
  let view = { scale: 1, dx: 0, dy: 0 };
  let fits = true;
  let done = 0;
  /** @type {Record<string, string>} */
  let colours = {};
  /** @type {(() => void)[]} */
  const listeners = [];

  /** @param {State} state @param {any} motion */
  function paintRun(state, motion) {
    const { colour, jumps } = state.stage;
    const to = Math.min(Math.floor(state.period), motion.n - 1);
    if (run.isFresh([motion, view, colour, jumps, colours]) || to < done) {
      run.g.clearRect(0, 0, width, height);
      done = 0;
    }
    P.paintRun(run.g, view, colours, motion, { from: done, to, by: colour, jumps });
    done = to;
  }

  /** @param {State} state @param {any} motion */
  function paintSheet(state, motion) {
    const jumps = state.stage.jumps ? jumpsOf(motion) : [];
    if (!sheet.isFresh([entitiesOf(state), jumps.length && jumps, view, colours])) return;
    sheet.g.clearRect(0, 0, width, height);
    P.paintSheet(sheet.g, view, colours, { drawn: drawnOf(entitiesOf(state)), jumps });
  }

  function paint() {
    asked = false;
    if (width === 0) return;
    const state = get();
    const entities = entitiesOf(state);
    const motion = motionOf(state);
    const g = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
    g.clearRect(0, 0, width, height);
    if (motion) P.paintReach(g, view, colours, motion, state.period);
    const frames = state.stage.frames && entities.length > 0 ? framesNow(state) : null;
    if (frames) paintSheetAndMarks(g, view, colours, frames);
    const runs = motion && state.period > 0;
    if (entities.length > 0 || motion) {
      paintSheet(state, motion);
      g.globalAlpha = runs ? 0.55 : 1;
      g.drawImage(sheet.canvas, 0, 0, width, height);
      g.globalAlpha = 1;
    }
    if (runs) {
      paintRun(state, motion);
      g.drawImage(run.canvas, 0, 0, width, height);
    }
    const chosen = state.selected.map((id) => byId(entities).get(id)).filter(Boolean);
    if (frames) paintAxes(g, view, colours, frames);
    if (chosen.length > 0) P.paintSelected(g, view, chosen, colours);
    if (state.stage.numbers) P.paintNumbers(g, view, colours, numbersOf(state, byId(entities)));
    if (state.stage.place) paintPlace(g, view, colours, state.stage.place);
    if (motion) P.paintBeam(g, view, colours, motion, state.period);
    paintHand(g, state);
    if (entities.length > 0 || motion) P.paintScale(g, view, colours, width);
    // Where things are, for tests and for whoever looks into the page.
    canvas.dataset.view = JSON.stringify(view);
    canvas.dataset.place = state.stage.place ? state.stage.place.join(' ') : '';
    for (const listener of listeners) listener();
  }

  /** @param {CanvasRenderingContext2D} g @param {State} state */
  function paintHand(g, state) {
    const { tool, measure } = state.stage;
    if (tool === 'measure' || measure.length > 0)
      P.paintMeasure(g, view, colours, {
        from: measure[0] ?? null,
        to: measure[1] ?? null,
        cursor: tool === 'measure' ? hand.cursor : null,
        kind: hand.kind,
      });
    if (!hand.band) return;
    const { x0, y0, x1, y1 } = hand.band;
    g.fillStyle = colours.field;
    g.globalAlpha = 0.6;
    g.fillRect(x0, y0, x1 - x0, y1 - y0);
    g.globalAlpha = 1;
    g.strokeStyle = colours.acc;
    g.lineWidth = 1;
    g.strokeRect(x0 + 0.5, y0 + 0.5, x1 - x0, y1 - y0);
  }

  function soon() {
    if (asked) return;
    asked = true;
    requestAnimationFrame(paint);
  }

  return {
    soon,
    /** What lies over the canvas moves with it. @param {() => void} listener */
    onPaint: (listener) => listeners.push(listener),
    view: () => view,
    size: () => ({ width, height }),
    /** @param {View} next */
    look(next) {
      view = next;
      fits = false;
      soon();
    },
    fit() {
      const state = get();
      const motion = motionOf(state);
      const reach = motion && entitiesOf(state).length === 0 ? reachAt(motion, 0) : null;
      const whole = state.stage.frames ? wholeOf(framesOf(state.check.value, motion, 0)) : null;
      view = fitted(reach ?? whole ?? box(entitiesOf(state)), width, height, Math.min(48, width / 8));
      fits = true;
      soon();
    },
    resize() {
      const ratio = devicePixelRatio || 1;
      ({ width, height } = canvas.getBoundingClientRect());
      for (const c of [canvas, run.canvas, sheet.canvas]) {
        c.width = Math.max(1, Math.round(width * ratio));
        c.height = Math.max(1, Math.round(height * ratio));
        c.getContext('2d')?.setTransform(ratio, 0, 0, ratio, 0, 0);
      }
      run.forget();
      sheet.forget();
      if (fits) this.fit();
      soon();
    },
    recolour() {
      colours = P.coloursOf(canvas);
      soon();
    },
  };
}

/** Where the numbers of the order stand: at the middle of each entity that is cut. @param {State} state @param {Map<number, any>} entities */
function numbersOf(state, entities) {
  const order = state.plan.value?.order ?? [];
  return order.flatMap((/** @type {number} */ id, /** @type {number} */ place) => {
    const points = entities.get(id)?.points_mm;
    if (!points?.length) return [];
    const i = Math.floor((points.length - 1) / 2);
    const j = Math.min(i + 1, points.length - 1);
    return [
      {
        at: /** @type {[number, number]} */ ([(points[i][0] + points[j][0]) / 2, (points[i][1] + points[j][1]) / 2]),
        text: String(place + 1),
      },
    ];
  });
}
