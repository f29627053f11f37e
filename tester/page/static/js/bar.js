// The bar at the top: whose machine, what it does, the first alarm, and STOP alone at its right.

import { button, h, put, say } from "./dom.js";
import { inWords, local, spell } from "./format.js";
import { Refusal } from "./link.js";

const MAY_STOP = new Set(["stop", "control"]);
const LOOKS = "this device only looks: use the machine's stop";

/** The bar. STOP is there only while it can arrive. */
export class Bar {
  /**
   * @param {import("./link.js").Link} link
   * @param {import("./scene.js").Scene} scene
   */
  constructor(link, scene) {
    this.link = link;
    this.scene = scene;
    this.machine = h("strong", { class: "machine" });
    this.mode = h("span", { class: "mode" });
    this.done = h("span", { class: "done" });
    this.first = h("span", { class: "first" });
    this.place = h("div", { class: "stop-place" });
    this.told = h("span", { class: "stop-told", role: "status" });
    this.node = h(
      "header",
      { class: "bar" },
      h("div", { class: "about" }, h("div", { class: "line" }, this.machine, this.mode, this.done), this.first),
      h("div", { class: "stop-cell" }, this.place, this.told),
    );
    this.shape = "";
    this.press = 0;
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey && event.shiftKey && event.code === "KeyX") {
        event.preventDefault();
        this.stop();
      }
    });
    this.update();
  }

  /** Draw what the scene and the connection are. */
  update() {
    const { state } = this.scene;
    const live = this.link.connected && state;
    say(
      this.machine,
      state
        ? state.rig + (state.simulated && !state.rig.includes("simulated") ? " (simulated)" : "")
        : "friction-tester",
    );
    say(this.mode, live ? inWords(state.mode) : "no connection");
    this.node.classList.toggle("lost", !live);
    this.mode.classList.toggle("alarmed", Boolean(live && ["LATCHED", "E-STOP", "FAST STOP"].includes(state.mode)));
    this.#progress(live ? state : null);
    const first = live ? firstAlarm(state.alarms) : null;
    const text = first ? `▲ ${first.text}` : live ? state.mode_text : this.link.trouble;
    say(this.first, text);
    this.first.classList.toggle("alarmed", Boolean(first));
    this.#stop();
  }

  #progress(state) {
    const at = state?.progress;
    if (!at || !at.conditions || state.run?.exit !== null) {
      say(this.done, "");
      return;
    }
    const end = at.finish_utc
      ? `, ends ${local(at.finish_utc)}`
      : at.left_s !== null
        ? `, ${spell(at.left_s)} of rig time left`
        : "";
    say(this.done, `${at.over} of ${at.conditions} conditions${end}`);
  }

  #stop() {
    const may = MAY_STOP.has(this.link.role);
    const shape = this.link.status === "pairing" ? "none" : !this.link.connected ? "lost" : may ? "button" : "look";
    if (shape === this.shape) return;
    this.shape = shape;
    if (shape === "button") {
      say(this.told, "not an emergency stop");
      put(
        this.place,
        button("STOP", () => this.stop(), {
          class: "stop",
          "aria-keyshortcuts": "Control+Shift+X",
          title: "Controlled stop (Ctrl+Shift+X). Not an emergency stop",
        }),
      );
    } else if (shape === "none") {
      put(this.place);
      say(this.told, "");
    } else {
      put(this.place, h("s", { class: "struck", text: "STOP" }));
      say(this.told, shape === "look" ? LOOKS : "no connection: use the machine's stop");
    }
  }

  /** Send STOP, from the button or from the keys; any number of times, and as long as anything can be sent at all. */
  async stop() {
    if (this.link.status !== "entered" || !MAY_STOP.has(this.link.role)) {
      say(this.told, this.shape === "look" ? LOOKS : "STOP was not sent: use the machine's stop");
      return;
    }
    const press = ++this.press;
    say(this.told, "STOP sent …");
    try {
      await this.link.command({ command: "stop", fast: false });
      if (press === this.press) say(this.told, "STOP taken");
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      const where = error.message.includes("use the machine's stop") ? "" : ": use the machine's stop";
      say(this.told, `not taken: ${error.message}${where}`);
    }
    setTimeout(() => {
      if (press === this.press && this.shape === "button") say(this.told, "not an emergency stop");
    }, 15000);
  }
}

/**
 * Return the alarm that comes first: unacknowledged before acknowledged, by priority, the first of those that stopped.
 * @param {Object[]} alarms
 * @returns {Object|null}
 */
export function firstAlarm(alarms) {
  const rank = (alarm) => [
    alarm.state === "acknowledged" ? 1 : 0,
    alarm.first_up ? 0 : 1,
    alarm.priority,
    alarm.number,
  ];
  const before = (a, b) => {
    const [x, y] = [rank(a), rank(b)];
    const at = x.findIndex((part, n) => part !== y[n]);
    return at < 0 ? 0 : x[at] - y[at];
  };
  return alarms.length ? [...alarms].sort(before)[0] : null;
}
