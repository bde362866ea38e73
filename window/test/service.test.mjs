// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { beginCommand, freeFolder, groupsOf } from '../src/service/begin.js';
import { bySheet, calibrationWords, holdsWords, kindOf, ownCalibrations, progressOf, sheetWords } from '../src/service/steps.js';

const step = (id, sheet, state) => ({ id, sheet, state, title: id, text: [], files: [], found: [], wrong: [] });
const steps = {
  steps: [
    step('a', '1-grid', 'done'),
    step('b', '1-grid', 'now'),
    step('c', '2-check', 'later'),
    step('d', '', 'later'),
  ],
};

test('steps are shown sheet by sheet, in their order', () => {
  assert.deepEqual(
    bySheet(steps).map((g) => [sheetWords(g.sheet), g.steps.map((s) => s.id).join('')]),
    [
      ['Sheet 1: grid', 'ab'],
      ['Sheet 2: check', 'c'],
      ['Then', 'd'],
    ],
  );
});

test('what is to be done now is the first that is', () => {
  assert.deepEqual([progressOf(steps).done, progressOf(steps).now.id], [1, 'b']);
  assert.equal(progressOf({ steps: [] }).now, null);
});

test('a verdict has the colour of what it says', () => {
  assert.deepEqual(['GOOD', 'HOLDS', 'NOT GOOD', 'DOES NOT HOLD', 'NOT PROVEN', ''].map(kindOf), [
    'pass',
    'pass',
    'fail',
    'fail',
    'unproven',
    'none',
  ]);
});

test('a calibration says what it is made of, and the folder which cameras and scanners it knows', () => {
  const files = [
    { path: 'head/1-grid/pictures/scan.png', kind: 'scan' },
    { path: 'head/1-grid/pictures/tiles.yaml', kind: 'tiles' },
    { path: 'head/2-grid/pictures/scan.jpg', kind: 'scan' },
    { path: 'header/scan.png', kind: 'scan' },
    { path: 'glass.yaml', kind: 'scanner', id: 'glass-1', date: '2026-11-21' },
    { path: 'shipped/machines/a.camera.yaml', kind: 'camera', id: 'a' },
    { path: 'target.yaml', kind: 'target' },
  ];
  assert.equal(holdsWords(files, 'head'), '2 scans, 1 list of pictures (tiles.yaml)');
  assert.equal(holdsWords(files, 'none'), '');
  assert.deepEqual(ownCalibrations(files).map(calibrationWords), [
    'glass.yaml: scanner glass-1 of 2026-11-21',
    'target.yaml: target',
  ]);
});

test('a calibration is begun by a command that a shell takes, in a folder that is free', () => {
  assert.equal(
    beginCommand('my machine.yaml', 'results/head', '/usr/share/kerfbench'),
    "kerfbench calibrate head --by-hand --machine 'my machine.yaml' --results-dir results/head",
  );
  assert.match(beginCommand('shipped/machines/a.yaml', 'results/head', '/opt/k/'), /--machine \/opt\/k\/machines\/a\.yaml /);
  assert.equal(freeFolder([]), 'results/head');
  assert.equal(freeFolder([{ path: 'results/head' }, { path: 'head-2' }]), 'results/head-3');
});

test('own machines come before the shipped ones', () => {
  const machines = [{ path: 'shipped/machines/a.yaml' }, { path: 'mine.yaml' }];
  assert.deepEqual(
    groupsOf(machines).map(({ machines: of }) => of[0].path),
    ['mine.yaml', 'shipped/machines/a.yaml'],
  );
  assert.deepEqual(groupsOf([]), []);
});
