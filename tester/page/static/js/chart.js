// Charts over rig time: uPlot with a measured line, its own set point as it was, regions and marks.

import { h, say } from "./dom.js";
import { hms, number } from "./format.js";
import { DASHES, font, scale, series, styled } from "./colours.js";
import { hooks } from "./marks.js";

/* global uPlot */

const THEME = matchMedia("(prefers-color-scheme: dark)");
const drawn = new Set();
THEME.addEventListener("change", () => drawn.forEach((chart) => chart.redraw()));

/**
 * Return an axis of uPlot in the page's colours.
 * @param {Object} more
 * @returns {Object}
 */
export function axis(more) {
  return {
    stroke: () => styled("--ink-2"),
    grid: { stroke: () => styled("--grid"), width: 1 },
    ticks: { stroke: () => styled("--grid"), width: 1 },
    font: font(),
    labelFont: font(),
    ...more,
  };
}

/**
 * Return the range of values, widened to the narrowest one that may be drawn.
 * @param {number|null} low
 * @param {number|null} high
 * @param {number} least
 * @returns {[number, number]}
 */
export function range(low, high, least) {
  if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, least];
  const wide = Math.max(high - low, least);
  const middle = (low + high) / 2;
  return [middle - 0.56 * wide, middle + 0.56 * wide];
}

/**
 * Watch an element's width and tell it, at most once a frame.
 * @param {Element} node
 * @param {(width: number) => void} tell
 * @returns {ResizeObserver}
 */
export function watchWidth(node, tell) {
  let asked = 0;
  const observer = new ResizeObserver(() => {
    cancelAnimationFrame(asked);
    asked = requestAnimationFrame(() => {
      if (node.clientWidth > 0) tell(node.clientWidth);
    });
  });
  observer.observe(node);
  return observer;
}

/**
 * One chart over rig time.
 *
 * `show` draws data; `onzoom(from_s, to_s)` is called where a person marks a range (null, null: the whole again).
 */
export class TimeChart {
  /**
   * @param {{title: string, unit: string, decimals: number, least: number, labelled?: boolean,
   *   onzoom?: (from: number|null, to: number|null) => void, height?: number}} spec
   */
  constructor(spec) {
    this.spec = spec;
    this.shown = { regions: [], marks: [], cursor: null };
    this.readout = h("span", { class: "readout" });
    this.canvas = h("div", {
      class: "canvas",
      role: "img",
      "aria-label": `${spec.title} over rig time; the table has its numbers`,
    });
    this.node = h(
      "figure",
      { class: "chart" },
      h("figcaption", {}, h("strong", { text: spec.title }), spec.unit ? ` ${spec.unit}` : "", this.readout),
      this.canvas,
    );
    this.plot = null;
    this.data = [[], [], []];
    this.span = [0, 60];
    this.watch = watchWidth(this.canvas, (width) => this.#size(width));
    drawn.add(this);
  }

  /**
   * Draw.
   * @param {ArrayLike<number>} t rig seconds, ascending
   * @param {ArrayLike<number|null>} value
   * @param {ArrayLike<number|null>|null} setpoint as it was at each time
   * @param {[number, number]} span rig seconds
   * @param {{regions?: Object[], marks?: Object[], cursor?: number|null}} [more]
   */
  show(t, value, setpoint, span, more = {}) {
    this.data = [t, value, setpoint ?? new Array(t.length).fill(null)];
    this.span = span[1] > span[0] ? span : [span[0], span[0] + 1];
    this.shown = { regions: more.regions ?? [], marks: more.marks ?? [], cursor: more.cursor ?? null };
    if (!this.plot) {
      if (this.canvas.clientWidth > 0) this.#make(this.canvas.clientWidth);
      return;
    }
    this.plot.batch(() => {
      this.plot.setData(this.data, false);
      this.plot.setScale("x", { min: this.span[0], max: this.span[1] });
    });
  }

  /** Draw again, in another theme. */
  redraw() {
    this.plot?.redraw(false, true);
  }

  /** Give everything back. */
  end() {
    drawn.delete(this);
    this.watch.disconnect();
    this.plot?.destroy();
    this.plot = null;
    this.node.remove();
  }

  #size(width) {
    if (!this.plot) this.#make(width);
    else if (width !== this.plot.width) this.plot.setSize({ width, height: this.plot.height });
  }

  #make(width) {
    const { decimals, least, labelled = true, height = 170, onzoom } = this.spec;
    this.plot = new uPlot(
      {
        width,
        height: Math.round(height * scale()),
        legend: { show: false },
        cursor: { y: false, drag: { x: Boolean(onzoom), y: false, setScale: false } },
        scales: {
          x: { time: false, range: () => /** @type {any} */ (this.span) },
          y: { range: (_plot, low, high) => range(low, high, least) },
        },
        axes: [
          axis({ values: (_plot, at) => at.map(hms), space: 90 * scale(), size: 34 * scale() }),
          axis({
            values: (_plot, at) => at.map((v) => number(v, Math.min(decimals, 2))),
            size: 62 * scale(),
            space: 34 * scale(),
          }),
        ],
        series: [
          {},
          { stroke: () => series()[0], width: 2 * scale(), points: { show: false }, spanGaps: false },
          {
            stroke: () => styled("--ink-2"),
            width: 1.5 * scale(),
            dash: DASHES[1],
            points: { show: false },
            paths: uPlot.paths.stepped({ align: 1 }),
          },
        ],
        hooks: {
          ...hooks(() => this.shown, labelled),
          setCursor: [(plot) => this.#read(plot)],
          setSelect: [
            (plot) => {
              if (plot.select.width < 4 || !onzoom) return;
              const [from, to] = [plot.select.left, plot.select.left + plot.select.width].map((x) =>
                plot.posToVal(x, "x"),
              );
              plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              onzoom(from, to);
            },
          ],
        },
      },
      this.data,
      this.canvas,
    );
    if (onzoom) this.plot.over.addEventListener("dblclick", () => onzoom(null, null));
  }

  #read(plot) {
    const at = plot.cursor.idx;
    const { unit, decimals } = this.spec;
    if (at === null || at === undefined) {
      say(this.readout, "");
      return;
    }
    const wanted = this.data[2][at];
    const tail =
      typeof wanted === "number" && Number.isFinite(wanted) ? `, set point ${number(wanted, decimals)}` : "";
    say(this.readout, ` at ${hms(this.data[0][at])}: ${number(this.data[1][at], decimals)} ${unit}${tail}`);
  }
}

/**
 * Return last, least and greatest of numbers inside a span.
 * @param {ArrayLike<number>} t
 * @param {ArrayLike<number|null>} y
 * @param {[number, number]} span
 * @returns {{last: number|null, min: number|null, max: number|null}}
 */
export function extremes(t, y, span) {
  let last = null;
  let min = Infinity;
  let max = -Infinity;
  for (let index = 0; index < t.length; index += 1) {
    const value = y[index];
    if (t[index] < span[0] || t[index] > span[1] || value === null || !Number.isFinite(value)) continue;
    last = value;
    if (value < min) min = value;
    if (value > max) max = value;
  }
  return last === null ? { last, min: null, max: null } : { last, min, max };
}
