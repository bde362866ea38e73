// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Unpacks chunks beside the page, so that the page goes on moving meanwhile. See unpacker.js.

import { unpackedChunk } from './records.js';

addEventListener('message', ({ data: { id, content } }) => {
  try {
    const records = unpackedChunk(content);
    // @ts-ignore The worker's own postMessage, which takes what is handed over.
    postMessage({ id, records }, [records.buffer]);
  } catch (fault) {
    postMessage({ id, fault: /** @type {Error} */ (fault).message });
  }
});
