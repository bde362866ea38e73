// SPDX-License-Identifier: Apache-2.0
// The page on which a job is made and started.
// @ts-check
import { jobOfHash } from '../shared/job_address.js';
import { createStore } from '../shared/store.js';
import { createActions } from './actions.js';
import { mountPage } from './page.js';
import { initialState } from './state.js';

/** @param {Element} element */
export function showJob(element) {
  const store = createStore(initialState());
  const actions = createActions(store);
  mountPage(element, store, actions);
  actions.begin(jobOfHash(location.hash));
}
