// Up to six runs over each other against any axis, with their difference and their ratio to the first.

import { field, h, put, say, select, table } from "./dom.js";
import { axisText, number, short } from "./format.js";
import { PointChart, legend } from "./points.js";

/** How many runs may be overlaid: so many colours, dashes and markers there are. */
export const MOST = 6;
const ALIGNED = [
  ["repeat", "repeat number"],
  ["time", "rig time"],
  ["sliding", "sliding distance"],
];

/** The overlay of chosen runs. */
export class Overlay {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.runs = [];
    this.axes = [];
    this.against = "";
    this.only = "";
    this.head = h("h2", { tabindex: -1, text: "Runs laid over each other" });
    this.choice = h("div", { class: "fields" });
    this.note = h("p", { class: "small", role: "status" });
    this.place = h("div");
    this.charts = [];
    this.node = h(
      "section",
      { class: "panel overlay", "aria-label": "Runs laid over each other", hidden: true },
      this.head,
      this.choice,
      this.note,
      this.place,
    );
  }

  /**
   * Lay runs over each other.
   * @param {string[]} runs at most six
   */
  async open(runs) {
    this.runs = runs.slice(0, MOST);
    this.node.hidden = this.runs.length === 0;
    if (!this.runs.length) return;
    const first = await this.app.orders.ask("run", { run: this.runs[0] });
    if (!first) return;
    this.axes = first.axes.map((axis) => [axis.key, axisText(axis)]).concat(ALIGNED);
    const spread = (key) => new Set(first.conditions.map((one) => one.axes[key])).size;
    if (!this.axes.some(([key]) => key === this.against))
      this.against = first.axes.reduce(
        (best, axis) => (spread(axis.key) > spread(best) && axis.key !== "compound" ? axis.key : best),
        first.axes[0].key,
      );
    const only = h("input", {
      type: "search",
      maxlength: 200,
      placeholder: "1#, 200 N",
      set: { value: this.only },
      onchange: () => {
        this.only = only.value;
        this.#paint();
      },
    });
    put(
      this.choice,
      field(
        "Against",
        select(this.axes, this.against, (value) => {
          this.against = value;
          this.draw();
        }),
      ),
      field("Only conditions with", only),
    );
    await this.draw();
    this.head.focus();
  }

  /** Ask and draw. */
  async draw() {
    this.found = await this.app.orders.ask("overlay", { runs: this.runs, against: this.against });
    if (this.found) this.#paint();
  }

  /** The answer with only those conditions whose words are asked for. */
  #filtered() {
    const words = this.only.split(",").map((word) => word.trim().toLowerCase());
    const fits = (point) => {
      const parts = (point.label ?? "")
        .toLowerCase()
        .split(",")
        .map((part) => part.trim());
      return words.every((word) => !word || parts.includes(word));
    };
    const part = (list) => (list ?? []).map((run) => ({ ...run, points: run.points.filter(fits) }));
    return { runs: part(this.found.runs), difference: part(this.found.difference), ratio: part(this.found.ratio) };
  }

  #paint() {
    const found = this.#filtered();
    this.charts.forEach((chart) => chart.end());
    this.charts = [];
    const title = (this.axes.find(([key]) => key === this.against) ?? ["", this.against])[1];
    const names = found.runs.map((run) => run.run);
    const main = this.#chart(
      { title: "Coefficient with U (95 %)", x: title, y: "µ", height: 340 },
      found.runs.map((run) => ({
        name: run.run,
        points: run.points.map((point) => ({ x: point.x, y: point.mu, u: point.u, label: point.label })),
      })),
    );
    put(this.place, legend(names), main.node);
    const rest = names.slice(1);
    if (rest.length) {
      const difference = this.#chart(
        { title: `Difference to ${names[0]}`, x: title, y: "µ − µ₁", even: 0, first: 1, height: 260 },
        beside(found.difference),
      );
      const ratio = this.#chart(
        { title: `Ratio to ${names[0]}`, x: title, y: "µ / µ₁", even: 1, first: 1, height: 260 },
        beside(found.ratio),
      );
      this.place.append(h("div", { class: "pair" }, difference.node, ratio.node));
    }
    const numbers = h("div");
    const details = h("details", {}, h("summary", { text: "The same in numbers" }), numbers);
    details.addEventListener("toggle", () => {
      if (!numbers.childElementCount) put(numbers, ...tables(found, title)); // 165 rows a run: only where they are read
    });
    this.place.append(details);
    const count = found.runs.flatMap((run) => run.points).filter((point) => typeof point.mu === "number").length;
    say(
      this.note,
      `${names.length} runs, ${count} coefficients. ` +
        `Each run has a colour, a dash and a marker of its own; bars are U. ${this.found.how ?? ""}`,
    );
  }

  #chart(spec, runs) {
    const chart = new PointChart(spec);
    this.charts.push(chart);
    chart.show(runs);
    return chart;
  }
}

function beside(list) {
  return (list ?? []).map((run) => ({ name: run.run, points: run.points }));
}

function tables(found, title) {
  const rows = found.runs.flatMap((run) =>
    run.points.map((point) => [run.run, short(point.x), number(point.mu), number(point.u), point.label ?? ""]),
  );
  const pairs = found.difference.flatMap((run, index) =>
    run.points.map((point, at) => {
      const other = found.ratio[index]?.points[at];
      return [run.run, short(point.x), number(point.y), number(point.u), number(other?.y), number(other?.u)];
    }),
  );
  return [
    table("Coefficients of the runs", ["run", title, "µ", "U", "condition"], rows, "cards"),
    pairs.length
      ? table("Difference and ratio", ["run", title, "difference", "U", "ratio", "U of the ratio"], pairs, "cards")
      : null,
  ];
}
