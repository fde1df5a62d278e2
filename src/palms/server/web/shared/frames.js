// Binary frames of the socket: particles and heatmaps (docs/reference/messages.md).

/**
 * @typedef {object} Particles
 * @property {'particles'} kind
 * @property {number} seq of the input that they come after
 * @property {number} t_s on the phone's clock
 * @property {Float32Array} x_m map frame
 * @property {Float32Array} y_m
 * @property {Uint8Array} label candidate drift, modulo 256
 */

/**
 * @typedef {object} Heatmap
 * @property {'heatmap'} kind
 * @property {number} seq of the scan
 * @property {number} number from 0, the best first
 * @property {number} of how many maps
 * @property {number} drift_rad
 * @property {[number, number]} origin_m the picture's lower left corner, map frame
 * @property {number} cell_size_m
 * @property {number} label of the particles of this drift
 * @property {number} n_labels how many drifts there were; their labels go round the circle in order
 * @property {Blob} png grey, top row first
 */

const VERSION = 1;
const HEAD = { PF: 44, HF: 56 };

/**
 * Return what a binary frame holds; null when it is none of this version, or cut off.
 *
 * @param {ArrayBuffer} buffer
 * @returns {Particles | Heatmap | null}
 */
export function unpackFrame(buffer) {
  if (buffer.byteLength < 4) return null;
  const data = new DataView(buffer);
  const kind = String.fromCharCode(data.getUint8(0), data.getUint8(1));
  if (!(kind in HEAD) || data.getUint8(2) !== VERSION) return null;
  if (buffer.byteLength < HEAD[/** @type {keyof typeof HEAD} */ (kind)]) return null;
  return kind === 'PF' ? particles(data) : heatmap(data, buffer);
}

/**
 * Take a stream apart in which each frame follows its length, a little-endian uint32; what is cut
 * off at the end is left out.
 *
 * @param {ArrayBuffer} buffer
 * @returns {ArrayBuffer[]}
 */
export function splitFrames(buffer) {
  const data = new DataView(buffer);
  const found = [];
  for (let at = 0; at + 4 <= buffer.byteLength;) {
    const end = at + 4 + data.getUint32(at, true);
    if (end > buffer.byteLength) break;
    found.push(buffer.slice(at + 4, end));
    at = end;
  }
  return found;
}

/**
 * @param {DataView} data
 * @returns {Particles | null}
 */
function particles(data) {
  const n = data.getUint32(4, true);
  if (data.byteLength !== HEAD.PF + 5 * n) return null;
  const [x0, y0] = [data.getFloat64(24, true), data.getFloat64(32, true)];
  const unit = data.getFloat32(40, true);
  const [x_m, y_m] = [new Float32Array(n), new Float32Array(n)];
  for (let i = 0; i < n; i++) {
    x_m[i] = x0 + unit * data.getInt16(HEAD.PF + 4 * i, true);
    y_m[i] = y0 + unit * data.getInt16(HEAD.PF + 4 * i + 2, true);
  }
  return {
    kind: 'particles',
    seq: data.getFloat64(8, true),
    t_s: data.getFloat64(16, true),
    x_m,
    y_m,
    label: new Uint8Array(data.buffer, data.byteOffset + HEAD.PF + 4 * n, n),
  };
}

/**
 * @param {DataView} data
 * @param {ArrayBuffer} buffer the same
 * @returns {Heatmap}
 */
function heatmap(data, buffer) {
  return {
    kind: 'heatmap',
    number: data.getUint8(3),
    of: data.getUint32(4, true),
    seq: data.getFloat64(8, true),
    drift_rad: data.getFloat64(16, true),
    origin_m: [data.getFloat64(24, true), data.getFloat64(32, true)],
    cell_size_m: data.getFloat32(40, true),
    label: data.getUint16(52, true),
    n_labels: data.getUint16(54, true),
    png: new Blob([new Uint8Array(buffer, HEAD.HF)], { type: 'image/png' }),
  };
}
