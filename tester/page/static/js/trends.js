// Trends of the run under way: measured values and their own set points as they were, on one axis in rig time.

import { button, h, put, say } from "./dom.js";
import { hms, number } from "./format.js";
import { TimeChart, extremes } from "./chart.js";
import { gaps, plotted, windowOf } from "./samples.js";
import { DRAWN, kindOf } from "./marks.js";
import { Refusal } from "./link.js";

/** Windows that can be chosen: name, rig seconds (Infinity: the whole run). */
export const WINDOWS = [
  ["1 min", 60],
  ["10 min", 600],
  ["1 h", 3600],
  ["8 h", 28800],
  ["whole run", Infinity],
];
/** How often stored samples are asked for again, ms. */
const AGAIN_MS = 5000;
/** Marks that are listed at once: alarms, holds and wheel changes first. */
const LISTED = 40;
/** Longest time between two rows without one missing, rig seconds; five times the usual one in a fast run. */
const GAP_S = 30;

/** The panel of trends. */
export class Trends {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.window = 600;
    this.stored = null;
    this.asked = -Infinity;
    this.busy = false;
    this.charts = new Map();
    this.machine = null;
    this.choice = h(
      "div",
      { class: "choice", role: "group", "aria-label": "Length of the trends" },
      ...WINDOWS.map(([name, span]) => button(name, () => this.#choose(span), { "data-span": span })),
    );
    this.place = h("div", { class: "charts" });
    this.numbers = h("tbody");
    this.marks = h("ul", { class: "marks" });
    this.note = h("p", { class: "small" });
    this.node = h(
      "section",
      { class: "panel trends", "aria-labelledby": "trends-title" },
      h("h2", { id: "trends-title", text: "Trends in rig time" }),
      this.choice,
      this.note,
      this.place,
      h(
        "div",
        { class: "scrolls", tabindex: 0, role: "region", "aria-label": "Numbers of the trends", "aria-live": "off" },
        h(
          "table",
          {},
          h("caption", { text: "The same in numbers" }),
          h(
            "thead",
            {},
            h(
              "tr",
              {},
              ...["", "now", "least", "greatest", "set point"].map((text) =>
                h("th", { scope: "col", text: text || "value" }),
              ),
            ),
          ),
          this.numbers,
        ),
      ),
      h("details", {}, h("summary", { text: "Marks on the axis" }), this.marks),
    );
    this.#choose(600);
  }

  #choose(span) {
    this.window = span;
    this.stored = null;
    this.asked = -Infinity;
    for (const one of this.choice.children)
      one.setAttribute("aria-pressed", String(Number(one.dataset.span) === span));
    if (this.machine) this.update();
  }

  /** Draw. */
  update() {
    const { scene, link } = this.app;
    if (scene.machine !== this.machine) this.#make(scene.machine);
    if (!link.connected || !scene.state) {
      this.#clear();
      return;
    }
    const rows = this.#rows();
    const now = scene.state.t_s;
    const from = this.window === Infinity ? (this.app.record?.t0_s ?? 0) : Math.max(now - this.window, 0);
    const span = /** @type {[number, number]} */ ([from, Math.max(now, from + 1)]);
    if (rows.length && rows[0][1] > from + 2 && this.app.record) this.#ask(span, now);
    const { regions, marks } = this.app.liveMarks();
    for (const [key, chart] of this.charts) this.#draw(key, chart, rows, span, { regions, marks });
    this.#numbers(span);
    this.#list(
      marks.concat(regions.map((region) => ({ t_s: region.from_s, kind: region.kind, text: region.text }))),
      span,
    );
  }

  #rows() {
    const now = this.app.scene.state.t_s;
    const rows = this.app.scene.trend;
    const spacing = rows.length > 1 ? rows.at(-1)[1] - rows.at(-2)[1] : 0;
    let first = rows.length; // back to another run, whose rig time began anew, or to where rows are missing
    while (first > 0 && rows[first - 1][1] !== null) {
      const after = (rows[first]?.[1] ?? now) - rows[first - 1][1];
      if (after < -1e-6 || (first < rows.length && after > Math.max(GAP_S, 5 * spacing))) break;
      first -= 1;
    }
    return rows.slice(first);
  }

  #make(machine) {
    this.machine = machine;
    for (const { chart } of this.charts.values()) chart.end();
    this.charts.clear();
    const labels = new Map((this.app.scene.state?.values ?? []).map((value) => [value.key, value]));
    plotted(machine, null).forEach((plot, index) => {
      const value = labels.get(plot.key);
      const chart = new TimeChart({
        title: value?.label ?? plot.key,
        unit: value?.unit ?? "",
        decimals: value?.decimals ?? 2,
        least: plot.least,
        labelled: index === 0,
        height: index === 0 ? 200 : 150,
      });
      this.charts.set(plot.key, { chart, plot, t: [], y: [], wanted: null });
      this.place.append(chart.node);
    });
  }

  #draw(key, held, rows, span, more) {
    const { plot, chart } = held;
    const column = this.machine.trend.indexOf(plot.column);
    const beside = plot.setpoint ? this.machine.trend.indexOf(plot.setpoint) : -1;
    const start = rows.length ? rows[0][1] : Infinity;
    const t = [];
    const y = [];
    const wanted = [];
    const old = this.stored?.y[plot.column];
    if (old) {
      const set = this.stored.y[plot.setpoint];
      for (let index = 0; index < this.stored.t.length && this.stored.t[index] < start; index += 1) {
        t.push(this.stored.t[index]);
        y.push(Number.isFinite(old[index]) ? old[index] : null);
        wanted.push(set && Number.isFinite(set[index]) ? set[index] : null);
      }
    }
    for (const row of rows) {
      if (row[1] < span[0] - 1) continue;
      t.push(row[1]);
      y.push(row[column]);
      wanted.push(beside < 0 ? null : row[beside]);
    }
    Object.assign(held, { t, y, wanted: beside < 0 ? null : wanted });
    chart.show(t, y, held.wanted, span, more);
  }

  async #ask(span, now) {
    if (this.busy || performance.now() - this.asked < AGAIN_MS) return;
    this.busy = true;
    this.asked = performance.now();
    const known = new Set(this.app.record.columns.map((column) => column.key));
    const columns = plotted(this.machine, known)
      .flatMap((plot) => [plot.column, plot.setpoint])
      .filter(Boolean);
    try {
      const found = await windowOf(
        this.app.link,
        this.app.record.run,
        columns,
        [span[0], now],
        Math.min(this.place.clientWidth || 800, 2400),
      );
      this.stored = {
        t: found.t,
        y: Object.fromEntries(Object.entries(found.y).map(([key, values]) => [key, gaps(values)])),
      };
      say(this.note, "");
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      say(this.note, `Only what this page has seen itself: ${error.message}`);
    } finally {
      this.busy = false;
    }
  }

  #clear() {
    for (const { chart } of this.charts.values()) chart.show([], [], null, [0, 60]);
    put(this.numbers);
  }

  #numbers(span) {
    const values = new Map(this.app.scene.state.values.map((value) => [value.key, value]));
    put(
      this.numbers,
      ...[...this.charts.values()].map(({ plot, t, y }) => {
        const value = values.get(plot.key);
        const decimals = value?.decimals ?? 2;
        const { min, max } = extremes(t, y, span);
        const cells = [
          number(value?.value, decimals),
          number(min, decimals),
          number(max, decimals),
          number(value?.setpoint, decimals),
        ];
        return h(
          "tr",
          {},
          h("th", { scope: "row", text: `${value?.label ?? plot.key}${value?.unit ? `, ${value.unit}` : ""}` }),
          ...cells.map((text) => h("td", { text })),
        );
      }),
    );
  }

  #list(marks, span) {
    const within = marks.filter((mark) => mark.t_s >= span[0] && mark.t_s <= span[1]).sort((a, b) => b.t_s - a.t_s);
    const first = within.filter((mark) => DRAWN.has(mark.kind)).slice(0, LISTED);
    const inside = first.concat(within.filter((mark) => !DRAWN.has(mark.kind)).slice(0, LISTED - first.length));
    const text = inside.map(
      (mark) => `${hms(mark.t_s)}  ${kindOf(mark.kind).sign} ${kindOf(mark.kind).word}: ${mark.text}`,
    );
    if (text.join() === this.listed) return;
    this.listed = text.join();
    put(
      this.marks,
      ...(text.length ? text.map((line) => h("li", { text: line })) : [h("li", { text: "none in this window" })]),
    );
  }
}
