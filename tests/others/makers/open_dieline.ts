// SPDX-License-Identifier: Apache-2.0
// Has open-dieline (github.com/BrownBear127/open-dieline) write a reverse tuck end of 28 x 20 x 48 mm as DXF.
import { resolveParams } from './src/core/registry';
import { reverseTuckEnd } from './src/boxes/reverse-tuck-end';
import { toDxfDocument } from './src/export/dxf';

console.log(toDxfDocument(reverseTuckEnd.generate(resolveParams(reverseTuckEnd, { L: 28, W: 20, D: 48 }))));
