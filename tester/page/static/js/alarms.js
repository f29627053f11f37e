// Alarms and the open question, before everything else. A new alarm is announced once (role=alert).

import { button, h, put, say } from "./dom.js";
import { local, number } from "./format.js";
import { firstAlarm } from "./bar.js";

const STATES = { active: "present", acknowledged: "acknowledged, present", returned: "gone, not acknowledged" };

/** The panel of alarms, the question and the interrupted run. */
export class Alarms {
  /** @param {Object} app */
  constructor(app) {
    this.app = app;
    this.list = h("div", { class: "alarm-list" });
    this.alert = h("p", { class: "unseen", role: "alert" });
    this.node = h("section", { class: "alarms", "aria-label": "Alarms and questions" }, this.alert, this.list);
    this.known = new Set();
    this.shown = "";
  }

  /** Draw. */
  update() {
    const { scene, link } = this.app;
    const state = link.connected ? scene.state : null;
    const alarms = state?.alarms ?? [];
    const fresh = alarms.filter((alarm) => !this.known.has(this.#key(alarm)));
    if (fresh.length) say(this.alert, `Alarm: ${firstAlarm(fresh).text}`);
    this.known = new Set(alarms.map((alarm) => this.#key(alarm)));
    if (!alarms.length) say(this.alert, "");
    const shape = JSON.stringify([
      alarms,
      state?.prompt,
      state?.interrupted,
      state?.mode === "INTERRUPTED",
      link.role,
      state?.risk,
    ]);
    if (shape === this.shown) return;
    this.shown = shape;
    put(
      this.list,
      ...this.#sorted(alarms).map((alarm) => this.#alarm(alarm)),
      this.#prompt(state?.prompt),
      state?.mode === "INTERRUPTED" ? this.#interrupted(state.interrupted) : null,
      state?.risk
        ? h("p", {
            class: "card wants",
            text: `Safety keys of the rig file that are looser than they should be: ${state.risk}`,
          })
        : null,
    );
    this.node.classList.toggle("empty", !this.list.childElementCount);
  }

  #key(alarm) {
    return `${alarm.number} ${alarm.utc}`;
  }

  #sorted(alarms) {
    const first = firstAlarm(alarms);
    return first ? [first, ...alarms.filter((alarm) => alarm !== first)] : [];
  }

  #alarm(alarm) {
    const numbers =
      alarm.value === null
        ? ""
        : ` ${number(alarm.value, 1)} ${alarm.unit}` +
          (alarm.limit === null ? "" : ` (limit ${number(alarm.limit, 1)} ${alarm.unit})`);
    const open = alarm.state !== "acknowledged" && this.app.link.role === "control";
    const ack = () => this.app.orders.send({ command: "ack", number: alarm.number }, "Acknowledged. Nothing moves");
    return h(
      "article",
      { class: `card ${alarm.priority === 3 ? "wants" : "alarm"}` },
      h(
        "h3",
        {},
        h("span", { class: "sign", "aria-hidden": "true", text: alarm.priority === 3 ? "△" : "▲" }),
        ` ${alarm.name.replaceAll("_", " ")}`,
      ),
      h("p", { text: alarm.text + numbers }),
      h("p", {
        class: "small",
        text:
          `${STATES[alarm.state] ?? alarm.state}${alarm.first_up ? ", first" : ""}, ` +
          `${local(alarm.utc)}. ${alarm.consequence}`,
      }),
      open ? h("p", { class: "buttons" }, button("Acknowledge (needs a code)", ack)) : null,
    );
  }

  #prompt(prompt) {
    if (!prompt) return null;
    return h(
      "article",
      { class: "card wants" },
      h("h3", { text: "? A person is needed at the machine" }),
      h("p", { text: prompt.text }),
      h("p", {
        class: "small",
        text:
          `asked ${local(prompt.utc)}. Answer it at the machine's terminal (tester tui): ` +
          "this page does not see the machine.",
      }),
    );
  }

  #interrupted(runs) {
    const { orders, link } = this.app;
    return h(
      "article",
      { class: "card wants" },
      h("h3", { text: "A run was cut off" }),
      h(
        "ul",
        {},
        ...runs.map((run) =>
          h(
            "li",
            {},
            h("span", { text: run }),
            " ",
            link.role === "control"
              ? button("Resume (needs a code)", () => orders.send({ command: "resume", run }, "The run goes on"), {
                  "aria-label": `Resume ${run} (needs a code)`,
                })
              : null,
          ),
        ),
      ),
    );
  }
}
