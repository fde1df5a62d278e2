// Tint: a grey heatmap becomes a colour that is the more opaque the likelier a place is.

/**
 * @typedef {object} Tinted
 * @property {HTMLCanvasElement} image
 * @property {number} width pixels of the map
 * @property {number} height
 * @property {import('../shared/view.js').Point} origin_m
 * @property {number} cell_size_m
 */

const MOST_OPAQUE = 0.85;

/**
 * @param {import('../shared/frames.js').Heatmap} map
 * @param {string} colour of CSS
 * @returns {Promise<Tinted>}
 */
export async function tinted(map, colour) {
  const picture = await createImageBitmap(map.png);
  const { width, height } = picture;
  const image = Object.assign(document.createElement('canvas'), { width, height });
  const canvas = /** @type {CanvasRenderingContext2D} */ (
    image.getContext('2d', { willReadFrequently: true })
  );
  canvas.drawImage(picture, 0, 0);
  const pixels = canvas.getImageData(0, 0, width, height);
  const [red, green, blue] = bytesOf(colour, canvas);
  for (let i = 0; i < pixels.data.length; i += 4) {
    pixels.data.set([red, green, blue, MOST_OPAQUE * pixels.data[i]], i);
  }
  canvas.putImageData(pixels, 0, 0);
  return { image, width, height, origin_m: map.origin_m, cell_size_m: map.cell_size_m };
}

/**
 * @param {string} colour
 * @param {CanvasRenderingContext2D} canvas which knows how to read colours: as #rrggbb
 */
function bytesOf(colour, canvas) {
  canvas.fillStyle = colour;
  const text = String(canvas.fillStyle);
  return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
}
