// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Light, floor, camera and picture: what the machine stands in. It draws when it is told that something changed, and not
// otherwise. Where a picture takes too long, it becomes coarser until it does not.

import {
  ACESFilmicToneMapping, Box3, CircleGeometry, Color, DirectionalLight, HemisphereLight, Mesh, PCFShadowMap,
  PerspectiveCamera, PMREMGenerator, Scene, ShadowMaterial, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';

const kFov_deg = 28;
const kSlow_ms = 40; // A picture that takes longer is made coarser the next time.
const kRatios = [1, 0.8, 0.6, 0.45];

export class Stage {
  #wanted = false;
  #quality = 0;
  #slow = 0;
  #closed = false;

  /**
   * @param {HTMLElement} element that it fills @param {{min_mm: number[], max_mm: number[]}} overall of the machine
   * @param {() => void} beforePicture
   */
  constructor(element, overall, beforePicture) {
    this.element = element;
    this.beforePicture = beforePicture;
    /** Times that the last pictures took to be told to the graphics card, ms. @type {number[]} */
    this.frames_ms = [];
    this.pictures = 0;
    this.box = new Box3(new Vector3(...overall.min_mm), new Vector3(...overall.max_mm));
    this.span_mm = this.box.getSize(new Vector3()).length();
    this.renderer = new WebGLRenderer({ antialias: true, powerPreference: 'high-performance' });
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.renderer.toneMappingExposure = 1.05;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.renderer.localClippingEnabled = true;
    element.append(this.renderer.domElement);
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(kFov_deg, 1, 0.004 * this.span_mm, 12 * this.span_mm);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.want());
    this.controls.maxDistance = 4 * this.span_mm;
    this.controls.minDistance = 5;
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.#light();
    this.resizing = new ResizeObserver(() => this.resize());
    this.resizing.observe(element);
    this.resize();
  }

  #light() {
    const rooms = new PMREMGenerator(this.renderer);
    this.scene.environment = rooms.fromScene(new RoomEnvironment(), 0.04).texture;
    this.scene.environmentIntensity = 0.36;
    this.scene.environmentRotation.x = Math.PI / 2;
    rooms.dispose();
    const middle = this.box.getCenter(new Vector3());
    this.key = new DirectionalLight(new Color(1, 0.965, 0.91), 2.5);
    this.key.position.copy(middle).add(new Vector3(-0.75, -0.75, 1.6).multiplyScalar(this.span_mm));
    this.key.target.position.copy(middle);
    this.key.castShadow = true;
    this.key.shadow.mapSize.set(2048, 2048);
    const reach = 0.62 * this.span_mm;
    Object.assign(this.key.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1 * this.span_mm, far: 4 * this.span_mm });
    this.key.shadow.radius = 3;
    this.key.shadow.normalBias = 0.0006 * this.span_mm;
    this.scene.add(this.key, this.key.target, new HemisphereLight(new Color(0.86, 0.92, 1), new Color(0.42, 0.4, 0.38), 0.42));
    this.floor = new Mesh(new CircleGeometry(8 * this.span_mm, 64), new ShadowMaterial({ opacity: 0.26 }));
    this.floor.position.set(middle.x, middle.y, this.box.min.z);
    this.floor.receiveShadow = true;
    this.scene.add(this.floor);
  }

  /** Colour of the room: the floor is only seen where a shadow falls on it. @param {string} css */
  background(css) {
    const color = new Color(css);
    this.scene.background = color;
    this.want();
  }

  /** The picture is as large as the element. */
  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio) * kRatios[this.#quality]);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.onResize?.(this.renderer.domElement.width, this.renderer.domElement.height, kFov_deg);
    this.want();
  }

  /** @type {((width_px: number, height_px: number, fov_deg: number) => void) | undefined} */
  onResize;

  /**
   * Looks along a direction so that points fill the picture.
   * @param {Vector3[]} points in W @param {Vector3} look @param {number} share of the picture
   */
  lookAt(points, look, share = 0.94) {
    const { camera } = this;
    const middle = new Box3().setFromPoints(points).getCenter(new Vector3());
    const direction = look.clone().normalize();
    const tan = share * Math.tan((kFov_deg * Math.PI) / 360);
    camera.position.copy(middle).addScaledVector(direction, -this.span_mm);
    camera.lookAt(middle);
    const [right, up, back] = [new Vector3(), new Vector3(), new Vector3()];
    camera.updateMatrixWorld();
    camera.matrixWorld.extractBasis(right, up, back);
    // Each side of the picture is a plane through the eye; the outermost point of each side decides how far it is.
    const across = sides(points, right, back, tan * camera.aspect);
    const upward = sides(points, up, back, tan);
    const eye = new Vector3().addScaledVector(right, across.middle).addScaledVector(up, upward.middle).addScaledVector(back, Math.max(across.back, upward.back));
    camera.position.copy(eye);
    const depth = eye.clone().sub(middle).dot(back);
    this.controls.target.copy(eye).addScaledVector(back, -depth);
    this.controls.update();
    this.want();
  }

  /** Moves the eye with what it looks at. @param {Vector3} target */
  follow(target) {
    const shift = target.clone().sub(this.controls.target);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.controls.update();
  }

  /** Asks for a picture; many wishes before the next one are one. */
  want() {
    if (this.#wanted || this.#closed) return;
    this.#wanted = true;
    requestAnimationFrame(() => {
      this.#wanted = false;
      if (!this.#closed) this.#draw();
    });
  }

  #draw() {
    const from_ms = performance.now();
    this.beforePicture();
    this.renderer.render(this.scene, this.camera);
    const took_ms = performance.now() - from_ms;
    ++this.pictures;
    this.frames_ms.push(took_ms);
    if (this.frames_ms.length > 120) this.frames_ms.shift();
    this.#slow = took_ms > kSlow_ms ? this.#slow + 1 : 0;
    if (this.#slow > 8 && this.#quality + 1 < kRatios.length) {
      this.#slow = 0;
      ++this.#quality;
      this.key.shadow.mapSize.set(1024, 1024);
      this.key.shadow.map?.dispose();
      this.key.shadow.map = null;
      this.resize();
    }
  }

  close() {
    this.#closed = true;
    this.resizing.disconnect();
    this.controls.dispose();
    this.scene.traverse((object) => {
      const mesh = /** @type {any} */ (object);
      mesh.geometry?.dispose();
      mesh.material?.dispose?.();
    });
    this.scene.environment?.dispose();
    this.renderer.dispose();
    this.renderer.domElement.remove();
  }
}

/**
 * Where an eye must be, along two axes, so that points lie between two planes through it that open by a tangent.
 * @param {Vector3[]} points @param {Vector3} axis across @param {Vector3} back towards the eye @param {number} tan
 */
function sides(points, axis, back, tan) {
  let [low, high] = [Infinity, -Infinity];
  for (const p of points) {
    low = Math.min(low, p.dot(axis) - tan * p.dot(back));
    high = Math.max(high, p.dot(axis) + tan * p.dot(back));
  }
  return { middle: 0.5 * (low + high), back: (high - low) / (2 * tan) };
}
