// SPDX-License-Identifier: Apache-2.0
// Reads a trace by @mcap/core, with its sums checked, by its index and as a stream that comes in pieces:
//   node read_by_mcap_core.mjs NODE_MODULES FILE [part]
// Prints {indexed: {topic: messages}, streamed: {topic: messages}, attachments: [names], metadata: [names]} as JSON; of a part, which has
// no index, streamed alone. Ends with 77 where the packages are not there.
import { existsSync } from 'node:fs';
import { open } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, file, part] = process.argv.slice(2);
const core = path.join(modules, '@mcap/core/dist/esm/index.js');
if (!existsSync(core)) {
  console.log(`${core} is not there`);
  process.exit(77);
}
const { McapIndexedReader, McapStreamReader } = await import(pathToFileURL(core).href);
const { decompress } = await import(pathToFileURL(path.join(modules, 'fzstd/esm/index.mjs')).href);
const decompressHandlers = {
  zstd: (/** @type {Uint8Array} */ bytes, /** @type {bigint} */ size) => decompress(bytes, new Uint8Array(Number(size))),
};
const handle = await open(file);
const size = (await handle.stat()).size;
const read = async (/** @type {bigint} */ offset, /** @type {bigint} */ length) => {
  const bytes = new Uint8Array(Number(length));
  await handle.read(bytes, 0, bytes.length, Number(offset));
  return bytes;
};
const text = new TextDecoder('utf-8', { fatal: true });
/** @param {Record<string, number>} counts */
const count = (counts, /** @type {string} */ topic, /** @type {Uint8Array} */ data) => {
  JSON.parse(text.decode(data));
  counts[topic] = (counts[topic] ?? 0) + 1;
};

/** @type {any} */
const result = { streamed: {} };
if (!part) {
  const reader = await McapIndexedReader.Initialize({
    readable: { size: async () => BigInt(size), read },
    decompressHandlers,
  });
  Object.assign(result, { indexed: {}, attachments: [], metadata: [] });
  let last = -1n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    if (message.logTime < last) throw new Error('messages go back in time');
    last = message.logTime;
    count(result.indexed, reader.channelsById.get(message.channelId).topic, message.data);
  }
  for await (const attachment of reader.readAttachments()) result.attachments.push(attachment.name);
  for await (const metadata of reader.readMetadata()) result.metadata.push(metadata.name);
  const told = Object.values(result.indexed).reduce((sum, n) => sum + n, 0);
  if (BigInt(told) !== reader.statistics.messageCount) throw new Error('the statistics count other messages');
}

const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
const topics = new Map();
for (let at = 0; at < size; at += 10_007) {
  stream.append(await read(BigInt(at), BigInt(Math.min(10_007, size - at))));
  for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
    if (record.type === 'Channel') topics.set(record.id, record.topic);
    if (record.type === 'Message') count(result.streamed, topics.get(record.channelId), record.data);
  }
}
if (!part && !stream.done()) throw new Error('the stream has no end');
console.log(JSON.stringify(result));
