// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What `/machine` and `/checks` of a trace hold (docs/reference/trace.md), as types.

/**
 * @typedef {import('../machine/kinematics.js').Body} Body
 * @typedef {import('../machine/beam_path.js').Beam} Beam
 * @typedef {[number, number, number]} Triple
 * @typedef {{box: {size_mm: Triple, edge_radius_mm: number}} | {cylinder: {radius_mm: number, length_mm: number, bore_mm: number}}
 *   | {disc: {radius_mm: [number, number], thickness_mm: number}} | {cone: {radius_mm: number, length_mm: number}}} Shape
 * @typedef {{cut_x_mm?: [number, number], within_x_mm?: [number, number], at_mm?: Triple}} Clip
 * @typedef {{name: string, material: string, body: number | null, pose: number[], shape: Shape,
 *   repeat?: {count: number, step_mm: Triple}, clip?: Clip}} Part
 * @typedef {{min_mm: Triple, max_mm: Triple, body: number | null, look: Triple | null}} ViewBox
 * @typedef {{id: number, name: string, from: 'controller' | 'machine'}} SignalInfo
 * @typedef {{axis: string, pul: number, dir: number, enable: number | null, active_edge: 'rising' | 'falling', setup_s: number,
 *   hold_s: number, width_s: number, space_s: number, dir_low: boolean, enable_low: boolean, enable_setup_s: number}} Drive
 * @typedef {{entity: number, process: string, layer: string, points_mm: [number, number][], closed: boolean}} Line
 * @typedef {{start_x_mm: number, pitch_mm: number, units: number, thickness_mm: number, unit: {min_mm: [number, number],
 *   max_mm: [number, number]}, marks: {x_mm: number, y_mm: number, diameter_mm: number}[], eye_mark: {x_mm: number, length_mm: number}}} Web
 * @typedef {{machine: string, scenario: string, title: string, tick_hz: number, period_s: number | null, quantum_s: number,
 *   time_limit_s: number, signals: SignalInfo[], drives: Drive[], laser: {gate: number | null, pwm: number | null, gate_low: boolean,
 *   pwm_low: boolean, full_power_w: number}, encoder: {a: number | null, b: number | null, count_mm: number}, columns: string[],
 *   bodies: Body[], parts: Part[], beam: Beam, views: {overall: ViewBox, head: ViewBox, sheet: ViewBox}, field: {min_mm: [number, number],
 *   max_mm: [number, number]}, web: Web, dieline: Line[], gcode: string[], gcode_from: 'sent' | 'recorded' | 'planned' | null, belt_mm_s: number}} Machine
 * @typedef {{name: string, title: string, outcome: 'PASS' | 'FAIL' | 'NOT PROVEN' | 'INVALID', value: number | null, limit: number | null,
 *   upper: boolean, u: number | null, unit: string, subject: string, sentence: string, time_s: number | null, within_s: number | null,
 *   sheet_unit: number, entity: number, x_mm: number | null, y_mm: number | null}} Check
 */

export {};
