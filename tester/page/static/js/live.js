// Live: the coefficient as it grows, the machine with its values, trends, steps, events.

import { button, column, h, panel, put, say } from "./dom.js";
import { hms, inWords, local, muText, number, sign, spell, withU } from "./format.js";
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
        this.app.liveVersion,
      ]),
      () =>
        put(
          this.steps,
          stepList(state ? scene.plan : null, state?.progress ?? null, this.app.record?.conditions ?? []),
        ),
    );
    this.#once("events", `${scene.life} ${scene.events.at(-1)?.seq}`, () =>
      put(this.events, eventList(scene.events)),
    );
    if (changed.has("event") || changed.has("hello")) this.#ask();
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
    const found = running ? this.condition : null;
    say(
      this.mu,
      found && typeof found.mu === "number"
        ? `µ ${withU(found)}`
        : value && value.key === "friction"
          ? `µ ${number(value.value)}`
          : "µ –",
    );
    say(
      this.muNote,
      found && typeof found.mu === "number"
        ? `${sign(found.state)[0]} ${found.text}: ${sign(found.state)[1]}, ` +
            `${found.repeats} of ${found.asked} repeats. U: 95 %`
        : state
          ? "the momentary value; the condition has none yet"
          : "unknown",
    );
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
    const run = this.app.record;
    const found =
      run?.conditions.find((one) => one.state === "running") ??
      run?.conditions.filter((one) => typeof one.mu === "number").at(-1);
    if (!found) {
      this.condition = null;
      return;
    }
    const more = await this.app.quiet("condition", { run: run.run, n: found.n });
    const last = more?.so_far?.at(-1);
    const grown = { mu: last?.mu ?? more?.mu ?? null, u: last?.u ?? more?.u ?? null, mu_text: "", u_text: "" };
    const so = typeof found.mu === "number" ? found : grown;
    this.condition = { ...found, ...so, so_far: more?.so_far, list: more?.repeats ?? [] };
  }

  #growth() {
    const found = this.condition;
    const list = found?.list ?? [];
    this.#once("growth", JSON.stringify([found?.text, list, found?.so_far]), () => {
      if (!list.length) {
        this.growth.node.hidden = true;
        put(this.repeats, h("p", { class: "none", text: "No repeat is finished yet." }));
        return;
      }
      this.growth.node.hidden = false;
      const counted = list.filter(
        (one) => typeof one.mu === "number" && (one.state === "done" || one.state === "valid"),
      );
      let sum = 0;
      const mean =
        found.so_far?.map((one) => ({ x: one.n, y: one.mu, u: one.u })) ??
        counted.map((one, index) => ({ x: one.n, y: (sum += one.mu) / (index + 1), u: null }));
      if (!found.so_far && mean.length && typeof found.mu === "number")
        mean[mean.length - 1] = { ...mean.at(-1), y: found.mu, u: found.u };
      this.growth.show([
        { name: "mean so far", points: mean },
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
