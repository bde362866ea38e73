// SPDX-License-Identifier: Apache-2.0
// The middle of the page: tools, the drawing or the machine, the player, and what is wrong with the drawing.
// @ts-check
import { fill, h, mark, say, svg } from '../../shared/dom.js';
import { watch } from '../../shared/store.js';
import { kProcesses, swatch } from '../choices.js';
import * as S from '../state.js';
import { mountFindings } from './findings.js';
import { framesOf } from './frames.js';
import { measured, toScreen, zoomed } from './geometry.js';
import { takeHands } from './hands.js';
import { createPainter, entitiesOf, motionOf } from './painter.js';
import { mountMachine } from './machine.js';
import { mountPlayer } from './player.js';

/** @typedef {import('../page.js').Store} Store */

/** @param {Element} element @param {Store} store @param {import('../actions.js').Actions} actions */
export function mountMiddle(element, store, actions) {
  /** @type {import('./painter.js').Hand} */
  const hand = { band: null, cursor: null, kind: 'free' };
  const canvas = h('canvas', {
    id: 'canvas',
    tabindex: 0,
    role: 'application',
    'aria-label': 'Drawing',
    'aria-describedby': 'canvas-keys',
  });
  const keys = h(
    'p',
    { id: 'canvas-keys', class: 'visually-hidden' },
    'Arrows choose the entity before or after, with Shift several; plus and minus zoom, F fits, M measures: then arrows move the cross, Enter sets a place. V chooses again.',
  );
  const spoken = h('p', { class: 'visually-hidden', role: 'status' });
  const pins = h('div');
  const legend = h('div', { class: 'legend' });
  const readout = h('div', { class: 'readout', id: 'readout', hidden: true });
  const stage = h('div', { class: 'stage' }, canvas, keys, spoken, pins, readout);
  const painter = createPainter(canvas, store.get, hand);
  // Below the drawing, not over it.
  element.append(toolBar(store, painter), stage, legend);
  takeHands(canvas, store, painter, hand, (words) => say(spoken, words));
  mountEmpty(stage, store, actions);
  mountMachine(stage, store);
  mountPlayer(element, store);
  const toPlace = (/** @type {[number, number]} */ at_mm) => {
    const { width, height } = painter.size();
    const view = painter.view();
    const [x, y] = toScreen(view, at_mm);
    if (x < 40 || y < 40 || x > width - 40 || y > height - 40)
      painter.look({ ...view, dx: view.dx + width / 2 - x, dy: view.dy + height / 2 - y });
  };
  mountFindings(element, pins, { store, actions, toPlace, painter });
  watch(
    store,
    (s) => [s.stage.place],
    ({ stage: { place } }) => {
      if (place) toPlace(place);
    },
  );

  new ResizeObserver(() => painter.resize()).observe(stage);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => painter.recolour());
  painter.recolour();
  painter.resize();
  watch(
    store,
    (s) => [entitiesOf(s), s.plan.value, s.selected, s.period, s.stage, s.check.value?.machine, s.check.value?.sheet],
    () => painter.soon(),
  );
  /** @type {string | undefined} */
  let fittedFor;
  watch(
    store,
    (s) => [s.check.value?.drawing, s.job?.path],
    (s) => {
      // A drawing that was not there before is shown whole.
      const name = s.check.value?.drawing ? `${s.job?.path} ${s.check.value.drawing.file}` : undefined;
      if (name !== undefined && name !== fittedFor) painter.fit();
      fittedFor = name;
    },
  );
  watch(
    store,
    (s) => [s.stage.tool],
    ({ stage: { tool } }) => {
      canvas.classList.toggle('measure', tool === 'measure');
      if (tool !== 'measure') hand.cursor = null;
    },
  );
  watch(
    store,
    (s) => [s.check.value, s.plan.value?.preview, s.stage.colour, s.stage.frames, s.stage.show, s.job === null],
    (s) => {
      const parts = s.job === null || s.stage.show !== 'drawing' ? [] : legendOf(s).filter(Boolean);
      legend.hidden = parts.length === 0;
      fill(legend, parts);
    },
  );
  watch(
    store,
    (s) => [s.selected, s.stage.measure, s.check.value?.drawing],
    (s) => {
      const facts = factsOf(s);
      readout.hidden = facts.length === 0;
      fill(
        readout,
        h(
          'dl',
          {},
          facts.map(([name, value]) => h('div', {}, h('dt', {}, name), h('dd', {}, value))),
        ),
      );
      if (s.selected.length > 0)
        say(
          spoken,
          s.selected.length === 1
            ? `${facts[0][0]} ${facts[0][1]}, layer ${facts[1]?.[1]}`
            : `${s.selected.length} entities chosen`,
        );
    },
  );
  watch(
    store,
    (s) => [s.check.value?.drawing],
    (s) =>
      mark(
        canvas,
        'aria-label',
        s.check.value?.drawing
          ? `Drawing ${s.check.value.drawing.file}, ${entitiesOf(s).length} entities`
          : 'Drawing, empty',
      ),
  );
}

/** @param {Store} store @param {ReturnType<typeof createPainter>} painter */
function toolBar(store, painter) {
  const tool = (
    /** @type {'select' | 'move' | 'measure'} */ name,
    /** @type {string} */ text,
    /** @type {string} */ key,
  ) =>
    h(
      'button',
      { 'data-tool': name, title: `${text} (${key})`, on: { click: () => store.update(S.looking({ tool: name })) } },
      text,
    );
  const tools = [tool('select', 'Choose', 'V'), tool('move', 'Move', 'H'), tool('measure', 'Measure', 'M')];
  const zoom = (/** @type {number} */ by) => {
    const { width, height } = painter.size();
    painter.look(zoomed(painter.view(), by, [width / 2, height / 2]));
  };
  const jumps = h(
    'button',
    {
      title: 'Way of the beam with the laser off (J)',
      on: { click: () => store.update((s) => S.looking({ jumps: !s.stage.jumps })(s)) },
    },
    'Jumps',
  );
  const numbers = h(
    'button',
    {
      title: 'Order of the cuts as numbers (N)',
      on: { click: () => store.update((s) => S.looking({ numbers: !s.stage.numbers })(s)) },
    },
    'Numbers',
  );
  const frames = h(
    'button',
    {
      id: 'frames',
      title: 'Sheet, print marks, axes and the field of the beam (A)',
      on: { click: () => store.update((s) => S.looking({ frames: !s.stage.frames })(s)) },
    },
    'Frames',
  );
  const show = ['drawing', 'machine'].map((name) =>
    h(
      'button',
      { 'data-show': name, on: { click: () => store.update(S.looking({ show: /** @type {any} */ (name) })) } },
      name === 'drawing' ? 'Drawing' : 'Machine',
    ),
  );
  const views = h('div', { class: 'segment', role: 'group', 'aria-label': 'What is shown' }, show);
  watch(
    store,
    (s) => [s.stage],
    ({ stage }) => {
      for (const button of tools) button.setAttribute('aria-pressed', String(button.dataset.tool === stage.tool));
      for (const button of show) button.setAttribute('aria-pressed', String(button.dataset.show === stage.show));
      frames.setAttribute('aria-pressed', String(stage.frames));
      jumps.setAttribute('aria-pressed', String(stage.jumps));
      numbers.setAttribute('aria-pressed', String(stage.numbers));
    },
  );
  const bar = h(
    'div',
    { class: 'stage-bar', role: 'toolbar', 'aria-label': 'Tools of the drawing' },
    h('div', { class: 'segment', role: 'group', 'aria-label': 'What the pointer does' }, tools),
    h(
      'div',
      { class: 'segment', role: 'group', 'aria-label': 'Zoom' },
      h('button', { 'aria-label': 'Smaller', title: 'Smaller (−)', on: { click: () => zoom(0.8) } }, '−'),
      h('button', { title: 'Show all (F)', on: { click: () => painter.fit() } }, 'Fit'),
      h('button', { 'aria-label': 'Larger', title: 'Larger (+)', on: { click: () => zoom(1.25) } }, '+'),
    ),
    jumps,
    numbers,
    frames,
    h('span', { class: 'gap' }),
    views,
  );
  watch(
    store,
    (s) => [s.job === null],
    (s) => {
      bar.hidden = s.job === null;
    },
  );
  return bar;
}

/** @param {S.State} s */
function legendOf(s) {
  const used = new Set(entitiesOf(s).map((e) => e.process));
  const motion = motionOf(s);
  const most = {
    power: motion && `${((motion.mostPower / 255) * motion.full_power_w).toFixed(0)} W`,
    speed: motion && `${motion.mostSpeed.toFixed(0)} mm/s`,
    reach: 'edge of the reach',
  };
  return [
    ...kProcesses.filter((p) => used.has(p)).map((p) => h('span', {}, swatch(p), p)),
    motion &&
      h('span', {}, s.stage.colour === 'reach' ? 'middle' : '0', h('i', { class: 'ramp' }), most[s.stage.colour]),
    ...frameLegend(s),
  ];
}

/** Signs of the frames, as they are painted. @param {S.State} s */
function frameLegend(s) {
  if (!s.stage.frames || entitiesOf(s).length === 0) return [];
  const { sheet, marks, field, rest } = framesOf(s.check.value, motionOf(s), 0);
  const sign = (/** @type {string} */ name, /** @type {any[]} */ ...shapes) =>
    svg('svg', { class: `sign ${name}`, viewBox: '0 0 18 12', 'aria-hidden': 'true' }, shapes);
  return [
    field && h('span', {}, sign('field', svg('rect', { x: 1, y: 1, width: 16, height: 10 })), 'field: what the beam reaches'),
    sheet && h('span', {}, sign('sheet', svg('rect', { x: 1, y: 1, width: 16, height: 10 })), 'sheet (its edges are not known)'),
    marks.length > 0 && h('span', {}, sign('marks', svg('circle', { cx: 9, cy: 6, r: 4 })), 'print marks'),
    h('span', {}, sign('axes', svg('path', { d: 'M3 1v9h12' })), 'axes x, y of the sheet; the belt runs along x'),
    rest && h('span', {}, sign('rest', svg('path', { d: 'M9 0v12M3 6h12' }), svg('circle', { cx: 9, cy: 6, r: 3.5 })), 'beam at rest: x_W = y_W = 0'),
  ];
}

/** What is known of what was chosen or measured. @param {S.State} s @returns {[string, string][]} */
function factsOf(s) {
  const [a, b] = s.stage.measure;
  if (a && b) {
    const m = measured(a, b);
    return [
      ['Distance', `${m.distance_mm.toFixed(3)} mm`],
      ['Δx', `${m.dx_mm.toFixed(3)} mm`],
      ['Δy', `${m.dy_mm.toFixed(3)} mm`],
      ['Angle', `${m.angle_deg.toFixed(2)}°`],
    ];
  }
  const ids = new Set(s.selected);
  const chosen = entitiesOf(s).filter((e) => ids.has(e.id));
  if (chosen.length === 0) return [];
  const length = chosen.reduce((sum, e) => sum + e.length_mm, 0);
  if (chosen.length > 1)
    return [
      ['Entities', String(chosen.length)],
      ['Length', `${length.toFixed(2)} mm`],
    ];
  const [e] = chosen;
  const place = (s.plan.value?.order ?? []).indexOf(e.id);
  /** @type {[string, string][]} */
  const facts = [
    ['Entity', `E${e.id}`],
    ['Layer', e.layer],
    ['Length', `${e.length_mm.toFixed(3)} mm`],
  ];
  if (place >= 0) facts.push(['Place', String(place + 1)]);
  if (e.line > 0) facts.push(['Drawn', `${S.baseName(s.check.value.drawing.file)}, line ${e.line}`]);
  return facts;
}

/** What to do where there is nothing yet. @param {Element} stage @param {Store} store @param {import('../actions.js').Actions} actions */
function mountEmpty(stage, store, actions) {
  const box = h('div', { class: 'empty' });
  stage.append(box);
  const load = () => document.getElementById('file')?.click();
  watch(
    store,
    (s) => [s.job === null, s.check, s.session, s.files, s.busy],
    (s) => {
      const drawn = entitiesOf(s).length > 0;
      box.hidden = drawn || (s.job !== null && s.check.state === 'busy' && !s.check.value);
      if (box.hidden) return;
      if (s.job === null) {
        const shipped = s.files.scenarios.find(
          (/** @type {any} */ f) => /label-on-belt\.yaml$/.test(f.path) && S.isShipped(f.path),
        );
        fill(
          box,
          h(
            'div',
            { class: 'drop-zone' },
            h('h1', {}, 'Drop a drawing here'),
            h(
              'p',
              {},
              'A DXF or SVG becomes a scenario: marks around it, a machine, a release that cuts it. Start then cuts it on the digital twin and says whether every cut is where it belongs.',
            ),
            h(
              'div',
              { class: 'acts' },
              h('button', { class: 'primary', on: { click: load } }, 'Load a drawing…'),
              shipped &&
                h('button', { on: { click: () => actions.open(shipped.path) } }, 'Look at a label on the belt'),
            ),
          ),
          h('p', {}, 'Or choose a scenario on the left.'),
        );
      } else if (s.check.state === 'failed') {
        fill(box, h('h1', {}, 'The scenario cannot be checked'), h('p', {}, s.check.fault?.message ?? ''));
      } else if (s.check.value) {
        fill(
          box,
          h('h1', {}, 'No drawing to show'),
          h(
            'p',
            {},
            s.check.value.drawing
              ? 'The drawing has no lines that are cut.'
              : 'The drawing cannot be read. What is wrong with it is beside “Drawing” on the left; choose another one there, or drop one here.',
          ),
        );
      } else fill(box);
    },
  );
}
