// SPDX-License-Identifier: Apache-2.0
// The station's page in Chromium: a serial number is scanned, the run that it starts is followed to its verdict, and another bench
// is shown beside it.
//   KERFBENCH=build/release/bin/kerfbench KERFBENCH_SHOTS=FOLDER node --test window/test/station.browser.mjs
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { launch } from './browser.mjs';
import { serve } from './server.mjs';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = process.env.KERFBENCH ?? join(root, 'build/release/bin/kerfbench');
const shots = process.env.KERFBENCH_SHOTS ?? join(root, 'build/window-shots');
const scenario = 'shipped/scenarios/short-lines.yaml';

let other;
let server;
let browser;
let page;

before(async () => {
  mkdirSync(shots, { recursive: true });
  other = await serve(program);
  server = await serve(program, ['--bench', other.url]);
  browser = await launch();
  page = await browser.newPage();
});
after(async () => {
  await browser?.close();
  await server?.close();
  await other?.close();
});

test('a station says what to do, and shows the other bench', async () => {
  await page.open(server.url);
  await page.open(new URL('/station', server.url).href);
  await page.untilText('.station-step', 'Enter or scan the serial number');
  await page.untilText('.station-bench', new URL('/', other.url).href);
  assert.equal(await page.run("() => document.activeElement?.id"), 'station-serial', 'a scanner types into the field');
});

test('a scanned number starts a run, and the verdict says what becomes of the part', async () => {
  await page.choose('#station-scenario', scenario);
  await page.click('#station-serial');
  await page.key('Enter');
  await page.untilText('#station-ask', 'Enter or scan the serial number first');
  assert.equal(await page.run("async () => (await (await fetch('/api/runs')).json()).runs.length"), 0, 'nothing was started');
  await page.type('<K>-0007');
  await page.key('Enter');
  await page.untilText('.station-current h2', '<K>-0007');
  await page.untilText('#station-queue', 'waits in a queue');
  await page.screenshot(join(shots, 'station-running.png'));
  await page.untilText('.station-tested', 'PASS');
  await page.untilText('.station-step.pass', 'PASS: number <K>-0007 may go on');
  await page.untilText('.station-tested .when', /^\d\d:\d\d$/);
  assert.equal(await page.run("() => document.querySelector('#station-serial').value"), '', 'ready for the next one');
  await page.screenshot(join(shots, 'station-passed.png'));
  const report = await page.run("() => document.querySelector('.station-tested a').getAttribute('href')");
  const folder = join(server.folder, ...report.split('/').filter(Boolean).slice(0, -1));
  assert.equal(JSON.parse(readFileSync(join(folder, 'verdict.json'), 'utf8')).serial_number, '<K>-0007');
});

test('a bench that has ended is named with the reason', async () => {
  await other.close();
  other = undefined;
  await page.untilText('.station-bench.away', 'It does not answer.');
});
