// Samples of a run: windows of at most 2 x width points, decoded from base64.

/**
 * Decode base64 of little-endian numbers.
 * @param {string} text
 * @param {Float32ArrayConstructor|Float64ArrayConstructor} type
 * @returns {Float32Array|Float64Array}
 */
export function decode(text, type) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let index = 0; index < raw.length; index += 1) bytes[index] = raw.charCodeAt(index);
  return new type(bytes.buffer);
}

/**
 * Ask for a window of samples; each bucket gives its least and its greatest value, so that no peak is hidden.
 * @param {import("./link.js").Link} link
 * @param {string} run
 * @param {string[]} columns
 * @param {[number, number]} span rig seconds
 * @param {number} points greatest number of buckets
 * @returns {Promise<{t: Float64Array, y: Object<string, Float32Array>}>} both at the same times, twice a bucket
 */
export async function windowOf(link, run, columns, span, points) {
  const answer = await link.ask("samples", {
    run,
    columns,
    from_s: span[0],
    to_s: span[1],
    points: Math.max(Math.round(points), 16),
  });
  const at = decode(answer.t, Float64Array);
  const t = new Float64Array(2 * at.length);
  at.forEach((value, index) => {
    t[2 * index] = span[0] + value;
    t[2 * index + 1] = span[0] + value;
  });
  const y = {};
  for (const [key, { min, max }] of Object.entries(answer.columns)) {
    const low = decode(min, Float32Array);
    const high = decode(max, Float32Array);
    const both = new Float32Array(2 * low.length);
    low.forEach((value, index) => {
      both[2 * index] = value;
      both[2 * index + 1] = high[index];
    });
    y[key] = both;
  }
  return { t, y };
}

/**
 * Return numbers with null where they are not finite, as uPlot leaves gaps.
 * @param {ArrayLike<number|null>} values
 * @returns {(number|null)[]}
 */
export function gaps(values) {
  return Array.from(values, (value) => (Number.isFinite(value) ? value : null));
}

/**
 * Return the columns to draw of a machine's plots: the value's, its setpoint's where the run has one.
 * @param {{plots: {key: string, column: string, least: number}[], trend: string[]}} machine
 * @param {Set<string>|null} known the run's columns; null: all
 * @returns {{key: string, column: string, setpoint: string, least: number}[]}
 */
export function plotted(machine, known) {
  return machine.plots
    .filter((plot) => !known || known.has(plot.column))
    .map((plot) => {
      const next = machine.trend[machine.trend.indexOf(plot.column) + 1] ?? "";
      const setpoint = next.includes("_setpoint") && (!known || known.has(next)) ? next : "";
      return { ...plot, setpoint };
    });
}
