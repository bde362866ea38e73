// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { releaseKeys } from '../src/job/choices.js';
import * as R from '../src/job/reference.js';
import { freeName, tameName } from '../src/job/arrivals.js';
import { faultOfName } from '../src/job/save_as.js';

const key = (path, more = {}) => ({
  key: path.split('.').pop(),
  path,
  kind: 'number',
  count: 1,
  least: 0,
  most: 100,
  choices: [],
  default: '',
  required: false,
  unit: '',
  help_html: '',
  ...more,
});
const speed = key('belt.speed_mm_s', {
  least: 0,
  most: 5000,
  unit: 'mm/s',
  required: true,
  help_html: 'Speed of the belt.',
});
const kerf = key('planner.kerf_radius_mm', {
  most: 2,
  unit: 'mm',
  default: '0',
  help_html: 'Half the <code>kerf</code>.',
});
const profile = key('belt.profile', { kind: 'choice', choices: ['constant'], or_list: true, least: null, most: null });
const marks = key('print.marks', { kind: 'list', least: null, most: null });
const sections = [
  { title: 'Belt', prefixes: ['belt.'], keys: [speed, profile, key('belt.profile[].at_s')] },
  { title: 'Planner', prefixes: ['planner.'], keys: [kerf] },
  { title: 'Print', prefixes: ['print.'], keys: [marks] },
];

test('a field takes what is in its range, with either decimal sign', () => {
  assert.deepEqual(R.parsed(speed, ' 60 '), { value: 60 });
  assert.deepEqual(R.parsed(speed, '60,5'), { value: 60.5 });
  assert.deepEqual(R.parsed(speed, '1e3'), { value: 1000 });
  assert.match(R.parsed(speed, '-1').fault, /At least 0 mm\/s/);
  assert.match(R.parsed(speed, '5001').fault, /At most 5000 mm\/s/);
  assert.match(R.parsed(speed, 'fast').fault, /fast/);
  assert.match(R.parsed(speed, '').fault, /required/);
  assert.match(R.parsed(speed, 'Infinity').fault, /not a number/);
  assert.match(R.parsed(speed, '1,000,000').fault, /not a number/);
});

test('several numbers need their count', () => {
  const shift = key('dieline.shift', { kind: 'numbers', count: 2, least: -10, most: 10 });
  assert.deepEqual(R.parsed(shift, '1, -2'), { value: [1, -2] });
  assert.deepEqual(R.parsed(shift, '[1 2]'), { value: [1, 2] });
  assert.ok('fault' in R.parsed(shift, '1'));
  assert.ok('fault' in R.parsed(shift, '1, 20'));
});

test('choices and flags', () => {
  const order = key('planner.order', { kind: 'choice', choices: ['shortest', 'drawn'] });
  assert.deepEqual(R.parsed(order, 'drawn'), { value: 'drawn' });
  assert.ok('fault' in R.parsed(order, 'best'));
  assert.deepEqual(R.parsed(key('planner.alternate', { kind: 'flag' }), 'true'), { value: true });
});

test('only what is set is shown, lists by their entries', () => {
  const shown = R.setKeys(sections, { 'belt.speed_mm_s': 60, 'print.marks[0].x_mm': 1, 'print.marks[0].y_mm': 2 });
  assert.deepEqual(
    shown.map((s) => s.keys.map((k) => k.path)),
    [['belt.speed_mm_s'], ['print.marks']],
  );
});

test('the search finds names before help, and never what is set', () => {
  const values = { 'belt.speed_mm_s': 60 };
  assert.deepEqual(
    R.addable(sections, values, 'kerf').map((k) => k.path),
    ['planner.kerf_radius_mm'],
  );
  assert.deepEqual(R.addable(sections, values, 'speed'), []);
  assert.deepEqual(
    R.addable(sections, {}, 'belt sp').map((k) => k.path),
    ['belt.speed_mm_s'],
  );
  assert.deepEqual(R.addable(sections, {}, 'zebra'), []);
});

test('a parameter begins with its default', () => {
  assert.equal(R.firstValue(kerf), 0);
  assert.equal(
    R.firstValue(key('a.b', { kind: 'flag', default: 'false' })),
    true,
    'a flag that is added is meant to be set',
  );
  assert.equal(R.firstValue(key('a.c', { kind: 'choice', choices: ['x', 'y'], default: 'y' })), 'y');
  assert.ok('value' in R.parsed(speed, String(R.firstValue(speed))));
});

test('labels leave out the unit that stands in the field', () => {
  assert.equal(R.label(speed), 'speed');
  assert.equal(R.label(kerf), 'kerf radius');
  assert.equal(R.label(key('planner.alternate')), 'alternate');
});

test('a release is set with all that belongs to it, and nothing else', () => {
  const avr = {
    path: 'shipped/firmware/c.hex',
    firmware: { source: 'avr', image: 'c.hex', mcu: 'atmega2560', clock_hz: 16000000 },
  };
  const values = { 'firmware.source': 'native', 'firmware.image': 'n', 'firmware.baud': 2000000 };
  assert.deepEqual(releaseKeys(avr, values, 'ignored'), [
    { path: 'firmware.source', value: 'avr' },
    { path: 'firmware.image', value: 'c.hex' },
    { path: 'firmware.mcu', value: 'atmega2560' },
    { path: 'firmware.clock_hz', value: 16000000 },
    { path: 'firmware.baud', value: null },
  ]);
  assert.deepEqual(
    releaseKeys({ path: 'mine.hex' }, { 'firmware.source': 'avr', 'firmware.image': 'c.hex' }, 'mine.hex'),
    [{ path: 'firmware.image', value: 'mine.hex' }],
  );
});

test('names of dropped files become names that the server takes, and overwrite nothing', () => {
  assert.equal(tameName('Schachtel für Käse.dxf'), 'Schachtel fur Kase.dxf');
  assert.equal(tameName('../../etc/passwd'), 'etc-passwd');
  assert.equal(tameName('<img src=x>.svg'), 'img src-x-.svg');
  assert.match(tameName('漢字.dxf'), /^[A-Za-z0-9_-][A-Za-z0-9 ._-]*$/);
  assert.equal(freeName('a.dxf', new Set(['a.dxf', 'a-2.dxf'])), 'a-3.dxf');
});

test('a name for saving', () => {
  const taken = new Set(['a.yaml']);
  assert.equal(faultOfName('b', taken), '');
  for (const name of ['', 'a', '../b', '.b', 'b/c', 'b\n']) assert.notEqual(faultOfName(name, taken), '', name);
});
