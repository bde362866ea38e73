// SPDX-License-Identifier: Apache-2.0
// The trace viewer in Chromium, on the trace of a real run: all views show one moment, and it is the moment that the trace has.
// What they ought to show is read from the file by @mcap/core alone, without the viewer's own data layer.
//   KERFBENCH=build/release/bin/kerfbench KERFBENCH_SHOTS=FOLDER node --test window/test/view.browser.mjs
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { McapStreamReader } from '@mcap/core';
import { decompress } from 'fzstd';
import { launch } from './browser.mjs';
import { serve } from './server.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = process.env.KERFBENCH ?? join(root, 'build/release/bin/kerfbench');
const shots = process.env.KERFBENCH_SHOTS ?? join(root, 'build/window-shots/view');
const clipPage = join(dirname(program), '../window/clip.html');
const kAlt = 1;
const kShift = 8;

let server;
let browser;
let page;
/** Messages of the trace by topic. @type {Map<string, {time_s: number, json: any}[]>} */
const said = new Map();
const topic = (name) => said.get(name) ?? [];
const shot = (name) => page.screenshot(join(shots, `${name}.png`));

function readAll(bytes) {
  const reader = new McapStreamReader({ decompressHandlers: { zstd: (packed, size) => decompress(packed, new Uint8Array(Number(size))) } });
  reader.append(bytes);
  const topics = new Map();
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) {
    if (record.type === 'Channel') topics.set(record.id, record.topic);
    if (record.type !== 'Message') continue;
    const name = topics.get(record.channelId);
    if (!said.has(name)) said.set(name, []);
    said.get(name).push({ time_s: Number(record.logTime) / 1e9, json: JSON.parse(new TextDecoder().decode(record.data)) });
  }
  assert.ok(reader.done(), 'the file has its end');
}

before(async () => {
  server = await serve(program);
  const made = spawnSync(program, ['run', join(root, 'fixtures/scenarios/native/label-on-belt.yaml'), '--output', join(server.folder, 'label'), '--trace'], { encoding: 'utf8' });
  assert.equal(made.status, 0, made.stdout + made.stderr);
  readAll(readFileSync(join(server.folder, 'label/run.mcap')));
  browser = await launch();
  page = await browser.newPage();
  await page.open(server.url);
});
after(async () => {
  await browser?.close();
  await server?.close();
});

const open = async (query) => {
  await page.open(new URL('about:blank'));
  await page.open(new URL(query, server.url).href);
};
const trace = (t_s, file = 'label/run.mcap') => open(`/view?trace=${encodeURIComponent(file)}#t=${t_s}`);
/** What all views show, once they have come to rest at a time. */
const views = (t_s) => page.until(`(t) => {
  const v = document.querySelector('.viewer')?.viewer;
  if (!v || Math.abs(v.timeline.get().t_s - t) > 1e-7 || v.machine.view.shown_s !== v.timeline.get().t_s) return null;
  const motion = v.trace.motionAt(v.timeline.get().t_s);
  const levels = document.querySelector('[aria-label="Levels at the cursor"]').textContent;
  if (!motion || !levels || v.trace.details.waiting || v.machine.view.motion.mirror_x_rad !== motion.mirror_x_rad) return null;
  return {
    t_s: v.timeline.get().t_s, levels,
    mirrors: ['x mirror', 'y mirror'].map((name) => v.machine.view.planeOf(name)),
    frame: document.querySelector('[aria-label="Frame and measured spot"]').textContent,
    time: document.querySelector('.tv-time').value,
  };
}`, t_s);
const now = () => page.run("() => document.querySelector('.viewer').viewer.timeline.get()");

/** The row of the motion at the end of whose interval a time is: times of the test are on rows. */
function motionAt(t_s) {
  for (const { json } of topic('/motion')) {
    const i = json.t_s.findIndex((t) => Math.abs(t - t_s) < 1e-9);
    if (i >= 0) return Object.fromEntries(Object.entries(json).map(([name, column]) => [name, column[i]]));
  }
  throw new Error(`no row at ${t_s}`);
}

/** Level of each pin after all edges up to a time. */
function levelsAt(t_s) {
  const { tick_hz, signals } = topic('/machine')[0].json;
  const level = new Map(signals.map(({ id }) => [id, 0]));
  for (const { json } of topic('/pins')) {
    let tick = json.tick0;
    json.dt.forEach((dt, i) => {
      tick += dt;
      if (tick <= t_s * tick_hz + 1e-6) level.set(json.id[i], json.level[i]);
    });
  }
  return new Map(signals.map(({ id, name }) => [name, level.get(id) ? 'high' : 'low']));
}

const lastUpTo = (messages, t_s, timeOf) => messages.filter((message) => timeOf(message) <= t_s + 1e-9).pop();

/** The spot that mirrors, standing as they are shown, make of the beam. */
function spotBy(mirrors) {
  const { beam } = topic('/machine')[0].json;
  let [point, direction] = [beam.from[0].at_mm, beam.from[0].direction];
  const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
  for (const { at, normal } of mirrors) {
    const s = dot(at.map((x, i) => x - point[i]), normal) / dot(direction, normal);
    point = point.map((x, i) => x + s * direction[i]);
    direction = direction.map((x, i) => x - 2 * dot(direction, normal) * normal[i]);
  }
  return point.map((x, i) => x - (point[2] / direction[2]) * direction[i]);
}

for (const t_s of [3.5, 4.9125, 7.2]) {
  test(`at ${t_s} s mirrors, pins, frame, words and line are those of the trace`, async () => {
    await trace(t_s);
    const seen = await views(t_s);
    const row = motionAt(t_s);
    const [x, y] = spotBy(seen.mirrors);
    assert.ok(Math.hypot(x - row.spot_x_mm, y - row.spot_y_mm) < 2e-3, `mirrors as shown lead the beam to ${x}, ${y}, and the trace has ${row.spot_x_mm}, ${row.spot_y_mm}`);
    const levels = levelsAt(t_s);
    for (const words of seen.levels.split(', ')) {
      const [name, level] = words.split(' ');
      assert.equal(level, levels.get(name), name);
    }
    const frame = lastUpTo(topic('/frames'), t_s, ({ json }) => json.start_s);
    assert.ok(seen.frame.startsWith(`frame ${frame.json.sequence},`), seen.frame);
    await page.click('[role=tab]', 'Words');
    const spoken = await page.until("() => document.querySelector('.tv-word[aria-current]')?.textContent");
    const word = lastUpTo(topic('/uart'), t_s, ({ json: { timestamp } }) => timestamp.sec + 1e-9 * timestamp.nsec);
    assert.ok(spoken.includes(word.json.message) && spoken.replaceAll(' ', '').endsWith(word.json.hex), `${spoken}, not ${word.json.hex}`);
    const lines = topic('/gcode').flatMap(({ json }) => json.t_s.map((t, i) => ({ t, line: json.line[i] })));
    const { line } = lastUpTo(lines, t_s, ({ t }) => t);
    await page.click('[role=tab]', 'Program');
    await page.until("(line) => Number(document.querySelector('.tv-code[aria-current] .tv-line-number')?.textContent ?? 0) === line", line);
    await shot(`at-${t_s}`);
  });
}

test('the cursor moves by keys: period, ten, pulse, frame, line, check, ends', async () => {
  await trace(3.5);
  await views(3.5);
  const { period_s, drives, tick_hz } = topic('/machine')[0].json;
  let t_s = 3.5;
  /** Presses a key and waits until all is where it ought to lead. */
  const to = async (wanted_s, key, modifiers = 0) => {
    await page.key(key, modifiers);
    await views(wanted_s);
    t_s = wanted_s;
  };
  const next = (times) => Math.min(...times.filter((time) => time > t_s + 1e-8));
  await to((Math.round(t_s / period_s) + 1) * period_s, 'ArrowRight');
  await to((Math.round(t_s / period_s) - 10) * period_s, 'ArrowLeft', kShift);
  const pulses = topic('/pins').flatMap(({ json }) => {
    let tick = json.tick0;
    const own = json.dt.map((dt, i) => ({ t: (tick += dt) / tick_hz, up: json.level[i] === 1, id: json.id[i] }));
    return own.filter(({ up, id }) => up && drives.some(({ pul }) => pul === id)).map(({ t }) => t);
  });
  await to(next(pulses), 'ArrowRight', kAlt);
  await to(next(topic('/spot').flatMap(({ json }) => json.t_s)), '.');
  await to(next(topic('/gcode').flatMap(({ json }) => json.t_s)), 'ArrowDown');
  await to(next(topic('/checks').map(({ json }) => json.time_s ?? 0)), 'PageDown');
  await page.key('Home');
  assert.equal((await views(0)).time.replaceAll('\u2009', ''), '0.0000000 s');
  await page.key('End');
  await page.until("() => { const { t_s, extent } = document.querySelector('.viewer').viewer.timeline.get(); return t_s === extent.to; }");
});

test('it plays at the speed that is chosen, and stops', async () => {
  await trace(3.5);
  await views(3.5);
  await page.key('7');
  assert.equal((await now()).speed, 1);
  await page.key('Space');
  await page.until("() => { const { t_s, playing } = document.querySelector('.viewer').viewer.timeline.get(); return playing && t_s > 3.6; }");
  await page.key('Space');
  const { t_s, playing } = await now();
  assert.equal(playing, false);
  await views(t_s);
  await page.until("(t) => Math.abs(new URLSearchParams(location.hash.slice(1)).get('t') - t) < 1e-6", t_s);
});

test('a jump reads few chunks by few requests, and nothing but them', async () => {
  await trace(0.5);
  await views(0.5);
  const work = () => page.run("() => ({ ...document.querySelector('.viewer').viewer.trace.file.work })");
  const before = await work();
  await page.run("() => document.querySelector('.viewer').viewer.timeline.go(6.5)");
  await views(6.5);
  const after = await work();
  const [requests, chunks, bytes] = ['requests', 'chunks', 'bytes'].map((name) => after[name] - before[name]);
  assert.ok(chunks > 0 && chunks <= 14, `${chunks} chunks`);
  assert.ok(requests <= 8, `${requests} requests`);
  assert.ok(bytes < 2_000_000, `${bytes} bytes`);
});

test('marks measure, zooming goes down to ticks, and pulses are measured against their data sheet', async () => {
  await trace(3.5);
  await views(3.5);
  await page.key('a');
  for (let i = 0; i < 5; ++i) await page.key('ArrowRight');
  const period_s = topic('/machine')[0].json.period_s;
  await views(Math.round(3.5 / period_s + 5) * period_s);
  await page.key('b');
  await page.untilText('.tv-marks', /A–B 4.ms/);
  await page.untilText('.tv-pulses', /galvo_x[^]*set-up [^]*≥ 5.µs[^]*hold [^]*width [^]*≥ 2\.5.µs/);
  await shot('marks');
  for (let i = 0; i < 16; ++i) await page.key('+');
  const { span } = await now();
  assert.ok(span.to - span.from < 3e-6, `${span.to - span.from} s`);
  await shot('ticks');
  await page.key('0');
  const whole = await now();
  assert.deepEqual(whole.span, whole.extent);
  await page.key('x');
  assert.equal((await now()).a_s, null);
});

test('a check leads to its moment, and a line of the program to the one at which it begins', async () => {
  await trace(1);
  await views(1);
  const check = topic('/checks').find(({ json }) => json.time_s !== null).json;
  await page.run('(t) => [...document.querySelectorAll(".tv-jump")].find((b) => b.textContent.replaceAll("\\u2009", "").includes(t)).click()', check.time_s.toFixed(7));
  await views(check.time_s);
  await page.click('[role=tab]', 'Program');
  const begins = topic('/gcode').flatMap(({ json }) => json.t_s.map((t, i) => ({ t, line: json.line[i] })));
  const { t, line } = begins.find((one) => one.line > 0 && one.t > check.time_s);
  await page.click('.tv-code', topic('/machine')[0].json.gcode[line - 1]);
  await views(t);
  await page.click('[role=tab]', 'Words');
  await shot('words');
});

test('panels can be hidden, sized by keys, and are as they were left', async () => {
  await trace(3.5);
  await views(3.5);
  const width = () => page.run("() => document.querySelector('.tv-split-row').firstElementChild.clientWidth");
  const before_px = await width();
  await page.run("() => document.querySelector('.tv-split-row > .tv-bar').focus()");
  await page.key('ArrowLeft');
  await page.until("(w) => document.querySelector('.tv-split-row').firstElementChild.clientWidth < w - 20", before_px);
  const t_s = (await now()).t_s;
  assert.equal(t_s, 3.5, 'the key moved the border, not the cursor');
  await page.click('[aria-label="Hide Plots"]');
  await page.until("() => !document.querySelector('.tv-plots')");
  await trace(3.5);
  await views(3.5);
  assert.equal(await page.run("() => Boolean(document.querySelector('.tv-plots'))"), false);
  await page.click('summary', 'Panels');
  await page.click('.tv-menu-body label', 'Plots');
  await page.until("() => document.querySelector('.tv-plots canvas')");
});

test('it has no sideways scrolling at 1024 pixels, at 200 %, in the dark, and with less motion', async () => {
  for (const [name, look] of [['1024', { width: 1024, height: 700 }], ['200-percent', { width: 720, height: 450, scale: 2 }], ['dark', { dark: true }], ['still', { still: true }]]) {
    await page.look(look);
    await trace(4.9125);
    await views(4.9125);
    const [inner, wide] = await page.run('() => [document.documentElement.clientWidth, document.documentElement.scrollWidth]');
    assert.ok(wide <= inner, `${name}: ${wide} of ${inner}`);
    await shot(name);
  }
  await page.look();
});

test('the trace of a run that was killed is dropped into the page, and opens up to its last whole chunk', async () => {
  const part = join(server.folder, 'killed.mcap.part');
  const run = spawn(program, ['run', join(root, 'fixtures/scenarios/native/label-on-belt.yaml'), '--output', join(server.folder, 'killed'), '--trace'], { stdio: 'ignore' });
  const ended = new Promise((resolve) => run.once('exit', resolve));
  while (run.exitCode === null && !(existsSync(part) && statSync(part).size > 200_000)) await new Promise(setImmediate);
  run.kill('SIGKILL');
  await ended;
  await open('/view');
  await page.untilText('.tv-offer', 'drop a trace here');
  await page.drop('.tv-offer', [part]);
  await page.untilText('.viewer-title', 'cut off');
  const { extent } = await now();
  assert.ok(extent.to > 1 && extent.to < topic('/motion').at(-1).json.t_s.at(-1), `${extent.to} s`);
  await page.key('End');
  await page.until("() => document.querySelector('.viewer').viewer.machine.view.motion?.belt_mm > 50");
  await shot('killed');
  await page.drop('.viewer', [join(root, 'README.md')]);
  await page.untilText('[role=alert]', 'does not begin as an MCAP file');
});

test('the page that stands alone opens from disk and asks for nothing', async () => {
  const whole = readFileSync(join(server.folder, 'label/run.mcap'));
  const file = join(server.folder, 'clip.html');
  writeFileSync(file, readFileSync(clipPage, 'utf8').replace('{{title}}', 'clip &amp; test').replace('{{moment_s}}', '3.5').replace('{{trace_base64}}', whole.toString('base64')));
  page.requests.length = 0;
  await page.open(pathToFileURL(file).href);
  await views(3.5);
  await page.until("() => document.querySelector('[aria-label=\"Frame and measured spot\"]').textContent.startsWith('frame')");
  await shot('stands-alone');
  assert.deepEqual(page.requests.filter((url) => !/^(blob|data):/.test(url)), [pathToFileURL(file).href]);
});

/** Asks the server for something as the page does. */
const ask = (path, body) => page.run(`async (path, body) => {
  const answer = await fetch(path, { method: 'POST', headers: { 'Content-Type': 'application/json', 'X-Kerfbench': '1' }, body: JSON.stringify(body) });
  if (!answer.ok) throw new Error(await answer.text());
  return answer.json();
}`, path, body);

test('a run is seen while it goes on, and then its trace', async () => {
  await open('/view');
  // An emulated release takes long enough to be seen on any computer.
  const { id } = await ask('/api/runs', { scenario: 'shipped/scenarios/carton-on-belt.yaml', trace: true });
  await open(`/view?run=${encodeURIComponent(id)}`);
  await page.untilText('.tv-live-words', /\d s · .*real time/);
  await shot('live');
  await page.until("() => { const t = document.querySelector('.viewer')?.viewer?.trace; return t?.checks.length > 0 && !t.details.waiting; }");
});

test('no view has said an error', () => {
  assert.deepEqual(page.errors, []);
});
