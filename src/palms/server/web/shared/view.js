// View: which part of the map is on the screen. The map's y grows upwards, the screen's downwards.

/**
 * @typedef {object} View
 * @property {number} x_m what is in the middle of the screen, map frame
 * @property {number} y_m
 * @property {number} scale pixels (of CSS) per metre
 * @property {number} width of the screen, pixels
 * @property {number} height
 */

/** @typedef {[number, number]} Point */

const SCALES = { least: 0.2, most: 400 };

/** @param {number} scale */
const within = (scale) => Math.min(Math.max(scale, SCALES.least), SCALES.most);

/**
 * Return a view that shows a box whole, with a margin.
 *
 * @param {[Point, Point]} bounds_m lower left and upper right corner
 * @param {{ width: number, height: number }} screen
 * @param {number} margin pixels
 * @returns {View}
 */
export function fitted([[left, bottom], [right, top]], { width, height }, margin = 24) {
  const wide = Math.max(width - 2 * margin, 1) / Math.max(right - left, 1);
  const high = Math.max(height - 2 * margin, 1) / Math.max(top - bottom, 1);
  return {
    x_m: (left + right) / 2,
    y_m: (bottom + top) / 2,
    scale: within(Math.min(wide, high)),
    width,
    height,
  };
}

/**
 * @param {View} view
 * @param {Point} point_m
 * @returns {Point} pixels from the upper left corner
 */
export function toScreen(view, [x, y]) {
  return [
    view.width / 2 + (x - view.x_m) * view.scale,
    view.height / 2 - (y - view.y_m) * view.scale,
  ];
}

/**
 * @param {View} view
 * @param {Point} point pixels
 * @returns {Point} metres
 */
export function toMap(view, [px, py]) {
  return [
    view.x_m + (px - view.width / 2) / view.scale,
    view.y_m - (py - view.height / 2) / view.scale,
  ];
}

/**
 * Return the view after its content was moved by so many pixels.
 *
 * @param {View} view
 * @param {Point} by
 * @returns {View}
 */
export function panned(view, [dx, dy]) {
  return { ...view, x_m: view.x_m - dx / view.scale, y_m: view.y_m + dy / view.scale };
}

/**
 * Return a view that is larger by a factor; what is at a point of the screen stays there.
 *
 * @param {View} view
 * @param {number} factor
 * @param {Point} [at] pixels; the middle when left out
 * @returns {View}
 */
export function zoomed(view, factor, at = [view.width / 2, view.height / 2]) {
  const scale = within(view.scale * factor);
  const [x, y] = toMap(view, at);
  const k = view.scale / scale;
  return { ...view, scale, x_m: x + (view.x_m - x) * k, y_m: y + (view.y_m - y) * k };
}

/**
 * Let a canvas draw in metres of the map.
 *
 * @param {CanvasRenderingContext2D} canvas
 * @param {View} view
 * @param {number} density device pixels per pixel
 */
export function useMetres(canvas, view, density) {
  const k = view.scale * density;
  canvas.setTransform(
    k, 0, 0, -k,
    (view.width / 2) * density - view.x_m * k,
    (view.height / 2) * density + view.y_m * k,
  );
}

/**
 * Let a canvas draw in pixels of CSS.
 *
 * @param {CanvasRenderingContext2D} canvas
 * @param {number} density
 */
export function usePixels(canvas, density) {
  canvas.setTransform(density, 0, 0, density, 0, 0);
}
