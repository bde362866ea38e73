// SPDX-License-Identifier: Apache-2.0
// The data layer on traces that are made here: by the summary, cut off, damaged, over HTTP, as a stream. It needs the packages
// of package.json; tests/window runs it where they are there.
import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { after, before, test } from 'node:test';
import { LiveTrace } from '../src/live/stream.js';
import { stepFrom } from '../src/time/steps.js';
import { Details } from '../src/trace/details.js';
import { TraceFile } from '../src/trace/file.js';
import { BlockCache, BlobReadable, BytesReadable, HttpReadable } from '../src/trace/readable.js';
import { Trace } from '../src/trace/trace.js';
import { lookAt } from './looks.mjs';
import { madeTrace } from './made_trace.mjs';
import { numbers } from './random.mjs';

const kSeconds = 6;
const machine = {
  machine: 'test', scenario: 'test', title: '', tick_hz: 1000, period_s: 0.01, quantum_s: 0.005, time_limit_s: 10, gcode: ['a', 'b'],
  signals: [{ id: 0, name: 'pul', from: 'controller' }], drives: [{ axis: 'x', pul: 0, dir: 1, active_edge: 'rising' }], web: { start_x_mm: 5 },
};

/** Edges of the pin 0, a pulse of 3 ticks every 17. */
const edges = Array.from({ length: Math.floor((1000 * kSeconds) / 17) }, (_, i) => [17 * i + 4, 17 * i + 7]).flat();

/** Chunks of a second: motion at 200 Hz in messages of 20 ms, pins, and in a chunk of its own the overview. */
function someChunks() {
  const chunks = [[{ topic: '/machine', time_s: 0, json: machine }]];
  for (let s = 0; s < kSeconds; ++s) {
    const motion = [];
    const pins = [];
    for (let m = 0; m < 50; ++m) {
      const t_s = [1, 2, 3, 4].map((i) => s + 0.02 * m + 0.005 * i);
      motion.push({ topic: '/motion', time_s: t_s[0], json: { t_s, belt_mm: t_s.map((t) => 60 * t), spot_x_mm: t_s.map((t) => (t < 3 ? t : null)), lit: t_s.map(() => 1) } });
      const own = edges.filter((tick) => tick >= 1000 * s + 20 * m && tick < 1000 * s + 20 * (m + 1));
      if (own.length)
        pins.push({ topic: '/pins', time_s: own[0] / 1000, json: { tick0: own[0], dt: own.map((tick, i) => (i ? tick - own[i - 1] : 0)), id: own.map(() => 0), level: own.map((tick) => (tick % 17 === 4 ? 1 : 0)) } });
    }
    if (s % 2 === 0) motion.push({ topic: '/gcode', time_s: s + 0.5, json: { t_s: [s + 0.5, s + 0.75], line: [1, 2], unit: [0, 0] } });
    chunks.push(motion, pins);
  }
  const rows = 10 * kSeconds;
  const level = Array.from({ length: rows }, (_, r) => edges.filter((tick) => tick < 100 * (r + 1)).length & 1);
  const counts = Array.from({ length: rows }, (_, r) => edges.filter((tick) => tick >= 100 * r && tick < 100 * (r + 1)).length);
  chunks.push([{ topic: '/overview/100ms', time_s: 0, json: { from_s: 0, step_s: 0.1, rows, pins: [{ id: 0, edges: counts, level }], columns: {}, lit_s: counts.map(() => 0.1) } }]);
  chunks.push([{ topic: '/checks', time_s: 2.5, json: { name: 'path', outcome: 'FAIL', time_s: 2.5 } }]);
  return chunks;
}

const chunks = someChunks();
const bytes = madeTrace(chunks);
const open = (data) => Trace.open(new BytesReadable(data));

test('a trace opens by its summary and tells the same as was written', async () => {
  const trace = await open(bytes);
  assert.equal(trace.file.complete, true);
  assert.deepEqual(trace.machine, machine);
  assert.deepEqual(trace.extent_s, { from: 0, to: kSeconds });
  assert.equal(trace.checks[0].outcome, 'FAIL');
  const tables = await trace.details.wait('/motion', -Infinity, Infinity);
  assert.deepEqual(tables.flatMap((table) => [...table.t_s]), chunks.flat().filter(({ topic }) => topic === '/motion').flatMap(({ json }) => json.t_s));
  for (const t_s of [0.006, 0.9999, 1.0001, 2.99, 4.2, 5.9]) assert.ok(Math.abs(trace.motionAt(t_s).belt_mm - 60 * t_s) < 1e-9, `${t_s}`);
  assert.ok(Number.isNaN(trace.motionAt(3.5).spot_x_mm), 'the beam missed the board');
});

test('pins of any span are the edges that were written, with the level before them', async () => {
  const trace = await open(bytes);
  const next = numbers(41);
  for (let round = 0; round < 40; ++round) {
    const from_s = kSeconds * next();
    const to_s = Math.min(kSeconds, from_s + next());
    await Promise.all([trace.details.wait('/pins', from_s - 0.2, to_s + 0.2), trace.details.wait('/overview/100ms', -Infinity, Infinity)]);
    const window = trace.pins(from_s, to_s);
    assert.ok(window.from_tick <= 1000 * from_s && window.to_tick >= 1000 * to_s);
    const pin = window.pins.get(0);
    assert.deepEqual([...pin.ticks], edges.filter((tick) => tick >= window.from_tick && tick < window.to_tick));
    assert.equal(pin.levelBefore, edges.filter((tick) => tick < window.from_tick).length & 1);
  }
});

test('steps find the next of each kind across chunks', async () => {
  const trace = await open(bytes);
  const to = async (kind, t_s, direction) => Math.round(1e6 * ((await stepFrom(trace, kind, t_s, direction)) ?? NaN)) / 1e6;
  assert.equal(await to('pulse', 0.999, 1), 1.007);
  assert.equal(await to('pulse', 1.001, -1), 0.99);
  assert.equal(await to('pulse', 0.004, -1), NaN);
  assert.equal(await to('line', 0.6, 1), 0.75);
  assert.equal(await to('line', 0.75, 1), 2.5, 'over a chunk without one');
  assert.equal(await to('line', 4.5, -1), 2.75);
  assert.equal(await to('line', 4.75, 1), NaN);
  assert.equal(await to('check', 0, 1), 2.5);
  assert.equal(await to('period', 0.0149, 1), 0.02);
});

for (const channelsFirst of [false, true]) {
  test(`a trace that was cut off anywhere opens up to its last whole chunk, channels ${channelsFirst ? 'before' : 'within'} the chunks`, async () => {
    const whole = await TraceFile.open(new BytesReadable(madeTrace(chunks, { channelsFirst })));
    const unfinished = madeTrace(chunks, { end: false, channelsFirst });
    const next = numbers(42);
    const lengths = Array.from({ length: 60 }, () => Math.floor(unfinished.length * next()));
    for (const length of [...lengths, ...whole.chunks.slice(1).map(({ offset, length: own }) => offset + own), unfinished.length]) {
      const cut = unfinished.subarray(0, length);
      const complete = whole.chunks.filter((chunk) => chunk.offset + chunk.length <= length);
      if (!complete.length) {
        await assert.rejects(TraceFile.open(new BytesReadable(cut)), /cut off|too short|no trace/);
        continue;
      }
      const file = await TraceFile.open(new BytesReadable(cut));
      assert.equal(file.complete, false);
      assert.equal(file.chunks.length, complete.length, `${length} bytes`);
      for (const topic of ['/motion', '/pins', '/machine']) {
        const count = (messages) => messages.filter((message) => message.topic === topic).length;
        assert.equal((await file.messagesOf(topic)).length, count(chunks.slice(0, complete.length).flat()), `${topic} of ${length} bytes`);
      }
    }
  });
}

test('what is no trace is refused with a sentence', async () => {
  await assert.rejects(open(new Uint8Array(3)), /too short/);
  await assert.rejects(open(new TextEncoder().encode('<!doctype html><html></html>')), /does not begin as an MCAP file/);
  await assert.rejects(open(madeTrace([[{ topic: '/motion', time_s: 0, json: { t_s: [0] } }]])), /what machine/);
});

test('a damaged chunk is told, and all others are shown', async () => {
  const file = await TraceFile.open(new BytesReadable(bytes));
  const damaged = Uint8Array.from(bytes);
  const [place] = file.chunksOf('/motion', 2.3, 2.4);
  const { offset, length } = file.chunks[place];
  damaged.fill(0xff, offset + length - 400, offset + length);
  const trace = await open(damaged);
  await trace.details.wait('/motion', -Infinity, Infinity);
  assert.equal(trace.details.failures.size, 1);
  assert.ok(Math.abs(trace.motionAt(4.2).belt_mm - 252) < 1e-9);
});

/** A minute in chunks of a second, motion and pins in turn as a run writes them. */
const minute = madeTrace([[{ topic: '/machine', time_s: 0, json: machine }], ...Array.from({ length: 120 }, (_, i) => {
  const t_s = [0.25, 0.5, 0.75].map((share) => (i >> 1) + share);
  return [i % 2 ? { topic: '/pins', time_s: t_s[0], json: { tick0: 0, dt: [0], id: [0], level: [1] } } : { topic: '/motion', time_s: t_s[0], json: { t_s, belt_mm: t_s } }];
})]);

test('chunks that lie together are read by one request, and no more of the file than them', async () => {
  const file = await TraceFile.open(new BytesReadable(minute));
  const details = new Details(file);
  for (const topic of ['/motion', '/pins']) details.peek(topic, 30.2, 30.6);
  await details.wait('/motion', 30.2, 30.6);
  const { length } = file.chunks[file.chunksOf('/pins', 30.2, 30.6)[0]];
  assert.equal(file.work.requests, 1);
  assert.equal(file.work.chunks, 2);
  assert.ok(file.work.bytes < 3 * length, `${file.work.bytes} bytes for two chunks of about ${length}`);
  assert.ok(details.peek('/pins', 30.2, 30.6).complete);
});

test('what is looked at last is read, and wishes that were overtaken are given up', async () => {
  /** Answers when it is told to, so that wishes pile up meanwhile. */
  const below = new BytesReadable(minute);
  let held = [];
  const slow = { size: () => below.size(), read: (...span) => new Promise((go) => held.push(() => go(below.read(...span)))) };
  const answer = () => { for (const go of held.splice(0)) go(); };
  const turn = () => new Promise((go) => setImmediate(go));
  /** @type {TraceFile | undefined} */
  let file;
  void TraceFile.open(slow).then((opened) => (file = opened));
  while (!file) {
    answer();
    await turn();
  }
  // Nothing lies together: each chunk is a request of its own.
  file.runsOf = (indexes) => indexes.map((index) => [index]);
  file.readable.readOnce = (...span) => slow.read(...span);
  const details = new Details(file);
  const looks = (s) => details.peek('/motion', s + 0.2, s + 0.6);
  for (let s = 0; s < 6; ++s) looks(s);
  await turn();
  assert.equal(held.length, 6, 'requests that are under way');
  for (let round = 0; round < 3; ++round) for (let s = 6; s < 59; ++s) looks(s);
  for (const index of file.chunksOf('/pins')) void details.peekPart('/pins', index);
  looks(59);
  const needed = details.wait('/motion', 10.2, 10.6);
  await turn();
  for (let round = 0; round < 200 && details.waiting; ++round) {
    answer();
    await turn();
  }
  assert.equal(details.waiting, false);
  assert.ok(looks(59).complete, 'the last that was looked at');
  assert.equal((await needed).length, 1, 'what somebody waits for is not given up');
  assert.ok(file.work.chunks < 100, `${file.work.chunks} of 121 chunks were read`);
});

test('a jump reads as little of an hour as of a minute', async () => {
  /** Chunks as a run writes them: motion and pins of a second in turn, burnt paths of 20 s, overview and camera. */
  const layout = (seconds) => {
    const column = (s, n) => Array.from({ length: n }, (_, i) => s + i / n);
    const all = [[{ topic: '/machine', time_s: 0, json: { ...machine, belt_mm_s: 10, views: { overall: { min_mm: [0, 0, 0], max_mm: [500, 1, 1] } } } }]];
    for (let s = 0; s < seconds; ++s) {
      const t_s = column(s, 10);
      all.push([{ topic: '/motion', time_s: s, json: { t_s, belt_mm: t_s } }, { topic: '/commanded', time_s: s, json: { t_s, x_mm: t_s, y_mm: t_s } },
        { topic: '/gcode', time_s: s + 0.4, json: { t_s: [s + 0.4], line: [1], unit: [0] } }]);
      all.push([{ topic: '/pins', time_s: s, json: { tick0: 1000 * s, dt: [0, 5], id: [0, 0], level: [1, 0] } }]);
      if (s % 20 === 19) all.push(column(s - 19, 20).map((at) => ({ topic: '/burnt', time_s: at, json: { t_s: [at], x_mm: [0], y_mm: [0], start: [1] } })));
      if (s % 10 === 9) all.push([{ topic: '/overview/100ms', time_s: s - 9, json: { from_s: s - 9, step_s: 0.1, rows: 100, pins: [], columns: {}, lit_s: [] } }]);
    }
    for (let s = 0; s < seconds; ++s)
      all.push([{ topic: '/spot', time_s: s, json: { t_s: column(s, 10), x_px: column(s, 10), y_px: column(s, 10), unit: column(s, 10) } }]);
    for (let s = 0; s < seconds; ++s)
      all.push([{ topic: '/frames', time_s: s, json: { timestamp: { sec: s, nsec: 0 }, sequence: s, start_s: s, exposure_s: 1e-4, windows: [] } }]);
    return madeTrace(all);
  };
  for (const seconds of [60, 3600]) {
    const hour = layout(seconds);
    const next = numbers(46);
    for (let round = 0; round < 5; ++round) {
      const trace = await open(hour);
      const before = { ...trace.file.work };
      await lookAt(trace, 0.9 * seconds * next());
      const [requests, chunks, read] = ['requests', 'chunks', 'bytes'].map((name) => trace.file.work[name] - before[name]);
      assert.ok(chunks > 4 && chunks <= 18, `${chunks} chunks of ${seconds} s`);
      assert.ok(requests <= 8, `${requests} requests of ${seconds} s`);
      assert.ok(read < 400_000, `${read} bytes of ${seconds} s`);
    }
  }
});

test('cut off behind its first chunk a trace still shows its machine', async () => {
  const { chunks: [first] } = await TraceFile.open(new BytesReadable(bytes));
  const trace = await open(bytes.subarray(0, first.offset + first.length));
  assert.deepEqual(trace.machine, machine);
  assert.equal(trace.file.complete, false);
  assert.equal(trace.motionAt(0), undefined);
  assert.deepEqual(trace.extent_s, { from: 0, to: 0 });
});

test('memory stays within its bound, and what was forgotten comes again', async () => {
  const file = await TraceFile.open(new BytesReadable(bytes));
  const limit = 100_000;
  const details = new Details(file, limit);
  const next = numbers(43);
  for (let round = 0; round < 80; ++round) {
    const t_s = (kSeconds - 0.1) * next();
    const tables = await details.wait('/motion', t_s - 0.02, t_s);
    assert.ok(tables.some((table) => table.t_s.some((row_s) => Math.abs(row_s - t_s) <= 0.005)));
    assert.ok(details.bytes <= limit, `${details.bytes} bytes`);
  }
});

test('all ways to the bytes give the same bytes', async () => {
  const blob = new BlobReadable(new Blob([bytes]));
  const cached = new BlockCache(new BytesReadable(bytes));
  const once = { read: (offset, length) => cached.readOnce(offset, length) };
  const next = numbers(44);
  for (let round = 0; round < 100; ++round) {
    const offset = Math.floor(bytes.length * next());
    const length = Math.floor((bytes.length - offset) * next() ** 3);
    const wanted = Buffer.from(bytes.subarray(offset, offset + length));
    for (const way of [once, blob, cached, once]) assert.ok(wanted.equals(await way.read(BigInt(offset), BigInt(length))));
  }
  await assert.rejects(cached.read(BigInt(bytes.length - 1), 2n), RangeError);
});

let server;
let asked = [];
before(() => new Promise((resolve) => {
  server = createServer((request, answer) => {
    if (request.url === '/refused') {
      answer.writeHead(404, { 'Content-Type': 'application/json' });
      answer.end(JSON.stringify({ error: 'There is no such trace.' }));
      return;
    }
    const [, from, to] = /bytes=(\d+)-(\d+)/.exec(request.headers.range).map(Number);
    const end = Math.min(to, bytes.length - 1);
    asked.push(end - from + 1);
    answer.writeHead(206, { 'Content-Range': `bytes ${from}-${end}/${bytes.length}` });
    answer.end(bytes.subarray(from, end + 1));
  }).listen(0, '127.0.0.1', resolve);
}));
after(() => server.close());
const address = (path) => `http://127.0.0.1:${server.address().port}${path}`;

test('over HTTP it opens by Range requests alone, few and small', async () => {
  asked = [];
  const trace = await Trace.open(new HttpReadable(address('/trace')));
  assert.equal(trace.checks.length, 1);
  await trace.details.wait('/motion', 3, 3.1);
  assert.ok(Math.abs(trace.motionAt(3.05).belt_mm - 183) < 1e-9);
  assert.ok(asked.length < 20, `${asked.length} requests`);
  await assert.rejects(Trace.open(new HttpReadable(address('/refused'))), /no such trace/);
});

test('a stream in pieces of any size gives the rows as they come, and forgets old ones', () => {
  const next = numbers(45);
  const live = new LiveTrace();
  let rows = 0;
  let newest = -1;
  for (let at = 0; at < bytes.length; ) {
    const size = 1 + Math.floor(3000 * next());
    live.append(bytes.subarray(at, at + size));
    at += size;
    if (!Number.isNaN(live.newest_s)) assert.ok(live.newest_s >= newest);
    newest = Math.max(newest, live.newest_s || 0);
    rows = Math.max(rows, live.motion.reduce((sum, table) => sum + table.t_s.length, 0));
  }
  assert.deepEqual(live.machine, machine);
  assert.ok(Math.abs(live.newest_s - kSeconds) < 1e-9);
  assert.equal(rows, 200 * kSeconds);
  assert.equal(live.ended, true);
});
