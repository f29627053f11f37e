// Charts of coefficients with their uncertainty: up to six runs over an axis, each with colour, dash and marker.

import { h, s } from "./dom.js";
import { short } from "./format.js";
import { DASHES, MARKERS, scale, series, styled } from "./colours.js";
import { axis, range, watchWidth } from "./chart.js";

/* global uPlot */

/** How far apart the points of two runs at one place are drawn, pixels. */
const DODGE = 7;

/** @typedef {{name: string, points: {x: number|string, y: number|null, u: number|null, label?: string}[]}} Run */

/**
 * Draw a marker.
 * @param {CanvasRenderingContext2D} ctx
 * @param {string} form one of MARKERS
 * @param {number} x
 * @param {number} y
 * @param {number} r half of its size, device pixels
 */
export function marker(ctx, form, x, y, r) {
  ctx.beginPath();
  if (form === "circle") ctx.arc(x, y, r, 0, 2 * Math.PI);
  else if (form === "square") ctx.rect(x - r, y - r, 2 * r, 2 * r);
  else if (form === "triangle") {
    ctx.moveTo(x, y - r);
    ctx.lineTo(x + r, y + r);
    ctx.lineTo(x - r, y + r);
    ctx.closePath();
  } else if (form === "diamond") {
    ctx.moveTo(x, y - r);
    ctx.lineTo(x + r, y);
    ctx.lineTo(x, y + r);
    ctx.lineTo(x - r, y);
    ctx.closePath();
  } else if (form === "cross") {
    ctx.moveTo(x - r, y - r);
    ctx.lineTo(x + r, y + r);
    ctx.moveTo(x + r, y - r);
    ctx.lineTo(x - r, y + r);
  } else {
    ctx.moveTo(x - r, y);
    ctx.lineTo(x + r, y);
    ctx.moveTo(x, y - r);
    ctx.lineTo(x, y + r);
  }
  if (form !== "cross" && form !== "plus") ctx.fill();
  ctx.stroke();
}

const MARKER_PATHS = {
  circle: "M15 8a5 5 0 1 0 10 0a5 5 0 1 0-10 0",
  square: "M15 3h10v10h-10z",
  triangle: "M20 3l5 10h-10z",
  diamond: "M20 3l5 5l-5 5l-5-5z",
  cross: "M15 3l10 10M25 3l-10 10",
  plus: "M15 8h10M20 3v10",
};

/**
 * Return a legend: line, dash and marker of each run with its name.
 * @param {string[]} names
 * @returns {HTMLElement}
 */
export function legend(names) {
  return h(
    "ul",
    { class: "legend" },
    ...names.map((name, index) => {
      const at = index % MARKERS.length;
      return h(
        "li",
        {},
        s(
          "svg",
          { viewBox: "0 0 40 16", width: 40, height: 16, class: `line line-${at}`, "aria-hidden": "true" },
          s("path", { d: "M0 8H40", fill: "none", "stroke-dasharray": DASHES[at].join(" ") || null }),
          s("path", { d: MARKER_PATHS[MARKERS[at]] }),
        ),
        h("span", { text: name }),
      );
    }),
  );
}

/** A chart of points with bars of U. */
export class PointChart {
  /**
   * @param {{title: string, x: string, y: string, least?: number, height?: number, even?: number|null}} spec even: a
   *   level to mark (0 of differences, 1 of ratios)
   */
  constructor(spec) {
    this.spec = spec;
    /** @type {Run[]} */
    this.runs = [];
    /** @type {string[]|null} */
    this.names = null;
    this.canvas = h("div", {
      class: "canvas",
      role: "img",
      "aria-label": `${spec.title}; the table has its numbers`,
    });
    this.node = h("figure", { class: "chart" }, h("figcaption", {}, h("strong", { text: spec.title })), this.canvas);
    this.plot = null;
    this.watch = watchWidth(this.canvas, (width) => {
      if (!this.plot) this.#make(width);
      else if (width !== this.plot.width) this.plot.setSize({ width, height: this.plot.height });
    });
    this.theme = matchMedia("(prefers-color-scheme: dark)");
    this.again = () => this.plot?.redraw(false, true);
    this.theme.addEventListener("change", this.again);
  }

  /**
   * Draw runs.
   * @param {Run[]} runs
   */
  show(runs) {
    const texts = new Set();
    for (const run of runs) for (const point of run.points) if (typeof point.x === "string") texts.add(point.x);
    this.names = texts.size ? [...texts] : null;
    this.runs = runs.map((run) => ({
      ...run,
      points: run.points.map((point) => ({ ...point, x: this.#x(point.x) })),
    }));
    this.plot?.destroy();
    this.plot = null;
    if (this.canvas.clientWidth > 0) this.#make(this.canvas.clientWidth);
  }

  /** Give everything back. */
  end() {
    this.watch.disconnect();
    this.theme.removeEventListener("change", this.again);
    this.plot?.destroy();
    this.plot = null;
    this.node.remove();
  }

  #x(x) {
    return typeof x === "string" ? (this.names?.indexOf(x) ?? 0) : x;
  }

  #make(width) {
    const found = this.runs
      .flatMap((run) => run.points)
      .filter((point) => typeof point.y === "number" && Number.isFinite(point.x));
    const xs = found.map((point) => /** @type {number} */ (point.x));
    const lows = found.map((point) => point.y - (point.u ?? 0));
    const highs = found.map((point) => point.y + (point.u ?? 0));
    const even = this.spec.even;
    if (typeof even === "number") {
      lows.push(even);
      highs.push(even);
    }
    const x = found.length ? [Math.min(...xs), Math.max(...xs)] : [0, 1];
    const pad = Math.max((x[1] - x[0]) * 0.06, x[1] === x[0] ? Math.max(Math.abs(x[0]) * 0.05, 0.5) : 0);
    const y = range(Math.min(...lows), Math.max(...highs), this.spec.least ?? 0.05);
    const whole = this.spec.whole ? { incrs: [1, 2, 5, 10, 20, 50, 100] } : {};
    const across = this.names
      ? { splits: () => this.names.map((_name, index) => index), values: () => this.names, label: this.spec.x }
      : { values: (_plot, at) => at.map(short), label: this.spec.x, ...whole };
    this.plot = new uPlot(
      {
        width,
        height: Math.round((this.spec.height ?? 300) * scale()),
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: () => [x[0] - pad, x[1] + pad] }, y: { range: () => y } },
        axes: [
          axis({ ...across, space: 60 * scale(), size: 40 * scale(), labelSize: 22 * scale() }),
          axis({
            label: this.spec.y,
            size: 60 * scale(),
            labelSize: 20 * scale(),
            values: (_plot, at) => at.map(short),
          }),
        ],
        series: [{}, { paths: () => null, points: { show: false } }],
        hooks: { draw: [(plot) => this.#draw(plot)] },
      },
      [x, y],
      this.canvas,
    );
  }

  #draw(plot) {
    const { ctx, bbox } = plot;
    const px = devicePixelRatio * scale();
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    if (typeof this.spec.even === "number") {
      const level = plot.valToPos(this.spec.even, "y", true);
      ctx.strokeStyle = styled("--ink-2");
      ctx.lineWidth = px;
      ctx.beginPath();
      ctx.moveTo(bbox.left, level);
      ctx.lineTo(bbox.left + bbox.width, level);
      ctx.stroke();
    }
    const offset = this.spec.first ?? 0;
    this.runs.forEach((run, index) => this.#run(plot, run, index + offset, px));
    ctx.restore();
  }

  #run(plot, run, index, px) {
    const { ctx } = plot;
    const at = index % MARKERS.length;
    const shown = run.points.filter((point) => typeof point.y === "number" && Number.isFinite(point.x));
    // Beside each other, so that no run hides another.
    const aside = (index - (this.spec.first ?? 0) - (this.runs.length - 1) / 2) * DODGE * px;
    const spots = shown.map((point) => [
      plot.valToPos(point.x, "x", true) + (this.spec.whole ? 0 : aside),
      plot.valToPos(point.y, "y", true),
      point,
    ]);
    ctx.strokeStyle = series()[at];
    ctx.fillStyle = series()[at];
    const places = new Set(shown.map((point) => point.x));
    if (places.size === shown.length && shown.length > 1 && !this.names) {
      ctx.lineWidth = 1.5 * px;
      ctx.setLineDash(DASHES[at].map((part) => part * px));
      ctx.beginPath();
      [...spots].sort((a, b) => a[0] - b[0]).forEach(([x, y], n) => (n ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
      ctx.stroke();
      ctx.setLineDash([]);
    }
    ctx.lineWidth = 1.5 * px;
    for (const [x, y, point] of spots) {
      if (point.u) {
        const low = plot.valToPos(point.y - point.u, "y", true);
        const high = plot.valToPos(point.y + point.u, "y", true);
        ctx.beginPath();
        ctx.moveTo(x, low);
        ctx.lineTo(x, high);
        ctx.moveTo(x - 3 * px, low);
        ctx.lineTo(x + 3 * px, low);
        ctx.moveTo(x - 3 * px, high);
        ctx.lineTo(x + 3 * px, high);
        ctx.stroke();
      }
      marker(ctx, MARKERS[at], x, y, 4.5 * px);
    }
  }
}
