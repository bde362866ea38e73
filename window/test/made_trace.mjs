// SPDX-License-Identifier: Apache-2.0
// Writes small traces for tests: chunks of JSON messages, with message indexes and a summary, as docs/reference/trace.md has
// them. The chunks are not packed; those of real traces are.
import { McapChunkBuilder, McapRecordBuilder } from '@mcap/core';

const ns = (seconds) => BigInt(Math.round(seconds * 1e9));

/**
 * @param {{topic: string, time_s: number, json: unknown}[][]} chunks messages of each chunk
 * @param {{end?: boolean, channelsFirst?: boolean}} [options] end: false leaves out everything behind the last chunk, as a run that was
 *   killed does; channelsFirst: channels are declared before the first chunk, not within
 * @returns {Uint8Array}
 */
export function madeTrace(chunks, { end = true, channelsFirst = false } = {}) {
  const file = new McapRecordBuilder();
  const parts = [];
  let at = 0n;
  const take = () => {
    const bytes = Uint8Array.from(file.buffer);
    file.reset();
    parts.push(bytes);
    at += BigInt(bytes.byteLength);
  };
  const ids = new Map();
  const channels = [];
  file.writeMagic();
  file.writeHeader({ profile: 'kerfbench', library: 'test' });
  take();
  const declare = (topic) => {
    const channel = { id: ids.size + 1, schemaId: 0, topic, messageEncoding: 'json', metadata: new Map() };
    ids.set(topic, channel.id);
    channels.push(channel);
    return channel;
  };
  if (channelsFirst) {
    for (const topic of new Set(chunks.flat().map((message) => message.topic))) file.writeChannel(declare(topic));
    take();
  }
  const indexes = chunks.map((messages) => {
    const chunk = new McapChunkBuilder({ useMessageIndex: true });
    for (const { topic, time_s, json } of messages) {
      if (!ids.has(topic)) chunk.addChannel(declare(topic));
      const data = new TextEncoder().encode(JSON.stringify(json));
      chunk.addMessage({ channelId: ids.get(topic), sequence: 0, logTime: ns(time_s), publishTime: ns(time_s), data });
    }
    return writeChunk(file, chunk, () => at, take);
  });
  if (end) writeEnd(file, channels, indexes, () => at, take);
  return Buffer.concat(parts);
}

function writeChunk(file, chunk, place, take) {
  const { messageStartTime, messageEndTime } = chunk;
  const size = BigInt(chunk.buffer.byteLength);
  const chunkStartOffset = place();
  file.writeChunk({ messageStartTime, messageEndTime, uncompressedSize: size, uncompressedCrc: 0, compression: '', records: chunk.buffer });
  take();
  const chunkLength = place() - chunkStartOffset;
  const messageIndexOffsets = new Map();
  const indexStart = place();
  for (const index of chunk.indices) {
    if (!index.records.length) continue;
    messageIndexOffsets.set(index.channelId, place());
    file.writeMessageIndex(index);
    take();
  }
  return {
    messageStartTime, messageEndTime, chunkStartOffset, chunkLength, messageIndexOffsets, messageIndexLength: place() - indexStart,
    compression: '', compressedSize: size, uncompressedSize: size,
  };
}

function writeEnd(file, channels, indexes, place, take) {
  file.writeDataEnd({ dataSectionCrc: 0 });
  take();
  const summaryStart = place();
  for (const channel of channels) file.writeChannel(channel);
  for (const index of indexes) file.writeChunkIndex(index);
  take();
  file.writeFooter({ summaryStart, summaryOffsetStart: 0n, summaryCrc: 0 });
  file.writeMagic();
  take();
}
