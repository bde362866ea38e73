// SPDX-License-Identifier: Apache-2.0
// What the viewer reads and unpacks of a trace to open it and to show another moment of it, counted under Node, without a browser:
//   node window/test/measure_trace.mjs TRACE
// Counts do not depend on what else the computer does; the processor time is that of this process. Nothing is asserted.
import { openSync, readSync, statSync } from 'node:fs';
import { resolve } from 'node:path';
import { Trace } from '../src/trace/trace.js';
import { lookAt } from './looks.mjs';
import { numbers } from './random.mjs';

const [path] = process.argv.slice(2);
if (!path) throw new Error('usage: node measure_trace.mjs TRACE');
const file = openSync(path, 'r');
const size = statSync(path).size;
const asked = { requests: 0, bytes: 0 };
const readable = {
  size: async () => BigInt(size),
  async read(offset, length) {
    asked.requests += 1;
    asked.bytes += Number(length);
    const bytes = new Uint8Array(Number(length));
    readSync(file, bytes, 0, bytes.length, Number(offset));
    return bytes;
  },
};
const cpu_ms = () => process.cpuUsage().user / 1000;
const middle = (values, share = 0.5) => [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];

const before_ms = cpu_ms();
const trace = await Trace.open(readable);
console.log(`${resolve(path)}: ${(size / 1e6).toFixed(1)} MB, ${trace.extent_s.to.toFixed(1)} s, ${trace.file.chunks.length} chunks`);
console.log(`opened: ${asked.requests} reads, ${(asked.bytes / 1e6).toFixed(2)} MB, ${(cpu_ms() - before_ms).toFixed(0)} ms of the processor`);
for (const span_s of [0.1, 10]) {
  const next = numbers(7);
  const each = { requests: [], kB: [], chunks: [], ms: [] };
  for (let i = 0; i < 40; ++i) {
    // Nothing of an earlier jump is in memory.
    const fresh = await Trace.open(readable);
    const from = { ...asked, chunks: fresh.file.work.chunks, ms: cpu_ms() };
    await lookAt(fresh, next() * fresh.extent_s.to, span_s);
    each.requests.push(asked.requests - from.requests);
    each.kB.push((asked.bytes - from.bytes) / 1e3);
    each.chunks.push(fresh.file.work.chunks - from.chunks);
    each.ms.push(cpu_ms() - from.ms);
  }
  const words = Object.entries(each).map(([name, values]) => `${middle(values).toFixed(0)} ${name} (most ${middle(values, 1).toFixed(0)})`);
  console.log(`a moment anywhere, span of ${span_s} s: ${words.join(', ')}; ms are of the processor, with unpacking`);
}
