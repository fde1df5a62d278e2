// A phone that is not there: a WebXR device in the page, whose walls are those of a simulated scan
// of our sample building, whose poses are those of a simulated walk, and whose clock is the test's.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { openPage, rest } from './helpers.mjs';

const read = (path) => readFileSync(new URL(`node_modules/${path}`, import.meta.url), 'utf8');
const EMULATOR = `${read('iwer/build/iwer.min.js')}\n${read('@iwer/sem/build/iwer-sem.min.js')}`;

/** A way through the sample building's corridors, map frame. */
export const WAY = [
  [56.5, 35.9], [59.5, 36.4], [62.8, 37.4], [66, 38.4], [68, 40.3], [67.4, 43.6], [66.4, 46.6],
  [65.4, 49.8], [64.2, 52.8],
];
export const PORTRAIT = { width: 390, height: 844 };
const FRAME_MS = 50;
const STEP_MS = 500; // of somebody who turns or walks: a frame each is enough
const EYE_M = 1.4;
const MOST_TICKS = 2000;

/** Return what a phone would see and measure on a way: a scan, samples of odometry, the truth. */
export function simulated({ path_m = WAY, seed = 2 } = {}) {
  return rest('POST', '/api/v1/simulations', { building: 'sample', path_m, seed });
}

/** Runs in the page, before its own scripts: the device, and a voice that writes down. */
function install({ planes, hasPlanes, isShown }) {
  const features = ['viewer', 'local', 'dom-overlay', ...(hasPlanes ? ['plane-detection'] : [])];
  const container = document.createElement('div');
  const device = new IWER.XRDevice({
    name: 'An Android phone', supportedSessionModes: ['inline', 'immersive-ar'],
    supportedFeatures: features, supportedFrameRates: [30], isSystemKeyboardSupported: true,
    internalNominalFrameRate: 30, interactionMode: 'screen-space',
    environmentBlendModes: { 'immersive-ar': 'alpha-blend' }, userAgent: navigator.userAgent,
  }, { canvasContainer: container });
  container.ariaHidden = 'true'; // it stands for the camera's picture, above which the page lies
  container.style.zIndex = '-1';
  device.installRuntime({ forceInstall: true });
  let scene;
  device.installSEM(class extends IWER_SEM.SyntheticEnvironmentModule {
    constructor(itsDevice) {
      super(itsDevice);
      scene = this;
    }

    render() {
      if (isShown) super.render(); // else nobody looks
    }
  });
  scene.loadEnvironment({ type: 'scene', version: 1, spatialEntities: planes });
  scene.planesVisible = isShown;
  scene.planes.children.forEach(({ material }) => material.color.set(0x8fa3b5));
  globalThis.phone = {
    device,
    spoken: [],
    pose([x, y, z], [qx, qy, qz, qw]) {
      device.position.set(x, y, z);
      device.quaternion.set(qx, qy, qz, qw);
    },
  };
  watchSockets();
  Object.defineProperty(globalThis, 'speechSynthesis', {
    value: { speak: ({ text }) => phone.spoken.push(text), cancel() {} },
  });
}

/** Runs in the page: note what goes over the socket; a session's seed, else drawn, is given. */
function watchSockets() {
  const { send } = WebSocket.prototype;
  WebSocket.prototype.send = function watched(text) {
    const message = JSON.parse(text);
    if (message.seq) phone.sent = message.seq;
    if (message.type !== 'hello') return send.call(this, text);
    this.addEventListener('message', ({ data }) => {
      const answer = JSON.parse(data);
      if (answer.type === 'estimate') phone.last = answer;
    });
    return send.call(this, JSON.stringify({ ...message, seed: 1 }));
  };
}

/** Return a wall, end points on the ground, as a plane whose y is the wall's normal. */
export function planeOf([[ax, ay], [bx, by]], index) {
  const width = Math.hypot(bx - ax, by - ay);
  const [cx, cz] = [(bx - ax) / width, -(by - ay) / width];
  const orientation = quaternionOf([cx, 0, cz], [-cz, 0, cx], [0, -1, 0]);
  return {
    uuid: `wall-${index}`,
    semanticLabel_META: 'WALL_FACE',
    locatable_META: { orientation, position: { x: (ax + bx) / 2, y: 1.2, z: -(ay + by) / 2 } },
    bounded2D_META: {
      offset: { x: -width / 2, y: -1.2 }, extent: { width, height: 2.4 },
    },
  };
}

/** Return the quaternion of a rotation whose matrix has these columns. */
function quaternionOf([a, d, g], [b, e, h], [c, f, i]) {
  const q = {
    w: 1 + a + e + i, x: 1 + a - e - i, y: 1 - a + e - i, z: 1 - a - e + i,
  };
  const size = Object.fromEntries(
    Object.entries(q).map(([axis, square]) => [axis, Math.sqrt(Math.max(square, 0)) / 2]));
  return {
    w: size.w,
    x: Math.sign(h - f || 1) * size.x,
    y: Math.sign(c - g || 1) * size.y,
    z: Math.sign(d - b || 1) * size.z,
  };
}

/** A page that thinks it is on a phone, and somebody who holds it. */
export class Phone {
  constructor(page) {
    this.page = page;
    this.facing = 0;
    this.place = [0, 0];
  }

  /**
   * Open the phone's page.
   *
   * @param {import('node:test').TestContext} t
   * @param {object} [options] `walls` to see, `hasPlanes`, `isShown`: whether
   *   the camera has a picture; `path`; more as in `openPage`
   */
  static async open(t, { walls = [], path = '/phone/', ...options } = {}) {
    const { hasPlanes = true, isShown = false, ...others } = options;
    const device = { planes: walls.map(planeOf), hasPlanes, isShown };
    const init = [EMULATOR, `${watchSockets}; (${install})(${JSON.stringify(device)})`];
    const page = await openPage(t, path, {
      init, clock: true, viewport: PORTRAIT, hasTouch: true, isMobile: true, ...others,
    });
    return new Phone(page);
  }

  /** Stand at a place, odom frame, and look along a bearing. */
  async pose(place, facing) {
    [this.place, this.facing] = [place, facing];
    const half = (facing - Math.PI / 2) / 2;
    const at = [[place[0], EYE_M, -place[1]], [0, Math.sin(half), 0, Math.cos(half)]];
    await this.page.evaluate(([p, q]) => globalThis.phone.pose(p, q), at);
  }

  /** Let the clock run until something is true in the page. */
  async until(what, argument) {
    for (let tick = 0; tick < MOST_TICKS; tick++) {
      if (await this.page.evaluate(what, argument)) return;
      await this.page.clock.runFor(FRAME_MS);
    }
    assert.fail(`never true: ${what}\n${await this.page.locator('body').innerText()}`);
  }

  /** Let the clock run until a screen is there. */
  async screen(name) {
    await this.until((wanted) => document.body.dataset.screen === wanted, name);
  }

  /** End the walk: the first press asks back. */
  async end() {
    const end = this.page.getByRole('button', { name: 'End' });
    await end.click();
    await this.screen('paused');
    await end.click();
    await this.screen('over');
  }

  /** Turn by an angle, slowly. */
  async turn(angle, steps = Math.ceil(Math.abs(angle) / 0.35)) {
    const from = this.facing;
    for (let i = 1; i <= steps; i++) {
      await this.pose(this.place, from + (angle * i) / steps);
      await this.page.clock.fastForward(STEP_MS);
    }
  }

  /** Walk samples of odometry. */
  async walk(samples) {
    for (const { position_m, facing_rad } of samples) {
      await this.pose(position_m, facing_rad ?? this.facing);
      await this.page.clock.fastForward(STEP_MS);
    }
  }

  /** Let the clock run until the server has answered all that was sent; its last estimate. */
  async settled() {
    await this.until(() => globalThis.phone.last?.seq === globalThis.phone.sent);
    return this.page.evaluate(() => globalThis.phone.last);
  }

  /** All that the page's own voice has said. */
  spoken() {
    return this.page.evaluate(() => globalThis.phone.spoken);
  }

  /** Let the clock run until something was said, by whichever voice; returns it. */
  async hears(pattern) {
    const find = ([source, flags]) => {
      const said = [...globalThis.phone.spoken, document.getElementById('said').textContent];
      return said.find((text) => new RegExp(source, flags).test(text));
    };
    const argument = [pattern.source, pattern.flags];
    await this.until(find, argument);
    return this.page.evaluate(find, argument);
  }
}
