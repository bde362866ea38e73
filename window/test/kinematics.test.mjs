// SPDX-License-Identifier: Apache-2.0
// Poses of bodies and the way of the beam, against formulas that are none of the code's own.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { beamCorners } from '../src/machine/beam_path.js';
import { applied, identity, poseOfJoint, poseOfPart, posesOf, rotated, slid, times, turned } from '../src/machine/kinematics.js';
import { numbers } from './random.mjs';

const near = (a, b, limit, words) => a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) <= limit, `${words}: ${a} is not ${b}`));
const unit = (v) => v.map((x) => x / Math.hypot(...v));
const minus = (a, b) => a.map((x, i) => x - b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);

test('a turn is the exponential of its axis', () => {
  const next = numbers(11);
  for (let round = 0; round < 50; ++round) {
    const [x, y, z] = unit([next() - 0.5, next() - 0.5, next() - 0.5]);
    const angle = 6 * next() - 3;
    const v = [next(), next(), next()];
    // The series of exp(angle [axis]x) applied to v.
    let term = v;
    let sum = v;
    for (let k = 1; k < 40; ++k) {
      const [a, b, c] = term;
      term = [y * c - z * b, z * a - x * c, x * b - y * a].map((one) => (one * angle) / k);
      sum = sum.map((one, i) => one + term[i]);
    }
    near(rotated(turned([x, y, z], [0, 0, 0], angle), v), sum, 1e-12, 'turned');
    const origin = [10 * next(), 10 * next(), 10 * next()];
    near(applied(turned([x, y, z], origin, angle), origin), origin, 1e-12, 'the origin of the axis stays');
  }
});

test('a part lies where its quaternion turns it', () => {
  const next = numbers(12);
  for (let round = 0; round < 50; ++round) {
    const q = unit([next() - 0.5, next() - 0.5, next() - 0.5, next() - 0.5]);
    const v = [next(), next(), next()];
    const product = ([a, b, c, d], [e, f, g, h]) => [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
    const [, ...turnedBy] = product(product(q, [0, ...v]), [q[0], -q[1], -q[2], -q[3]]);
    near(applied(poseOfPart([1, 2, 3, ...q]), v), turnedBy.map((one, i) => one + [1, 2, 3][i]), 1e-12, 'placed');
  }
});

test('a body moves with its parent, after its own joints from the last to the first', () => {
  const bodies = [
    { name: 'slide', parent: null, joints: [{ kind: 'slide', axis: [1, 0, 0], by: 'gantry_x_mm', scale: 1 }] },
    { name: 'wheel', parent: 0, joints: [{ kind: 'slide', axis: [0, 1, 0], by: 'gantry_y_mm', scale: 2 }, { kind: 'turn', axis: [0, 0, 1], origin_mm: [5, 0, 0], by: 'angle', scale: 1 }] },
  ];
  const [, wheel] = posesOf(bodies, { gantry_x_mm: 100, gantry_y_mm: 7, angle: Math.PI / 2 });
  // The turn about (5, 0, 0) first, then 14 along y, then the parent's 100 along x.
  near(applied(wheel, [6, 0, 0]), [105, 15, 0], 1e-12, 'moved');
  assert.throws(() => posesOf([{ name: 'child', parent: 3, joints: [] }], {}), /before its parent/);
});

test('a joint wraps, also below zero, and stands still for a column that is not there or not known', () => {
  const joint = { kind: 'slide', axis: [1, 0, 0], by: 'belt_mm', scale: 1, wrap_mm: 20 };
  near(applied(poseOfJoint(joint, { belt_mm: 45 }), [0, 0, 0]), [5, 0, 0], 1e-12, 'wrapped');
  near(applied(poseOfJoint(joint, { belt_mm: -3 }), [0, 0, 0]), [17, 0, 0], 1e-12, 'wrapped below zero');
  near(poseOfJoint(joint, {}), identity(), 0, 'no column');
  near(poseOfJoint(joint, { belt_mm: NaN }), identity(), 0, 'not known');
  near(times(slid([1, 0, 0], 2), slid([0, 0, 1], 3)).slice(12, 15), [2, 0, 3], 0, 'slides add up');
});

/** A two-mirror head as docs/reference/machine.md has it: X mirror first, S before the Y mirror, which is D above the sheet. */
function head(S, D) {
  const half = Math.SQRT1_2;
  // The first mirror turns +x into +y, the second one +y into -z; a disc looks along z of its frame.
  const disc = (at, normal) => {
    const [x, y, z] = unit(normal);
    const w = Math.sqrt((1 + z) / 2);
    return { body: null, pose: w > 1e-9 ? [...at, w, -y / (2 * w), x / (2 * w), 0] : [...at, 0, 1, 0, 0] };
  };
  const parts = [{ ...disc([0, -S, D], [-half, half, 0]), body: 0 }, { ...disc([0, 0, D], [0, -half, -half]), body: 1 }];
  const bodies = [
    { name: 'x mirror', parent: null, joints: [{ kind: 'turn', axis: [0, 0, -1], origin_mm: [0, -S, D], by: 'mirror_x_rad', scale: 1 }] },
    { name: 'y mirror', parent: null, joints: [{ kind: 'turn', axis: [1, 0, 0], origin_mm: [0, 0, D], by: 'mirror_y_rad', scale: 1 }] },
  ];
  const beam = { from: [{ at_mm: [-100, -S, D], body: null, direction: [1, 0, 0], radius_mm: 1 }, { mirror: 0, radius_mm: 1 }, { mirror: 1, radius_mm: 1 }], spot_radius_mm: 0.1 };
  return { parts, bodies, beam };
}

test('the beam meets the sheet where Cheng, Cui and Zhang (2014, eq. 1) say', () => {
  const [S, D] = [15, 500];
  const { parts, bodies, beam } = head(S, D);
  const next = numbers(13);
  for (let round = 0; round < 100; ++round) {
    const [a, b] = [0.12 * next() - 0.06, 0.12 * next() - 0.06];
    const { corners, direction } = beamCorners(beam, parts, posesOf(bodies, { mirror_x_rad: a, mirror_y_rad: b }));
    assert.equal(corners.length, 3);
    const last = corners[2];
    const spot = last.map((value, i) => value - (last[2] / direction[2]) * direction[i]);
    const y = D * Math.tan(2 * b);
    const x = (S + Math.hypot(D, y)) * Math.tan(2 * a);
    near(spot.slice(0, 2), [x, y], 1e-9, 'spot');
  }
});

test('at each mirror the angle of the leaving beam is that of the arriving one', () => {
  const { parts, bodies, beam } = head(15, 500);
  const poses = posesOf(bodies, { mirror_x_rad: 0.03, mirror_y_rad: -0.02 });
  const { corners, direction } = beamCorners(beam, parts, poses);
  const ways = [minus(corners[1], corners[0]), minus(corners[2], corners[1]), direction].map(unit);
  for (const mirror of [0, 1]) {
    const normal = rotated(times(poses[mirror], poseOfPart(parts[mirror].pose)), [0, 0, 1]);
    assert.ok(Math.abs(dot(ways[mirror], normal) + dot(ways[mirror + 1], normal)) < 1e-12);
  }
});

test('a lens bends nothing here, and a beam along a mirror ends there', () => {
  const straight = { from: [{ at_mm: [0, 0, 100], body: null, direction: [0, 0, -1], radius_mm: 1 }, { plane: { at_mm: [0, 0, 50], normal: [0, 0, 1] }, radius_mm: 1 }], spot_radius_mm: 0.1 };
  assert.deepEqual(beamCorners(straight, [], []), { corners: [[0, 0, 100], [0, 0, 50]], direction: [0, 0, -1] });
  const along = { from: [{ at_mm: [0, 0, 100], body: null, direction: [0, 0, -1], radius_mm: 1 }, { plane: { at_mm: [9, 0, 0], normal: [1, 0, 0] }, radius_mm: 1 }], spot_radius_mm: 0.1 };
  assert.equal(beamCorners(along, [], []).corners.length, 1);
});
