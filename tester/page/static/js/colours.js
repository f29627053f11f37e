// Colours of data, and the size of text. Grounds and states are in style.css; there is no colour in the normal state.

/** Okabe-Ito, darkened for the light ground: contrast 3 with it, and still apart for the colour-blind. */
export const SERIES_LIGHT = ["#004975", "#cb5900", "#007857", "#ab658c", "#4491bd", "#6f4a00"];
/** Okabe-Ito on the dark ground, its blue lightened until a line has contrast 3. */
export const SERIES_DARK = ["#1b7abb", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"];
/** A dash of each series, so that no line is told by its colour alone. */
export const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3], [14, 5], [5, 2]];
/** A marker of each series. */
export const MARKERS = ["circle", "square", "triangle", "diamond", "cross", "plus"];

/** Cividis at nine points (Nunez, Anderton, Renslow 2018, doi 10.1371/journal.pone.0199239): monotone in lightness. */
export const CIVIDIS = [
  [0, 34, 78],
  [24, 55, 108],
  [66, 78, 108],
  [92, 101, 112],
  [124, 123, 120],
  [150, 146, 120],
  [180, 171, 112],
  [216, 197, 91],
  [254, 232, 56],
];

/**
 * Return whether the page is dark.
 * @returns {boolean}
 */
export function dark() {
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

/**
 * Return the colours of the series.
 * @returns {string[]}
 */
export function series() {
  return dark() ? SERIES_DARK : SERIES_LIGHT;
}

/**
 * Return a colour of the page's style by its custom property.
 * @param {string} name "--ink"
 * @returns {string}
 */
export function styled(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || "#808080";
}

/**
 * Return the map's colour of a share 0..1.
 * @param {number} share
 * @returns {[number, number, number]} red, green, blue 0..255
 */
export function cividis(share) {
  const at = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1);
  const low = Math.min(Math.floor(at), CIVIDIS.length - 2);
  return /** @type {[number, number, number]} */ (
    CIVIDIS[low].map((part, index) => Math.round(part + (at - low) * (CIVIDIS[low + 1][index] - part)))
  );
}

/**
 * Return the relative luminance of a colour (WCAG 2.2).
 * @param {number[]} rgb 0..255
 * @returns {number} 0..1
 */
export function luminance(rgb) {
  const [r, g, b] = rgb.map((part) =>
    part / 255 <= 0.04045 ? part / 3294.6 : ((part / 255 + 0.055) / 1.055) ** 2.4,
  );
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/**
 * Return black or white, whichever has the greater contrast with a colour.
 * @param {number[]} rgb
 * @returns {string}
 */
export function inkOn(rgb) {
  return luminance(rgb) > 0.179 ? "#000000" : "#ffffff"; // 0.179: both have the same contrast there
}

/**
 * Return the page's text size over 16 px: large screens have larger text, and their charts follow.
 * @returns {number}
 */
export function scale() {
  return parseFloat(getComputedStyle(document.documentElement).fontSize) / 16 || 1;
}

/**
 * Return the font of charts.
 * @returns {string}
 */
export function font() {
  return `${Math.round(13 * scale())}px system-ui, sans-serif`;
}
