// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import { commandOf, quoted } from '../src/job/command.js';
import { entitiesChosen, entityOfLine, lineChosen, linesOfEntities } from '../src/job/links.js';
import { periodOfLine } from '../src/job/motion.js';
import { idWords, moved, nudged } from '../src/job/order.js';
import { nameInScenario, pathOfName } from '../src/job/paths.js';
import { headOf, itemsOf } from '../src/job/stage/findings.js';
import * as S from '../src/job/state.js';
import { createStore, watch } from '../src/shared/store.js';

const open = (path = 'a.yaml', text = 'name: a\n') => S.opened(S.initialState(), path, text);
const good = (state) =>
  S.answered(S.answered(state, 'check', { issues: [], fits: true, drawing: null, values: {} }), 'plan', {
    issues: [],
    gcode: 'G00\n',
  });

test('what was edited is undone and done again', () => {
  let s = S.edited(S.edited(open(), 'b'), 'c');
  assert.ok(S.isChanged(s.job));
  s = S.undone(S.undone(s));
  assert.equal(s.job.text, 'name: a\n');
  assert.ok(!S.isChanged(s.job));
  assert.equal(S.undone(s), s);
  s = S.redone(S.redone(s));
  assert.equal(s.job.text, 'c');
  assert.equal(S.redone(s), s);
  // A new edit forgets what was undone.
  s = S.edited(S.undone(s), 'd');
  assert.equal(S.redone(s).job.text, 'd');
});

test('the same text is no edit', () => {
  const s = open();
  assert.equal(S.edited(s, s.job.text), s);
});

test('G-code by hand is a change until it is saved', () => {
  let s = S.gcodeEdited(good(open()), 'G01 X1\n');
  assert.ok(S.isChanged(s.job));
  assert.ok(S.isByHand(s));
  assert.equal(S.gcodeOf(s), 'G01 X1\n');
  s = S.saved(s, 'a.yaml', s.job.text);
  assert.ok(!S.isChanged(s.job));
  assert.equal(S.gcodeOf(s), 'G00\n');
});

test('a scenario that names its G-code is by hand', () => {
  const s = S.answered(open(), 'check', { issues: [], values: { 'planner.gcode': 'x.gcode' } });
  assert.ok(S.isByHand(s));
});

test('Start needs a job, a check without errors, and no other run', () => {
  assert.notEqual(S.whyNotStart(S.initialState()), '');
  assert.equal(S.whyNotStart(open()), '', 'it waits for the check');
  assert.ok(S.isUnsettled(open()) && !S.isUnsettled(good(open())));
  assert.ok(S.isUnsettled({ ...good(open()), editing: 1 }), 'a field that was just left');
  assert.equal(S.whyNotStart(good(open())), '');
  const bad = S.answered(good(open()), 'check', {
    issues: [
      { message: 'x', severity: 'error' },
      { message: 'y', severity: 'error' },
    ],
  });
  assert.match(S.whyNotStart(bad), /^2 faults/);
  const noted = S.answered(good(open()), 'check', { issues: [{ message: 'x', severity: 'warning' }] });
  assert.equal(S.whyNotStart(noted), '');
  const unfit = S.answered(good(open()), 'plan', {
    issues: [{ message: 'too fast', severity: 'error', line: 3 }],
    gcode: '',
  });
  assert.match(S.whyNotStart(unfit), /^One fault/);
  assert.notEqual(S.whyNotStart({ ...good(open()), run: { state: 'running' } }), '');
  assert.notEqual(S.whyNotStart({ ...good(open()), session: { can_run: false } }), '');
});

test('what is shipped is changed in a copy alone', () => {
  const s = good(open('shipped/scenarios/label.yaml'));
  assert.equal(S.whyNotStart(s), '', 'it runs as it is');
  assert.match(S.whyNotStart(S.edited(s, 'other')), /copy/);
});

test('faults of a scenario are not told twice by the plan that fails for them', () => {
  const s = S.refused(S.answered(open(), 'check', { issues: [{ message: 'bad key', severity: 'error' }] }), 'plan', {
    message: 'bad key',
    issues: [],
  });
  assert.equal(S.obstacles(s).length, 1);
});

test('an answer forgets entities that are gone, and keeps the others chosen', () => {
  let s = { ...open(), selected: [1, 2, 3] };
  s = S.answered(s, 'check', { issues: [], drawing: { entities: [{ id: 3 }, { id: 1 }] } });
  assert.deepEqual(s.selected, [1, 3]);
});

test('the order that was moved is shown until it is planned', () => {
  let s = S.having({ orderDraft: [2, 1] })(S.answered(open(), 'plan', { issues: [], order: [1, 2] }));
  assert.deepEqual(S.orderOf(s), [2, 1]);
  s = S.answered(s, 'plan', { issues: [], order: [2, 1] });
  assert.equal(s.orderDraft, null);
  assert.deepEqual(S.orderOf(s), [2, 1]);
});

const plan = {
  issues: [],
  gcode: '',
  order: [5, 9],
  entity_lines: [
    { entity: 5, line_first: 2, line_last: 3 },
    { entity: 9, line_first: 5, line_last: 5 },
  ],
  preview: {
    x_mm: new Array(11).fill(0),
    line: [
      [2, 3],
      [3, 4],
      [5, 4],
    ],
  },
};

test('entities, lines and periods lead to each other', () => {
  assert.equal(entityOfLine(plan.entity_lines, 3), 5);
  assert.equal(entityOfLine(plan.entity_lines, 4), null);
  assert.deepEqual(linesOfEntities(plan.entity_lines, [9, 5]), [2, 3, 5]);
  assert.equal(periodOfLine(plan.preview, 2), 0);
  assert.equal(periodOfLine(plan.preview, 3), 2);
  assert.equal(periodOfLine(plan.preview, 5), 6);
  assert.equal(periodOfLine(plan.preview, 4), null);
  const s = S.answered(open(), 'plan', plan);
  const byLine = lineChosen(s, 5);
  assert.deepEqual([byLine.selected, byLine.period, byLine.line], [[9], 6, 5]);
  const byEntity = entitiesChosen(s, [9]);
  assert.deepEqual([byEntity.selected, byEntity.period, byEntity.line], [[9], 6, 5]);
  const two = entitiesChosen(byEntity, [5], 'toggle');
  assert.deepEqual([two.selected, two.line], [[9, 5], 2]);
  assert.deepEqual(entitiesChosen(two, [5], 'toggle').selected, [9]);
  assert.deepEqual(entitiesChosen(two, []).selected, []);
});

test('lines of G-code that was edited since are not taken for those of the plan', () => {
  const s = S.asked(S.answered(open(), 'plan', plan), 'plan');
  assert.deepEqual(lineChosen(s, 5).selected, []);
});

test('moving keeps every entity once', () => {
  const order = [4, 7, 1, 9, 3];
  for (let to = 0; to <= order.length; ++to) {
    const next = moved(order, [9, 7], to);
    assert.deepEqual([...next].sort(), [...order].sort());
    assert.equal(next.indexOf(9) - next.indexOf(7), 1, 'they stay together, in their own order');
  }
  assert.deepEqual(moved(order, [3], 0), [3, 4, 7, 1, 9]);
  assert.deepEqual(moved(order, [4], 5), [7, 1, 9, 3, 4]);
});

test('a nudge is one place, and ends at the ends', () => {
  assert.deepEqual(nudged([1, 2, 3, 4], [3], -1), [1, 3, 2, 4]);
  assert.deepEqual(nudged([1, 2, 3, 4], [2, 3], 1), [1, 4, 2, 3]);
  assert.deepEqual(nudged([1, 2, 3], [1], -1), [1, 2, 3]);
  assert.deepEqual(nudged([1, 2, 3], [3], 1), [1, 2, 3]);
  assert.deepEqual(nudged([1, 2, 3], [8], 1), [1, 2, 3]);
});

test('ids are written as lint writes them', () => {
  assert.equal(idWords([3, 5, 6, 7, 9, 10]), '3,5-7,9,10');
  assert.equal(idWords([]), '');
});

test('names of files are relative to the scenario, and found again', () => {
  const places = { folder: '/home/me/jobs', shipped: '/opt/kerfbench/fixtures' };
  const cases = [
    ['a.yaml', 'b.dxf', 'b.dxf'],
    ['x/a.yaml', 'b.dxf', '../b.dxf'],
    ['a.yaml', 'x/b.dxf', 'x/b.dxf'],
    ['a.yaml', 'shipped/machines/m.yaml', '../../../opt/kerfbench/fixtures/machines/m.yaml'],
    ['shipped/scenarios/n/a.yaml', 'shipped/machines/m.yaml', '../../machines/m.yaml'],
  ];
  for (const [scenario, file, name] of cases) {
    assert.equal(nameInScenario(places, scenario, file), name);
    assert.equal(pathOfName(places, scenario, name, ['other', file]), file);
  }
  assert.equal(pathOfName(places, 'a.yaml', 'gone.dxf', ['b.dxf']), 'gone.dxf');
});

test('the command is one that a shell takes as it is', () => {
  assert.equal(quoted('a b.yaml'), "'a b.yaml'");
  assert.equal(quoted("it's"), "'it'\\''s'");
  assert.equal(quoted('shipped/a-1.yaml'), 'shipped/a-1.yaml');
  assert.equal(commandOf(open('my job.yaml')), "kerfbench run 'my job.yaml'");
  assert.equal(
    commandOf({ ...open(), run: { state: 'running', scenario: 'b.yaml', command: 'kerfbench run b.yaml --seed 3' } }),
    'kerfbench run b.yaml --seed 3',
  );
});

test('a store tells changes in their order, and watchers only what they look at', () => {
  const store = createStore({ a: 0, b: 0 });
  const seen = [];
  watch(
    store,
    (s) => [s.a],
    (s) => seen.push(s.a),
  );
  store.subscribe((s) => {
    if (s.a === 1) store.update((t) => ({ ...t, a: 2 }));
  });
  store.update((s) => ({ ...s, b: 5 }));
  store.update((s) => ({ ...s, a: 1 }));
  assert.deepEqual(seen, [0, 1, 2]);
  assert.deepEqual(store.get(), { a: 2, b: 5 });
});

test('a firmware with a job of its own needs no plan', () => {
  let s = S.answered(open(), 'check', { issues: [], fits: true, values: { 'firmware.dialog': 'line-ok' } });
  s = S.refused(s, 'plan', { message: 'no planner serves line-ok', issues: [] });
  assert.equal(S.whyNotStart(s), '');
  assert.match(headOf(s, itemsOf(s)), /no preview/);
});

test('findings of drawing and plan are one list, accepted ones left out', () => {
  const finding = { kind: 'gap', severity: 'error', message: 'a gap', where_mm: [1, 2], entities: [3], line: 9 };
  let s = S.answered(open(), 'check', {
    issues: [],
    fits: true,
    values: {},
    drawing: {
      entities: [],
      findings: [finding, { ...finding, accepted: true }, { ...finding, severity: 'warning', entities: [] }],
    },
  });
  s = S.answered(s, 'plan', {
    issues: [{ line: 4, message: 'beyond the field', severity: 'error', source: 'gcode' }],
    gcode: '',
  });
  const items = itemsOf(s);
  assert.deepEqual(
    items.map((i) => [i.number, i.place]),
    [
      [1, 'line 9 of the drawing'],
      [2, 'line 9 of the drawing'],
      [3, 'G-code, line 4'],
    ],
  );
  assert.equal(headOf(s, items), '2 faults, 1 note');
  assert.notEqual(S.whyNotStart(s), '', 'a fault of the drawing keeps the job from running');
});

test('every error is told somewhere: beside its field, or where the scenario is chosen', () => {
  const reference = [{ title: 'Belt', keys: [{ path: 'belt.speed_mm_s' }] }];
  const issue = (key, file = '') => ({ key, file, severity: 'error', message: key });
  const issues = [
    issue('belt.speed_mm_s'),
    issue('planer'),
    issue('machine'),
    issue(''),
    issue('layers.X'),
    issue('kind', 'm.yaml'),
  ];
  const told = (drawing) =>
    S.unplaced(S.answered({ ...open(), reference }, 'check', { issues, drawing })).map((i) => i.message);
  assert.deepEqual(told({ entities: [] }), ['planer', '', 'kind']);
  assert.deepEqual(told(null), ['planer', '']);
});

test('a line that is looked at is looked at in the next plan, too', () => {
  const s = lineChosen(S.answered(open(), 'plan', plan), 5);
  const later = {
    ...plan,
    preview: {
      ...plan.preview,
      line: [
        [2, 5],
        [3, 5],
        [5, 4],
      ],
    },
  };
  assert.equal(S.answered(s, 'plan', later).period, 9);
});
