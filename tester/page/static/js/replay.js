// Replay: a stored run as Live shows it, from its record, with a slider. It has no STOP of its own: nothing here moves.

import { button, column, field, h, panel, put, say, select } from "./dom.js";
import { hms, newestFirst, withU, sign } from "./format.js";
import { RigDrawing } from "./drawing.js";
import { eventList, stepList } from "./steps.js";
import { RunCharts } from "./runcharts.js";

const SPEEDS = [
  ["1", "1 ×"],
  ["10", "10 ×"],
  ["60", "60 ×"],
  ["600", "600 ×"],
];
/** How often a moment is asked for while it plays, ms. */
const EVERY_MS = 250;
/** Steps that are listed before and after the present one. */
const AROUND = 8;

/** The replay view. */
export class Replay {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.title = "Replay";
    this.run = null;
    this.t_s = 0;
    this.speed = 60;
    this.timer = 0;
    this.busy = false;
    this.moved = false;
    this.choice = h("div", { class: "fields" });
    this.slider = /** @type {HTMLInputElement} */ (
      h("input", {
        type: "range",
        min: 0,
        max: 1,
        step: 1,
        value: 0,
        class: "slider",
        "aria-label": "Rig time of the stored run",
        oninput: () => {
          this.moved = true;
          this.to(Number(this.slider.value));
        },
      })
    );
    this.clock = h("output", { class: "clock" });
    this.play = button("Play", () => this.#toggle(), { class: "main" });
    this.about = h("p", { class: "recorded", text: "A record, not the machine." });
    this.drawing = new RigDrawing();
    this.now = h("div");
    this.steps = h("div");
    this.events = h("div");
    this.place = h("div");
    this.charts = null;
    this.node = h(
      "div",
      { class: "live replay" },
      column(
        "a",
        panel(
          "Replay",
          "now",
          this.about,
          this.choice,
          h("div", { class: "player" }, this.play, this.slider, this.clock),
          this.now,
        ),
        panel("Machine as recorded", "rig", this.drawing.node),
      ),
      column("b", panel("Trends in rig time", "trends", this.place)),
      column("c", panel("Steps", "plan", this.steps), panel("Events", "log", this.events)),
    );
  }

  /** Show the run that was chosen last, else the newest. */
  async open() {
    const { runs } = (await this.app.orders.ask("runs", {})) ?? { runs: [] };
    this.names = newestFirst(runs);
    const wanted = this.app.chosen ?? this.names[0];
    if (!wanted) {
      say(this.about, "No stored run yet.");
      return;
    }
    if (this.run?.run !== wanted) await this.load(wanted);
  }

  /** Leave: nothing plays unseen. */
  close() {
    this.#pause();
  }

  /**
   * Load a run.
   * @param {string} name
   */
  async load(name) {
    this.#pause();
    const run = await this.app.orders.ask("run", { run: name });
    if (!run) return;
    this.app.chosen = name;
    this.run = run;
    this.charts?.end();
    this.charts = new RunCharts(this.app, run);
    put(this.place, this.charts.node);
    put(
      this.choice,
      field(
        "Run",
        select(
          [...new Set([name, ...this.names])].map((one) => [one, one]),
          name,
          (value) => this.load(value),
        ),
      ),
      field(
        "Speed",
        select(SPEEDS, String(this.speed), (value) => {
          this.speed = Number(value);
        }),
      ),
    );
    say(this.about, `A record, not the machine: ${run.recipe}${run.simulated ? ", simulated rig" : ""}`);
    Object.assign(this.slider, { min: String(Math.floor(run.t0_s)), max: String(Math.ceil(run.t1_s)) });
    this.moved = false;
    await this.charts.span([run.t0_s, run.t1_s]);
    const first = run.regions.find((region) => region.kind === "repeat");
    if (this.moved) return; // a person was quicker than the samples
    await this.to(first ? (first.from_s + (first.to_s ?? first.from_s)) / 2 : run.t0_s);
  }

  /**
   * Go to a moment.
   * @param {number} t_s rig seconds
   */
  async to(t_s) {
    if (!this.run) return;
    this.t_s = Math.min(Math.max(t_s, this.run.t0_s), this.run.t1_s);
    this.slider.value = String(this.t_s);
    this.slider.setAttribute("aria-valuetext", hms(this.t_s));
    say(this.clock, `${hms(this.t_s)} of ${hms(this.run.t1_s)}`);
    this.charts?.mark(this.t_s);
    if (this.busy) return; // the newest moment is asked for once the answer is there
    this.busy = true;
    const asked = this.t_s;
    const moment = await this.app.quiet("moment", { run: this.run.run, t_s: asked });
    this.busy = false;
    if (moment) this.#show(moment);
    if (asked !== this.t_s && !this.timer) await this.to(this.t_s);
  }

  #show(moment) {
    const values = moment.values.map((one) => ({ decimals: 2, quality: "good", ...one }));
    this.drawing.update(this.app.scene.machine, values);
    const done = this.run.conditions.filter((one) => typeof one.mu === "number");
    const past = new Set(
      this.run.marks.filter((mark) => mark.t_s <= this.t_s && mark.kind === "condition").map((mark) => mark.text),
    );
    const last = done[Math.min(past.size, done.length) - 1];
    put(
      this.now,
      h("p", {}, h("strong", { text: moment.step || "–" })),
      last
        ? h("p", {
            text: `last value: ${last.text}: ${withU(last)} ${sign(last.state)[0]} ${sign(last.state)[1]}`,
          })
        : null,
    );
    put(
      this.steps,
      moment.plan ? stepList(moment.plan, moment.progress ?? null, this.run.conditions) : this.#list(moment.step),
    );
    put(
      this.events,
      eventList(moment.events?.length ? moment.events : this.run.marks.filter((mark) => mark.t_s <= this.t_s)),
    );
  }

  #list(now) {
    const { plan, conditions } = this.run;
    const at = Math.max(
      plan.findIndex((step) => step.text === now),
      0,
    );
    const gave = new Map(conditions.filter((one) => typeof one.mu === "number").map((one) => [one.text, one]));
    const row = (step, index) => {
      const state = index === at ? "now" : index < at ? "done" : "later";
      const found = index < at ? gave.get(step.text) : null;
      return h(
        "li",
        { class: `step ${state}`, "aria-current": index === at ? "step" : null },
        h("span", { class: "sign", "aria-hidden": "true", text: { now: "▶", done: "✓", later: "·" }[state] }),
        h("span", { class: "what" }, `${step.n}  ${step.text}`),
        found ? h("strong", { class: "gave", text: withU(found) }) : null,
      );
    };
    const [from, to] = [Math.max(at - AROUND, 0), Math.min(at + AROUND + 1, plan.length)];
    const list = h("ol", { class: "steps" });
    put(
      list,
      from ? h("li", { class: "step more", text: `${from} earlier steps` }) : null,
      ...plan.slice(from, to).map((step, index) => row(step, from + index)),
      to < plan.length ? h("li", { class: "step more", text: `${plan.length - to} later steps` }) : null,
    );
    return list;
  }

  #toggle() {
    if (this.timer) {
      this.#pause();
      return;
    }
    if (!this.run) return;
    if (this.t_s >= this.run.t1_s) this.t_s = this.run.t0_s;
    say(this.play, "Pause");
    this.timer = window.setInterval(() => {
      if (this.t_s >= this.run.t1_s) this.#pause();
      else this.to(this.t_s + (this.speed * EVERY_MS) / 1000);
    }, EVERY_MS);
  }

  #pause() {
    clearInterval(this.timer);
    this.timer = 0;
    say(this.play, "Play");
  }
}
