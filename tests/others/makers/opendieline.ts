// SPDX-License-Identifier: Apache-2.0
// Has OpenDieline (github.com/GIGAJOHUB/OpenDieline) write a reverse tuck end of 40 x 20 x 50 mm as DXF.
import { generateReverseTuckEndDieline } from './src/templates/reverseTuckEnd';
import { exportDielineToDxf } from './src/exporters/dxfExporter';
import { MIN_RTE_PARAMS } from './src/constants/packaging';

const carton = {
  ...MIN_RTE_PARAMS, panelAWidth: 20, panelBWidth: 40, height: 50, boardThickness: 0.4, glueFlapWidth: 10, tuckFlapDepth: 12,
  dustFlapDepth: 12, lockTongueDepth: 6,
};
console.log(exportDielineToDxf(generateReverseTuckEndDieline(carton)));
