// SPDX-License-Identifier: Apache-2.0
// How long the viewer takes to open a trace, and to show another moment of it, in Chromium with software GL:
//   node window/test/measure_viewer.mjs TRACE [PAGES]
// PAGES: the bundle, build/release/window unless told. The times are those of the page itself. Nothing is asserted.
import { createReadStream, existsSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch } from './browser.mjs';
import { numbers } from './random.mjs';

const [trace, pages = fileURLToPath(new URL('../../build/release/window', import.meta.url))] = process.argv.slice(2);
if (!trace) throw new Error('usage: node measure_viewer.mjs TRACE [PAGES]');
const size = statSync(trace).size;
const kTypes = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css' };
let asked = { requests: 0, bytes: 0 };

const server = createServer((request, answer) => {
  const { pathname } = new URL(request.url, 'http://local');
  if (pathname === '/api/trace') {
    const [, from, to] = /bytes=(\d+)-(\d+)/.exec(request.headers.range).map(Number);
    const end = Math.min(to, size - 1);
    asked = { requests: asked.requests + 1, bytes: asked.bytes + end - from + 1 };
    answer.writeHead(206, { 'Content-Range': `bytes ${from}-${end}/${size}`, 'Content-Length': end - from + 1 });
    createReadStream(trace, { start: from, end }).pipe(answer);
    return;
  }
  const file = join(pages, pathname === '/view' ? 'index.html' : pathname.replace(/^\/window/, ''));
  if (!existsSync(file)) return void answer.writeHead(404).end();
  answer.writeHead(200, { 'Content-Type': kTypes[extname(file)] ?? 'application/octet-stream' });
  createReadStream(file).pipe(answer);
});
await new Promise((done) => server.listen(0, '127.0.0.1', done));

const browser = await launch();
const page = await browser.newPage();
await page.send('Performance.enable', { timeDomain: 'threadTicks' });
/** CPU time of the page's main thread so far, ms: other programs do not count. */
const cpu_ms = async () => 1000 * (await page.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'TaskDuration').value;
const ready = "() => { const v = document.querySelector('.viewer')?.viewer; return v && v.machine.view.motion && !v.trace.details.waiting; }";
await page.open(`http://127.0.0.1:${server.address().port}/view?trace=x`);
await page.until(ready);
const opened = await page.run(`() => { const at = (name) => performance.getEntriesByName(name)[0].startTime;
  return { script: at('kerfbench-trace-asked'), opened: at('kerfbench-trace-opened') }; }`);
console.log(`${resolve(trace)}: ${(size / 1e6).toFixed(0)} MB`);
console.log(`CPU ${(await cpu_ms()).toFixed(0)} ms until then`);
console.log(`opened ${(opened.opened - opened.script).toFixed(0)} ms after it was asked for, ${opened.opened.toFixed(0)} ms after the page was; ${asked.requests} requests, ${(asked.bytes / 1e6).toFixed(1)} MB`);

/** To random moments, until the machine, pins and all else stand at them. */
async function scrub(times, words) {
  const before_ms = await cpu_ms();
  const before = { ...asked };
  const took = await page.run(`async (times) => {
    const v = document.querySelector('.viewer').viewer;
    const { to } = v.timeline.get().extent;
    const took = [];
    const unpacked = v.trace.file.work?.chunks;
    for (const share of times) {
      const t_s = share * to;
      const from_ms = performance.now();
      v.timeline.go(t_s);
      while (v.trace.details.waiting || !v.trace.motionAt(t_s) || v.machine.view.motion?.belt_mm !== v.trace.motionAt(t_s).belt_mm) await new Promise((r) => setTimeout(r));
      took.push(performance.now() - from_ms);
    }
    return { took: took.sort((a, b) => a - b), bytes: v.trace.details.bytes, chunks: v.trace.file.work?.chunks - unpacked };
  }`, times);
  const share = (p) => took.took[Math.floor(p * (took.took.length - 1))].toFixed(0);
  const each = (sum) => (sum / times.length).toFixed(1);
  console.log(`${words}: ${each(asked.requests - before.requests)} requests, ${each((asked.bytes - before.bytes) / 1e3)} kB, ${each(took.chunks)} chunks each`);
  console.log(`${words}: median ${share(0.5)} ms, 90 % ${share(0.9)} ms, worst ${share(1)} ms, CPU ${(((await cpu_ms()) - before_ms) / times.length).toFixed(0)} ms each; ${(took.bytes / 1e6).toFixed(0)} MB of details in memory`);
}
const next = numbers(7);
await page.run("() => { const v = document.querySelector('.viewer').viewer; v.timeline.update((s) => ({ ...s, span: { from: s.t_s, to: s.t_s + 0.1 } })); }");
await scrub(Array.from({ length: 40 }, next), 'to a moment anywhere, span of 0.1 s');
const near = next() * 0.9;
await scrub(Array.from({ length: 60 }, (_, i) => near + i * 1e-5), 'dragging from moment to moment near by');

const frames = await page.run(`async () => {
  const v = document.querySelector('.viewer').viewer;
  v.timeline.update((s) => ({ ...s, speed: 0.1 }));
  v.timeline.play(true);
  const [from, at_ms] = [v.machine.view.stage.pictures, performance.now()];
  await new Promise((r) => setTimeout(r, 5000));
  v.timeline.play(false);
  const own = [...v.machine.view.stage.frames_ms].sort((a, b) => a - b);
  const { width, height } = v.machine.view.stage.renderer.domElement;
  return { rate: (1000 * (v.machine.view.stage.pictures - from)) / (performance.now() - at_ms), own_ms: own[own.length >> 1], width, height };
}`);
console.log(`playing, software GL: ${frames.rate.toFixed(1)} pictures/s of ${frames.width} x ${frames.height}; ${frames.own_ms.toFixed(1)} ms of the page's own work for each (median)`);
await browser.close();
server.close();
