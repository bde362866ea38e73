// SPDX-License-Identifier: Apache-2.0
// The page on which a job is made and started.
import { getJson } from '../shared/api.js';

const session = await getJson('/api/session');
document.title = `Kerfbench ${session.version}`;
