// SPDX-License-Identifier: Apache-2.0
// The page that shows a trace, of a run that has ended or goes on.
import { getJson } from '../shared/api.js';

const session = await getJson('/api/session');
document.title = `Kerfbench ${session.version}: trace`;
