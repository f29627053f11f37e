// One condition: its repeats with what each gave, its samples, exclusion with a reason.

import { button, h, put, say, table } from "./dom.js";
import { hms, muText, sign, uText, withU } from "./format.js";
import { askReason } from "./codes.js";
import { RunCharts } from "./runcharts.js";

/**
 * Return a condition's doubt or reason; one that is still to be measured needs none.
 * @param {{state: string, doubt: string, reason: string}} one
 * @returns {string}
 */
export function why(one) {
  return one.state === "planned" || one.state === "running" ? "" : one.doubt || one.reason || "";
}

/** A panel that opens a condition of a run. */
export class ConditionPanel {
  /**
   * @param {Object} app
   * @param {() => void} changed called after an exclusion
   */
  constructor(app, changed) {
    this.app = app;
    this.changed = changed;
    this.head = h("h2", { tabindex: -1 });
    this.body = h("div");
    this.node = h(
      "section",
      { class: "panel condition", "aria-label": "Condition", hidden: true },
      this.head,
      this.body,
    );
    this.charts = null;
  }

  /** Close it. */
  close() {
    this.node.hidden = true;
    this.charts?.end();
    this.charts = null;
    put(this.body);
  }

  /**
   * Open a condition.
   * @param {Object} run answer of the query `run`
   * @param {number} n its number
   */
  async open(run, n) {
    const found = run.conditions.find((one) => one.n === n);
    const answer = await this.app.orders.ask("condition", { run: run.run, n });
    if (!found || !answer) return;
    this.close();
    this.node.hidden = false;
    say(this.head, `Condition ${n}: ${found.text}`);
    const may = this.app.link.role === "control";
    const rows = answer.repeats.map((one) => [
      String(one.n),
      muText(one),
      uText(one),
      `${sign(one.state)[0]} ${sign(one.state)[1]}`,
      one.reason ?? "",
      hms(one.from_s),
      h(
        "span",
        { class: "buttons" },
        button("Samples", () => this.#samples(run, one), { "aria-label": `Samples of repeat ${one.n}` }),
        may ? this.#exclude(run, n, one.n, one.state === "excluded") : null,
      ),
    ]);
    this.charts = new RunCharts(this.app, run);
    put(
      this.body,
      h(
        "p",
        {},
        h("strong", { class: "gave", text: withU(found) }),
        ` ${sign(found.state).join(" ")}, ${found.repeats} of ${found.asked} repeats. U: expanded, 95 %`,
      ),
      why(found) ? h("p", { class: "wants-text", text: `${sign(found.state)[0]} ${why(found)}` }) : null,
      answer.repeats.length > 0 &&
        table("Repeats", ["repeat", "µ", "U", "state", "reason", "rig time", "open"], rows, "cards"),
      h(
        "p",
        { class: "buttons" },
        may ? this.#exclude(run, n, 0, found.state === "excluded") : null,
        button("Close", () => this.close()),
      ),
      answer.repeats.length ? this.charts.node : h("p", { class: "none", text: "No repeat has been measured yet." }),
    );
    this.head.focus();
    const first = answer.repeats.find((one) => typeof one.from_s === "number");
    if (first) await this.#samples(run, first, answer.repeats.at(-1));
  }

  #samples(run, one, last = one) {
    const from = one.from_s;
    const to = last.to_s ?? from + 60;
    const pad = 0.03 * Math.max(to - from, 10);
    return this.charts?.span([Math.max(from - pad, run.t0_s), Math.min(to + pad, run.t1_s)]);
  }

  #exclude(run, n, repeat, excluded) {
    const what = repeat ? `repeat ${repeat}` : "the whole condition";
    const verb = excluded ? "Include" : "Exclude";
    return button(
      repeat ? verb : `${verb} ${what}`,
      async () => {
        const reason = await askReason(`${verb} ${what} of condition ${n}`, verb);
        if (!reason) return;
        const done = await this.app.orders.ask(
          "exclude",
          { run: run.run, n, repeat, reason, ...(excluded ? { include: true } : {}) },
          `${verb}d on record: ${what}`,
        );
        if (done) {
          this.changed();
          const again = await this.app.orders.ask("run", { run: run.run });
          if (again) await this.open(again, n);
        }
      },
      { "aria-label": `${verb} ${what}` },
    );
  }
}
