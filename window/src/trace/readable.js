// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Where the bytes of a trace come from: memory, a local file, or a server that answers Range requests. Each is an
// IReadable of @mcap/core: size() and read(offset, length), both in bytes as BigInt.

/** @typedef {{size(): Promise<bigint>, read(offset: bigint, length: bigint): Promise<Uint8Array>}} Readable */

const kBlock_bytes = 512 * 1024;
const kBlocks = 128; // 64 MiB of a file are kept at most.

/** @param {number} offset @param {number} length @param {number} size */
function refuseOutside(offset, length, size) {
  if (offset + length > size) throw new RangeError(`the trace ends at byte ${size}, before byte ${offset + length}`);
}

/** Bytes that are all in memory already: the clip of a stand-alone page. */
export class BytesReadable {
  /** @param {Uint8Array} bytes */
  constructor(bytes) {
    this.bytes = bytes;
  }
  async size() {
    return BigInt(this.bytes.byteLength);
  }
  /** @param {bigint} offset @param {bigint} length */
  async read(offset, length) {
    const from = Number(offset);
    refuseOutside(from, Number(length), this.bytes.byteLength);
    return this.bytes.subarray(from, from + Number(length));
  }
}

/** A file that was dropped into the page or chosen. */
export class BlobReadable {
  /** @param {Blob} blob */
  constructor(blob) {
    this.blob = blob;
  }
  async size() {
    return BigInt(this.blob.size);
  }
  /** @param {bigint} offset @param {bigint} length */
  async read(offset, length) {
    const from = Number(offset);
    refuseOutside(from, Number(length), this.blob.size);
    return new Uint8Array(await this.blob.slice(from, from + Number(length)).arrayBuffer());
  }
}

/** A file of the server, by Range requests. */
export class HttpReadable {
  #size = -1;

  /** @param {string} url */
  constructor(url) {
    this.url = url;
  }

  async size() {
    if (this.#size < 0) await this.#fetch(0, 1);
    return BigInt(this.#size);
  }

  /** @param {bigint} offset @param {bigint} length */
  async read(offset, length) {
    if (length === 0n) return new Uint8Array(0);
    return this.#fetch(Number(offset), Number(length));
  }

  /** @param {number} offset @param {number} length */
  async #fetch(offset, length) {
    const answer = await fetch(this.url, { headers: { Range: `bytes=${offset}-${offset + length - 1}` } });
    if (answer.status !== 206) throw new Error(await refusal(answer));
    const total = /\/(\d+)$/.exec(answer.headers.get('Content-Range') ?? '');
    if (!total) throw new Error('the server does not say how long the trace is');
    this.#size = Number(total[1]);
    const bytes = new Uint8Array(await answer.arrayBuffer());
    if (bytes.byteLength !== length) throw new RangeError(`the trace ends at byte ${this.#size}`);
    return bytes;
  }
}

/** @param {Response} answer */
async function refusal(answer) {
  try {
    const { error } = await answer.json();
    if (error) return error;
  } catch {
    // The answer is no JSON; its status says enough.
  }
  return `the server answered ${answer.status} where a part of the trace was asked for`;
}

/** Keeps blocks that were read, the latest ones: who walks over a file or reads its summary asks for little pieces one after the other. */
export class BlockCache {
  /** @type {Map<number, Promise<Uint8Array>>} */
  #blocks = new Map();
  /** @type {Promise<bigint> | undefined} */
  #size;

  /** @param {Readable} below */
  constructor(below) {
    this.below = below;
  }

  size() {
    return (this.#size ??= this.below.size());
  }

  /** @param {bigint} offset @param {bigint} length */
  async read(offset, length) {
    const size = Number(await this.size());
    const from = Number(offset);
    const n = Number(length);
    refuseOutside(from, n, size);
    if (n > 4 * kBlock_bytes) return this.below.read(offset, length);
    const first = Math.floor(from / kBlock_bytes);
    const last = Math.floor(Math.max(from, from + n - 1) / kBlock_bytes);
    const wanted = [];
    for (let block = first; block <= last; ++block) wanted.push(this.#block(block, size));
    const blocks = await Promise.all(wanted);
    const start = from - first * kBlock_bytes;
    if (blocks.length === 1) return blocks[0].subarray(start, start + n);
    const joined = new Uint8Array(n);
    let at = 0;
    blocks.forEach((block, i) => {
      const part = block.subarray(i === 0 ? start : 0).subarray(0, n - at);
      joined.set(part, at);
      at += part.byteLength;
    });
    return joined;
  }

  /**
   * Exactly these bytes, and nothing of them is kept: for what is read once, such as chunks.
   * @param {bigint} offset @param {bigint} length
   */
  async readOnce(offset, length) {
    const size = Number(await this.size());
    refuseOutside(Number(offset), Number(length), size);
    const first = Math.floor(Number(offset) / kBlock_bytes);
    const last = Math.floor((Number(offset) + Math.max(0, Number(length) - 1)) / kBlock_bytes);
    for (let block = first; block <= last; ++block) if (!this.#blocks.has(block)) return this.below.read(offset, length);
    return this.read(offset, length);
  }

  /** @param {number} index @param {number} size */
  #block(index, size) {
    let block = this.#blocks.get(index);
    if (block) this.#blocks.delete(index);
    else {
      const offset = index * kBlock_bytes;
      block = this.below.read(BigInt(offset), BigInt(Math.min(kBlock_bytes, size - offset)));
      block.catch(() => this.#blocks.delete(index)); // A request that failed may be tried again.
    }
    this.#blocks.set(index, block);
    if (this.#blocks.size > kBlocks) this.#blocks.delete(this.#blocks.keys().next().value ?? -1);
    return block;
  }
}
