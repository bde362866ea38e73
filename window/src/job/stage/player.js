// SPDX-License-Identifier: Apache-2.0
// Plays the preview: the periods of the program itself, as fast or slow as one likes, line by line and period by period.
// @ts-check
import { fill, h, mark, say } from '../../shared/dom.js';
import { icon } from '../../shared/icons.js';
import { watch } from '../../shared/store.js';
import { lineOn, momentAt, usualSpeed } from '../motion.js';
import * as S from '../state.js';
import { motionOf } from './painter.js';

const kSpeeds = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];

/** @param {Element} element @param {import('../page.js').Store} store */
export function mountPlayer(element, store) {
  const get = store.get;
  /** @param {number} period */
  const to = (period) => {
    const motion = motionOf(get());
    if (motion) store.update(S.having({ period: Math.min(Math.max(period, 0), motion.n - 1) }));
  };
  const halt = () => store.update(S.having({ playing: false }));
  const byPeriod = (/** @type {1 | -1} */ sense) => {
    halt();
    to(sense > 0 ? Math.floor(get().period + 1 + 1e-9) : Math.ceil(get().period - 1 - 1e-9));
  };
  const byLine = (/** @type {1 | -1} */ sense) => {
    const motion = motionOf(get());
    halt();
    if (motion) to(lineOn(motion, get().period, sense));
  };
  const toggle = () => {
    const motion = motionOf(get());
    if (!motion) return;
    if (!get().playing && get().period >= motion.n - 1) to(0);
    store.update((s) => S.having({ playing: !s.playing })(s));
  };
  const button = (
    /** @type {string} */ label,
    /** @type {any} */ sign,
    /** @type {() => void} */ act,
    /** @type {string} */ key,
  ) => h('button', { 'aria-label': label, title: `${label} (${key})`, on: { click: act } }, icon(sign));
  const play = h('button', { id: 'play', title: 'Play, pause (Space)', on: { click: toggle } });
  const buttons = h(
    'div',
    { class: 'buttons' },
    button(
      'To the start',
      'first',
      () => {
        halt();
        to(0);
      },
      'Home',
    ),
    button('One line back', 'lineBack', () => byLine(-1), 'Page Up'),
    button('One period back', 'periodBack', () => byPeriod(-1), ','),
    play,
    button('One period on', 'periodOn', () => byPeriod(1), '.'),
    button('One line on', 'lineOn', () => byLine(1), 'Page Down'),
  );
  const scrub = h('input', {
    type: 'range',
    id: 'scrub',
    min: 0,
    step: 1,
    value: 0,
    'aria-label': 'Period of the program',
    on: {
      input: () => {
        halt();
        to(Number(scrub.value));
      },
    },
  });
  const time = h('output', { id: 'time', for: 'scrub' });
  const speed = h(
    'select',
    { id: 'speed', 'aria-label': 'Speed of the preview' },
    kSpeeds.map((s) => h('option', { value: s }, `${s} ×`)),
  );
  const colour = h(
    'select',
    {
      id: 'colour',
      'aria-label': 'Colour of the cuts in the preview',
      on: { change: () => store.update(S.looking({ colour: colour.value })) },
    },
    ['power', 'speed', 'reach'].map((name) => h('option', { value: name }, name)),
  );
  const facts = { line: h('b'), speed: h('b'), power: h('b'), place: h('b'), cut: h('b') };
  const moment = h(
    'div',
    { class: 'moment' },
    h('span', {}, 'G-code line ', facts.line),
    h('span', {}, 'Speed ', facts.speed),
    h('span', {}, 'Power ', facts.power),
    h('span', {}, 'Place ', facts.place),
    h('span', {}, 'Cut ', facts.cut),
  );
  const player = h(
    'div',
    { class: 'player', role: 'group', 'aria-label': 'Preview' },
    scrub,
    h('div', { class: 'transport' }, buttons, time, speed, colour),
    moment,
  );
  element.append(player);

  watch(
    store,
    (s) => [s.plan.value, s.check.value?.machine],
    (s) => {
      const motion = motionOf(s);
      player.hidden = !motion;
      if (!motion) return;
      scrub.max = motion.n - 1;
      speed.value = String(usualSpeed(motion.duration_s, kSpeeds));
    },
  );
  watch(
    store,
    (s) => [s.period, s.plan.value, s.check.value?.machine],
    (s) => {
      const motion = motionOf(s);
      if (!motion) return;
      const now = momentAt(motion, s.period);
      scrub.value = String(Math.round(s.period));
      mark(scrub, 'aria-valuetext', `${now.t_s.toFixed(4)} seconds, G-code line ${now.line}`);
      say(time, `${now.t_s.toFixed(4)} s of ${motion.duration_s.toFixed(3)} s`);
      say(facts.line, now.line > 0 ? now.line : '–');
      say(facts.speed, `${now.speed_mm_s.toFixed(0)} mm/s`);
      say(facts.power, now.lit ? `${now.power_w.toFixed(1)} W` : 'off');
      say(facts.place, `x ${now.x_mm.toFixed(3)}  y ${now.y_mm.toFixed(3)} mm`);
      say(facts.cut, `${now.cut_mm.toFixed(1)} mm`);
    },
  );
  watch(
    store,
    (s) => [s.stage.colour],
    (s) => {
      colour.value = s.stage.colour;
    },
  );
  let last_ms = 0;
  const frame = (/** @type {number} */ now_ms) => {
    const s = get();
    const motion = motionOf(s);
    if (!s.playing || !motion) return;
    const on = (((now_ms - last_ms) / 1000) * Number(speed.value)) / motion.step_s;
    last_ms = now_ms;
    if (s.period + on >= motion.n - 1) store.update(S.having({ period: motion.n - 1, playing: false }));
    else {
      to(s.period + on);
      requestAnimationFrame(frame);
    }
  };
  watch(
    store,
    (s) => [s.playing],
    (s) => {
      fill(play, icon(s.playing ? 'pause' : 'play'), s.playing ? 'Pause' : 'Play');
      if (!s.playing) return;
      requestAnimationFrame((now_ms) => {
        last_ms = now_ms;
        requestAnimationFrame(frame);
      });
    },
  );
  addEventListener('keydown', (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    // Keys of the player are for the middle of the page; a field or an editor has its own.
    if (
      event.ctrlKey ||
      event.metaKey ||
      event.altKey ||
      !target.closest?.('.stage, .player') ||
      target.closest('select, .live')
    )
      return;
    const acts = {
      ' ': target.closest('button') ? null : toggle,
      ',': () => byPeriod(-1),
      '.': () => byPeriod(1),
      PageUp: () => byLine(-1),
      PageDown: () => byLine(1),
      Home: () => {
        halt();
        to(0);
      },
      End: () => {
        halt();
        to(Infinity);
      },
    };
    const act = /** @type {any} */ (acts)[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}
