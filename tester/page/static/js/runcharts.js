// Charts of a stored run's samples: zoom asks the page's process for the window again, so that no peak is hidden.

import { button, h, put, say } from "./dom.js";
import { hms, number } from "./format.js";
import { TimeChart, extremes } from "./chart.js";
import { gaps, plotted, windowOf } from "./samples.js";
import { Refusal } from "./link.js";

/** Charts of a run, one below the other on one axis; `span` draws a window. */
export class RunCharts {
  /**
   * @param {Object} app
   * @param {Object} run answer of the query `run`
   */
  constructor(app, run) {
    this.app = app;
    this.run = run;
    this.cursor = null;
    this.at = /** @type {[number, number]} */ ([run.t0_s, run.t1_s]);
    this.found = null;
    this.asked = 0;
    const known = new Map(run.columns.map((column) => [column.key, column]));
    this.plots = this.#plots(known);
    this.charts = this.plots.map(
      (plot, index) =>
        new TimeChart({
          title: known.get(plot.column).title,
          unit: known.get(plot.column).unit,
          decimals: 2,
          least: plot.least,
          labelled: index === 0,
          height: index === 0 ? 200 : 150,
          onzoom: (from, to) => this.span(from === null ? [run.t0_s, run.t1_s] : [from, to]),
        }),
    );
    this.note = h("p", { class: "small", role: "status" });
    this.numbers = h("tbody");
    const zoom = (factor) => {
      const [a, b] = this.at;
      const m = (a + b) / 2;
      const w = ((b - a) / 2) * factor;
      this.span([m - w, m + w]);
    };
    const shift = (share) => {
      const [a, b] = this.at;
      const d = (b - a) * share;
      this.span([a + d, b + d]);
    };
    this.node = h(
      "div",
      { class: "run-charts" },
      h(
        "div",
        { class: "choice", role: "group", "aria-label": "Window" },
        button("◀", () => shift(-0.5), { "aria-label": "Earlier" }),
        button("Zoom in", () => zoom(0.5)),
        button("Zoom out", () => zoom(2)),
        button("▶", () => shift(0.5), { "aria-label": "Later" }),
        button("Whole run", () => this.span([run.t0_s, run.t1_s])),
      ),
      this.note,
      h("div", { class: "charts" }, ...this.charts.map((chart) => chart.node)),
      h(
        "div",
        { class: "scrolls", tabindex: 0, role: "region", "aria-label": "Numbers of the window" },
        h(
          "table",
          {},
          h("caption", { text: "The window in numbers" }),
          h(
            "thead",
            {},
            h(
              "tr",
              {},
              ...["value", "least", "greatest", "last", "set point"].map((text) => h("th", { scope: "col", text })),
            ),
          ),
          this.numbers,
        ),
      ),
    );
  }

  #plots(known) {
    const machine = this.app.scene.machine;
    const own = plotted(machine, new Set(known.keys()));
    if (own.length) return own;
    return [...known.keys()]
      .filter((key) => !key.includes("_setpoint"))
      .slice(0, 4) // a run of another kind of rig
      .map((column) => ({ key: column, column, least: 0.01, setpoint: "" }));
  }

  /**
   * Draw a window.
   * @param {[number, number]} wanted rig seconds
   * @returns {Promise<void>}
   */
  async span(wanted) {
    const low = Math.max(wanted[0], this.run.t0_s);
    const high = Math.min(Math.max(wanted[1], low + 0.5), this.run.t1_s);
    this.at = [Math.min(low, high - 0.5), high];
    const asked = ++this.asked;
    try {
      const columns = this.plots.flatMap((plot) => [plot.column, plot.setpoint]).filter(Boolean);
      const found = await windowOf(
        this.app.link,
        this.run.run,
        columns,
        this.at,
        Math.min(this.node.clientWidth || 800, 2400),
      );
      if (asked !== this.asked) return; // a later window is asked for
      this.found = {
        t: found.t,
        y: Object.fromEntries(Object.entries(found.y).map(([key, values]) => [key, gaps(values)])),
      };
      say(
        this.note,
        `${hms(this.at[0])} to ${hms(this.at[1])} of rig time. Mark a range to zoom, double-click for the whole`,
      );
      this.draw();
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      say(this.note, `No samples: ${error.message}`);
    }
  }

  /**
   * Mark a moment.
   * @param {number|null} t_s
   */
  mark(t_s) {
    this.cursor = t_s;
    if (this.found) this.draw();
  }

  /** Draw what was found. */
  draw() {
    const { t, y } = this.found;
    const more = { regions: this.run.regions, marks: this.run.marks, cursor: this.cursor };
    this.plots.forEach((plot, index) =>
      this.charts[index].show(t, y[plot.column] ?? [], y[plot.setpoint] ?? null, this.at, more),
    );
    put(
      this.numbers,
      ...this.plots.map((plot) => {
        const { min, max, last } = extremes(t, y[plot.column] ?? [], this.at);
        const wanted = plot.setpoint ? extremes(t, y[plot.setpoint], this.at).last : null;
        const column = this.run.columns.find((one) => one.key === plot.column);
        return h(
          "tr",
          {},
          h("th", { scope: "row", text: `${column.title}${column.unit ? `, ${column.unit}` : ""}` }),
          ...[min, max, last, wanted].map((value) => h("td", { text: number(value, 2) })),
        );
      }),
    );
  }

  /** Give everything back. */
  end() {
    this.charts.forEach((chart) => chart.end());
    this.node.remove();
  }
}
