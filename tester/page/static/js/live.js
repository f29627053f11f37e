// Live: the coefficient as it grows, the machine with its values, trends, steps, events.

import { button, column, h, panel, put, say } from "./dom.js";
import { hms, inWords, local, muText, number, sign, spell } from "./format.js";
import { RigDrawing } from "./drawing.js";
import { eventList, stepList } from "./steps.js";
import { Trends } from "./trends.js";
import { PointChart, legend } from "./points.js";

/** The live view. */
export class Live {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.title = "Live";
    this.drawing = new RigDrawing();
    this.trends = new Trends(app);
    this.mu = h("p", { class: "mu" });
    this.muNote = h("p", { class: "small" });
    this.about = h("dl", { class: "about-run" });
    this.share = h("progress", { max: 1, value: 0, "aria-label": "Share of the run's rig time that is done" });
    this.buttons = h("p", { class: "buttons hand" });
    this.growth = new PointChart({
      title: "Repeats of this condition, their mean and its U",
      x: "repeat",
      y: "coefficient",
      height: 220,
      least: 0.02,
      whole: true,
    });
    this.repeats = h("div");
    this.steps = h("div");
    this.events = h("div");
    this.condition = null;
    this.shown = { growth: "", steps: "", events: "", buttons: "" };
    this.node = h(
      "div",
      { class: "live" },
      column(
        "a",
        panel("Coefficient", "now", this.mu, this.muNote, this.about, this.share, this.buttons),
        panel("Machine", "rig", this.drawing.node),
        panel("This condition", "growth", this.growth.node, this.repeats),
      ),
      column("b", this.trends.node),
      column("c", panel("Steps", "plan", this.steps), panel("Events", "log", this.events)),
    );
  }

  /**
   * Draw what has changed.
   * @param {Set<string>} changed types of messages since the last time
   */
  update(changed) {
    const { scene, link } = this.app;
    const state = link.connected ? scene.state : null;
    this.drawing.update(scene.machine, state?.values ?? []);
    this.#now(state);
    this.#hand(state);
    this.trends.update();
    this.#growth();
    this.#once(
      "steps",
      JSON.stringify([
        scene.plan?.first,
        scene.plan?.steps,
        Math.round((state?.progress.step_left_s ?? 0) / 5),
        scene.given,
      ]),
      () =>
        put(
          this.steps,
          stepList(state ? scene.plan : null, state?.progress ?? null, scene.given),
        ),
    );
    this.#once("events", `${scene.life} ${scene.events.at(-1)?.seq}`, () =>
      put(this.events, eventList(scene.events)),
    );
    if (changed.has("event") || changed.has("hello") || changed.has("live")) this.#ask();
  }

  #once(name, key, draw) {
    if (this.shown[name] === key) return;
    this.shown[name] = key;
    draw();
  }

  #now(state) {
    const at = state?.progress;
    const value = state?.values.find((one) => one.key === this.app.scene.machine.plots[0]?.key) ?? null;
    const running = state?.run && state.run.exit === null;
    const [mu, words] = this.#value(running, value);
    say(this.mu, `µ ${mu}`);
    say(this.muNote, state ? words : "unknown");
    const lines = !state
      ? [["State", this.app.link.trouble]]
      : [
          ["State", inWords(state.mode) + (state.mode_text ? `: ${state.mode_text}` : "")],
          ...(state.run
            ? [["Recipe", state.run.recipe + (state.run.compound ? `, ${state.run.compound}` : "")]]
            : []),
          ...(running && at.title
            ? [
                ["Step", `${at.title}${at.phase ? `, ${at.phase}` : ""}`],
                [
                  "Repeat",
                  at.repeat
                    ? `${at.repeat} of ${at.repeats}, ` +
                      `${number(at.revolutions, 0)} of ${number(at.revolutions_wanted, 0)} rev`
                    : "–",
                ],
                [
                  "Rig time",
                  `${hms(at.elapsed_s)}, ${at.left_s === null ? "end unknown" : `${spell(at.left_s)} left`}`,
                ],
                ["Ends", at.finish_utc ? local(at.finish_utc) : "as fast as possible"],
              ]
            : state.run
              ? [["Last run", `${state.run.outcome}${state.run.reason ? `: ${state.run.reason}` : ""}`]]
              : []),
          ...(running && state.run.operator ? [["Operator", state.run.operator]] : []),
          ["In control", state.clients.controller || "none"],
        ];
    this.#once("about", JSON.stringify(lines), () =>
      put(this.about, ...lines.flatMap(([name, text]) => [h("dt", { text: name }), h("dd", { text })])),
    );
    this.share.hidden = !running;
    this.share.value = at?.share ?? 0;
  }

  /**
   * Return the coefficient and where it comes from: the condition as it grows, else the last that has ended, else the
   * momentary value.
   */
  #value(running, value) {
    const given = running ? this.app.scene.given : null;
    const growing = given?.growing;
    if (growing) {
      const last = growing.grown.at(-1);
      const repeat = growing.open
        ? `repeat ${growing.open.repeat} so far: ${number(growing.open.mu)} over ${growing.open.revolutions} rev`
        : "";
      if (last)
        return [
          last.text,
          `${growing.words}: after ${last.repeats} of ${growing.asked} repeats. U: 95 %${repeat ? `; ${repeat}` : ""}`,
        ];
      if (repeat) return [number(growing.open.mu), `${growing.words}: ${repeat}; no U yet`];
    }
    const over = given?.conditions.filter((one) => one.over && one.mu !== null).at(-1);
    if (over && !growing) return [over.text, `the last condition's. U: 95 %`];
    return [
      value?.key === "friction" ? number(value.value) : number(null),
      "the momentary value; the condition has none yet",
    ];
  }

  #hand(state) {
    const { orders, link, scene } = this.app;
    const holder = state?.clients.controller ?? "";
    const other = holder !== "" && !holder.endsWith(`: ${link.name}`); // a page controls under its own name
    const key = `${link.role} ${state?.mode} ${other}`;
    this.#once("buttons", key, () => {
      if (link.role !== "control" || !state) {
        put(this.buttons);
        return;
      }
      put(
        this.buttons,
        state.mode === "RUN"
          ? button("HOLD", () => orders.send({ command: "hold" }, "Held: lifted, slip zero, heat held"), {
              class: "main",
            })
          : null,
        state.mode === "HOLD"
          ? button("Go on", () => orders.send({ command: "release" }, "Goes on; the repeat is done again"), {
              class: "main",
            })
          : null,
        other
          ? button("Take control (needs a code)", () =>
              orders.send({ command: "control", take: true, force: true }, "This page is in control"),
            )
          : null,
      );
    });
  }

  async #ask() {
    const growing = this.app.scene.given?.growing;
    const n = growing?.condition ?? this.app.scene.given?.conditions.filter((one) => one.over).at(-1)?.condition;
    if (!n || !this.app.record) {
      this.condition = null;
      return;
    }
    const more = await this.app.quiet("condition", { run: this.app.record.run, n });
    if (more) this.condition = { n, repeats: more.repeats };
  }

  #growth() {
    const given = this.app.scene.given;
    const grown = given?.growing?.condition === this.condition?.n ? (given?.growing?.grown ?? []) : [];
    const list = this.condition?.repeats ?? [];
    this.#once("growth", JSON.stringify([this.condition?.n, list, grown]), () => {
      this.growth.node.hidden = !list.length;
      if (!list.length) {
        put(this.repeats, h("p", { class: "none", text: "No repeat is finished yet." }));
        return;
      }
      this.growth.show([
        { name: "mean so far", points: grown.map((one) => ({ x: one.repeats, y: one.mu, u: one.u })) },
        { name: "repeats", points: list.map((one) => ({ x: one.n, y: one.mu, u: null })) },
      ]);
      put(
        this.repeats,
        legend(["mean so far, with U", "each repeat"]),
        h(
          "ul",
          { class: "plain" },
          ...list.map((one) =>
            h(
              "li",
              {},
              `${sign(one.state)[0]} repeat ${one.n}: ${muText(one)}${one.reason ? `, ${one.reason}` : ""}`,
            ),
          ),
        ),
      );
    });
  }
}
