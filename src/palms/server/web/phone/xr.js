// The camera's session: poses and planes of WebXR, as events.

/**
 * @typedef {import('./poses.js').Pose} Pose
 * @typedef {import('./planes.js').Plane} Plane
 */

/**
 * @typedef {object} Sight
 * @property {number} time_s on the phone's clock, since 1970
 * @property {Pose} pose
 * @property {Plane[]} planes those known now
 */

const PLANES_EVERY_S = 0.5;
const BLIND_S = 3; // without a pose for so long, and its user is told

/** What the phone cannot do, as the key of a text. */
export class Unable extends Error {
  /** @param {string} key */
  constructor(key) {
    super(key);
    this.name = 'Unable';
    this.key = key;
  }
}

/** Whether this browser has AR sessions at all. */
export async function hasAr() {
  try {
    return Boolean(await navigator.xr?.isSessionSupported('immersive-ar'));
  } catch {
    return false;
  }
}

/**
 * Says `sight` (a Sight) with each frame; `blind` when there has been no pose for a while;
 * `reset` when the frame of reference is a new one; `hidden` and `visible`; `end`.
 */
export class Eyes extends EventTarget {
  /** @type {XRSession | null} */ #session = null;
  /** @type {Plane[]} */ #planes = [];
  #planes_s = -Infinity;
  #seen_s = -Infinity;
  #isBlind = false;

  /** Whether the camera is on. */
  get isOpen() {
    return this.#session !== null;
  }

  /**
   * Ask for leave and begin; to be called while a button is being pressed.
   *
   * @param {Element} root what stays visible over the camera's picture
   * @throws {Unable}
   */
  async open(root) {
    const session = await askForSession(root);
    this.#session = session;
    try {
      await this.#begin(session);
    } catch {
      await this.close();
      throw new Unable('problem.noPlanes');
    }
  }

  /** @param {XRSession} session */
  async #begin(session) {
    session.addEventListener('end', () => this.#ended(session));
    session.addEventListener('visibilitychange', () =>
      this.#tell(session.visibilityState === 'hidden' ? 'hidden' : 'visible'));
    await session.updateRenderState({ baseLayer: emptyLayer(session) });
    const space = await session.requestReferenceSpace('local');
    space.addEventListener('reset', () => {
      this.#planes_s = -Infinity;
      this.#tell('reset');
    });
    const frame = (/** @type {number} */ time_ms, /** @type {XRFrame} */ now) => {
      if (this.#session !== session) return;
      session.requestAnimationFrame(frame);
      this.#look(now, space, (performance.timeOrigin + time_ms) / 1000);
    };
    session.requestAnimationFrame(frame);
  }

  /** Switch the camera off. */
  async close() {
    const session = this.#session;
    this.#session = null;
    await session?.end().catch(() => {});
  }

  /** @param {XRSession} session */
  #ended(session) {
    if (this.#session !== session) return;
    this.#session = null;
    this.#tell('end');
  }

  /**
   * @param {XRFrame} frame
   * @param {XRReferenceSpace} space
   * @param {number} time_s
   */
  #look(frame, space, time_s) {
    const seen = frame.getViewerPose(space);
    if (!seen || seen.emulatedPosition) {
      this.#miss(time_s);
      return;
    }
    [this.#seen_s, this.#isBlind] = [time_s, false];
    if (time_s - this.#planes_s >= PLANES_EVERY_S) {
      [this.#planes, this.#planes_s] = [planesOf(frame, space), time_s];
    }
    this.#tell('sight', { time_s, pose: poseOf(seen.transform), planes: this.#planes });
  }

  /** @param {number} time_s */
  #miss(time_s) {
    if (this.#seen_s === -Infinity) this.#seen_s = time_s;
    if (this.#isBlind || time_s - this.#seen_s < BLIND_S) return;
    this.#isBlind = true;
    this.#tell('blind');
  }

  /**
   * @param {string} kind
   * @param {Sight} [detail]
   */
  #tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }
}

/**
 * @param {Element} root
 * @returns {Promise<XRSession>}
 */
async function askForSession(root) {
  try {
    return await /** @type {XRSystem} */ (navigator.xr).requestSession('immersive-ar', {
      requiredFeatures: ['local', 'plane-detection'],
      optionalFeatures: ['dom-overlay'],
      domOverlay: { root },
    });
  } catch (problem) {
    const isDenied = /** @type {Error} */ (problem).name === 'NotAllowedError';
    throw new Unable(isDenied ? 'problem.denied' : 'problem.noPlanes');
  }
}

/** A picture of nothing: the camera's own shows, and frames come. */
function emptyLayer(/** @type {XRSession} */ session) {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('webgl2', { xrCompatible: true, alpha: true });
  if (!context) throw new Error('no WebGL');
  return new XRWebGLLayer(session, context);
}

/**
 * @param {XRFrame} frame
 * @param {XRReferenceSpace} space
 * @returns {Plane[]}
 */
function planesOf(frame, space) {
  return [...(frame.detectedPlanes ?? [])].flatMap((plane) => {
    const pose = frame.getPose(plane.planeSpace, space);
    if (!pose) return [];
    return [{
      pose: poseOf(pose.transform),
      polygon: [...plane.polygon].map(({ x, y, z }) => ({ x, y, z })),
      orientation: plane.orientation,
      semanticLabel: plane.semanticLabel,
    }];
  });
}

/** @returns {Pose} */
function poseOf(/** @type {XRRigidTransform} */ { position: p, orientation: q }) {
  return {
    position: { x: p.x, y: p.y, z: p.z },
    orientation: { x: q.x, y: q.y, z: q.z, w: q.w },
  };
}
