// SPDX-License-Identifier: Apache-2.0
// WCAG 2.2 AA from the colours of base.css, in both schemes: 4.5 for text, 3 for what shows a control or a line of the drawing.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { rampColour } from '../src/job/motion.js';

const css = readFileSync(new URL('../src/shared/base.css', import.meta.url), 'utf8');
/** Variables of the n-th :root block. */
const block = (n) => {
  const text = [...css.matchAll(/:root\s*\{([^}]*)\}/g)][n][1];
  return Object.fromEntries(
    [...text.matchAll(/--([\w-]+):\s*(#[0-9a-f]{6})\b/g)].map(([, name, value]) => [name, value]),
  );
};
const light = block(0);
const schemes = { light, dark: { ...light, ...block(1) } };

const rgb = (colour) =>
  colour.startsWith('#')
    ? [1, 3, 5].map((i) => parseInt(colour.slice(i, i + 2), 16))
    : colour.match(/\d+/g).map(Number);
const luminance = (colour) => {
  const [r, g, b] = rgb(colour).map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const contrast = (a, b) => {
  const [x, y] = [luminance(a), luminance(b)].sort((p, q) => q - p);
  return (x + 0.05) / (y + 0.05);
};

const grounds = ['bg', 'card', 'stage'];
const text = [
  ...grounds.flatMap((g) => ['fg', 'mute', 'acc'].map((c) => [c, g])),
  ['on-acc', 'acc'],
  ['acc', 'acc-soft'],
  ['fg', 'acc-soft'],
  ['mute', 'acc-soft'],
  ...['pass', 'fail', 'np', 'inv'].flatMap((c) => [
    [c, 'bg'],
    [c, 'card'],
    [c, `${c}-soft`],
    ['fg', `${c}-soft`],
    ['mute', `${c}-soft`],
    ['acc', `${c}-soft`],
  ]),
  ['half-cut', 'bg'],
  ['crease', 'bg'],
  ['fg', 'field'],
  ['mute', 'field'],
  ['acc', 'stage'],
];
const shapes = [
  ...grounds.map((g) => ['edge', g]),
  // Frames around the drawing, and the borders of what asks for an answer.
  ['edge', 'field'],
  ['mute', 'field'],
  ['fg', 'field'],
  ['np', 'card'],
  ...['cut', 'crease', 'half-cut', 'perforation', 'ignore', 'jump', 'acc', 'fail'].flatMap((c) => [
    [c, 'stage'],
    [c, 'field'],
  ]),
];

test('the contrast of black on white is 21', () => assert.ok(Math.abs(contrast('#000000', '#ffffff') - 21) < 1e-9));

for (const [name, colours] of Object.entries(schemes)) {
  const check = (pairs, least) => {
    for (const [a, b] of pairs) {
      assert.ok(colours[a] && colours[b], `${a} or ${b} is not a colour of base.css`);
      const c = contrast(colours[a], colours[b]);
      assert.ok(c >= least, `${name}: --${a} on --${b} has ${c.toFixed(2)}, less than ${least}`);
    }
  };
  test(`${name}: text has 4.5`, () => check(text, 4.5));
  test(`${name}: controls and lines have 3`, () => check(shapes, 3));
}

test('the colours of the preview have 3 on both stages, and the legend shows the same', () => {
  for (let i = 0; i <= 20; ++i)
    for (const ground of ['stage', 'field'])
      for (const colours of Object.values(schemes))
        assert.ok(contrast(rampColour(i / 20), colours[ground]) >= 3, `${i} on ${ground}`);
  const css = readFileSync(new URL('../src/job/middle.css', import.meta.url), 'utf8');
  const legend = css.match(/linear-gradient\(\s*to right,([^;]*)\);/)[1].match(/rgb\([^)]*\)/g);
  assert.deepEqual(
    legend.map((c) => c.replace(/\s/g, '')),
    [0, 1, 2, 3, 4].map((i) => rampColour(i / 4)),
  );
});
